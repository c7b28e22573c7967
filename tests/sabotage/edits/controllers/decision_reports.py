"""Edits of `physim.controllers.mode_switching`: what a decision of `decide_one` reports."""

from __future__ import annotations

from tests.sabotage.edit import Edit

WHOLE = "tests/controllers/test_mode_switching.py::test_every_decision_agrees_with_the_oracle"

EDITS = (
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "evaluations += len(pairs) * (len(rows) + 1)",
        "evaluations += len(pairs)",
        "evaluations of (13) miscounted",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "report[2], report[3], report[4] = distance, boundary, xi",
        "report[2], report[3], report[4] = boundary, distance, xi",
        "distance and boundary distance exchanged in the report",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "return 0.0, 0.0, rules.longest_interval, ARRIVED, STOP, 0, 0",
        "return 0.0, 0.0, rules.longest_interval, SAFE, STOP, 0, 0",
        "arrived robots say safe",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "report[0], report[1], report[5] = x, y, 0.0",
        "report[0], report[1], report[5] = np.nan, np.nan, 0.0",
        "no target in the report of a robot that has arrived",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "report[0], report[1] = tx, ty\n    report[2]",
        "report[0], report[1] = x, y\n    report[2]",
        "the report has the target before it was moved",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "nearest = look_about(bodies, me, rows, keep, room.table) near = NearField(me, rows, ",
        "everyone = np.delete(np.arange(len(pose)), me)\n    nearest = look_about(bodies, me, everyone, keep, room.table)\n    near = NearField(me, everyone, ",
        "distance to robots that need not be considered",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "boundary = seen_distance(bodies.shapes, bodies.shape[me], pose[me], own.sight)",
        "boundary = abs(seen_distance(bodies.shapes, bodies.shape[me], pose[me], own.sight))",
        "boundary distance unsigned",
        WHOLE,
    ),
    Edit(
        "controllers",
        "controllers/mode_switching.py",
        "decide_one",
        "rule = LONGEST",
        "rule = WIDEST",
        "a decision names the rule that made it",
        WHOLE,
    ),
)
