"""Edits of `physim.controllers.mode_switching`: `ModeSwitching.decide`, the form for one robot at a time."""

from __future__ import annotations

from tests.sabotage.edit import Edit

WHOLE = "tests/controllers/test_mode_switching.py::test_every_decision_agrees_with_the_oracle"

EDITS = (
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "ModeSwitching.decide",
        "forward_speed(rule, o.limits[0],",
        "forward_speed(rule, np.inf,",
        "plain form: the robot's limit ignored",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "ModeSwitching.decide",
        "speeds=np.array(self.settings.speeds if o.speeds is None else o.speeds),",
        "speeds=np.array(self.settings.speeds),",
        "plain form: the robot's own speeds ignored",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "ModeSwitching.decide",
        "station=np.array([o.reference_station, *(other.station for other in o.others)]),",
        "station=np.array([o.station, *(other.station for other in o.others)]),",
        "plain form: priority by the station on the own path",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "ModeSwitching.decide",
        "number=np.array([o.index, *(other.index for other in o.others)]),",
        "number=np.arange(1 + len(o.others)),",
        "plain form: ties by row, so that every robot gives way to none",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "ModeSwitching.decide",
        "outside=o.path.outside,",
        "outside=o.path.outside[:0],",
        "plain form: no stretch counts as outside",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "ModeSwitching.decide",
        "lead = np.array([o.lead, *(n.lead for n in o.neighbours)])",
        "lead = np.zeros(len(station))",
        "plain form: desired leads ignored",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "ModeSwitching.decide",
        "forward_only=self.settings.forward_only(o.formation.active),",
        "forward_only=self.settings.forward_only(True),",
        "plain form: forward only without formation, too",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "ModeSwitching.decide",
        "command=np.array([(o.v, o.omega), *((s.v, s.omega) for s in o.others)]),",
        "command=np.zeros((1 + len(o.others), 2)),",
        "plain form: the others' commands ignored",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "ModeSwitching.decide",
        "memory=Memory(mode, memory.plan, dwell),",
        "memory=None,",
        "plain form: nothing is remembered",
        WHOLE,
    ),
)
