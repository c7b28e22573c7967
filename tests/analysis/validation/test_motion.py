"""Poses that were tampered with, and bodies that the engine could not hold, are found out."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import physim
from physim import Decision
from physim.analysis.summary import summarise, table
from physim.analysis.validation import report, validate
from physim.contacts import Phase
from physim.tolerances import DEEP
from tests.analysis.forgeries.tools import cells, column
from tests.analysis.validation.runs import (
    LANE,
    REAR_END,
    Drivers,
    edited,
    judged,
    lane,
    states,
)
from tests.helpers import inside

json_of_validation = inside("physim.analysis.validation", "json_of_validation")


def test_runs_as_they_are_follow_their_commands(apart, rear_end, into_wall):
    for record in (apart, rear_end, into_wall):
        found = validate(record)
        assert found.motion.strays == ()
        assert found.motion.checked > 300
        assert "agree within 1e-11 m" in report(found)


@pytest.mark.parametrize("part", [0, 2])
def test_one_pose_shifted_by_a_millimetre(tmp_path, apart, part):
    found = judged(apart, tmp_path, cells("/steps/pose", (200, 1, part), lambda x: x + 1e-3))
    (stray,) = found.motion.off
    assert (stray.bodies, stray.step, stray.steps) == ((1,), 200, 2)
    assert states(stray.what, "touches nothing", "0.001 rad" if part else "0.001 m")
    assert found.code == 3
    assert states(found.verdict, "poses", "commands", "once")
    said = " ".join(report(found).split())
    assert states(said, "2.0000 s", "fast", "unexplained", within=40)
    assert json.loads(json_of_validation(found))["motion"]["off"][0]["step"] == 200


def test_one_command_changed(tmp_path, apart):
    at = lambda rows: (rows["robot"] == 0) & (rows["step"] == 150)  # noqa: E731
    faster = column("/updates", "nominal_v", lambda v: v + 1e-3, at)
    (stray,) = judged(apart, tmp_path, faster).motion.off
    assert (stray.bodies, stray.step, stray.steps) == ((0,), 151, 10)
    assert states(stray.what, "1e-05 m")


def test_a_pose_beside_a_contact_is_looked_at_too(tmp_path, into_wall):
    # The other robot is in contact all the while: it is left out, this one is not.
    step = into_wall.samples - 5
    assert (into_wall.contacts["step"] == step).any()

    shift = cells("/steps/pose", (step, 1, 0), lambda x: x + 1e-6)
    assert [one.bodies for one in judged(into_wall, tmp_path, shift).motion.strays] == [(1,)]


@pytest.mark.parametrize(("part", "by"), [(0, 0.05), (2, 0.2)])
def test_a_robot_in_contact_goes_no_farther_than_pushes_bring_it(tmp_path, rear_end, part, by):
    rows = rear_end.contacts
    step = int(rows["step"][rows["phase"] == Phase.STAYS][5])

    assert validate(rear_end).motion.held > 100
    shift = cells("/steps/pose", np.s_[step:, 0, part], lambda x: x + by)
    found = judged(rear_end, tmp_path, shift)
    (stray,) = found.motion.far
    assert (stray.bodies, stray.step, stray.steps) == ((0,), step, 1)
    gap, turn, allowed = (float(one) for one in re.findall(r"(\S+) (?:m|rad)\b", stray.what))
    assert max(gap, turn) == pytest.approx(abs(by), abs=0.02)
    assert allowed < 0.02
    assert states(report(found), "slow", "in contact it moved", within=120)
    assert found.code == 3


def test_a_light_robot_that_a_heavy_one_pushes_goes_no_farther_than_it_may(tmp_path):
    """Its energy alone would allow 300 m in the step."""
    pushed = lane(REAR_END, **{"robots.0.mass": 1.0, "robots.1.mass": 5e8})
    rows = pushed.contacts
    step = int(rows["step"][rows["phase"] == Phase.STAYS][5])
    found = judged(pushed, tmp_path, cells("/steps/pose", np.s_[step:, 0, 0], lambda x: x + 1.0))
    (stray,) = found.motion.far
    assert (stray.bodies, stray.step, stray.steps) == ((0,), step, 1)


def test_a_robot_that_stands_may_be_pushed_by_the_energy_of_another():
    # Without that of the one that pushes it, it might not move at all; a heavier one has more.
    world = physim.parse_world(
        LANE,
        overrides=["robots.0.pose=[6.0, 0.0, 0.0]", "robots.1.pose=[3.9, 0.1, 0.2]",
                   "robots.0.mass=20", "robots.1.mass=400"],
    )  # fmt: skip
    record = physim.simulate(world, controller=Drivers((0.0, 0.0), (0.8, 0.0)))
    moved = np.hypot(*np.diff(record.read("/steps/pose")[:, 0, :2], axis=0).T)
    assert moved.max() > 0.006
    found = validate(record)
    assert found.motion.held > 100
    assert found.motion.strays == ()


def test_a_contact_that_is_too_deep_is_told_loudly(tmp_path, rear_end):
    assert validate(rear_end).deep == ()
    assert summarise(rear_end).run.deep == ()
    touching = rear_end.contacts[rear_end.contacts["phase"] != 2]

    def deeper(rows):
        rows["depth"][(rows["step"] == touching["step"][3]) & (rows["phase"] != 2)] = 0.45
        return rows

    with edited(rear_end, tmp_path / "record.h5", deeper) as record:
        found, summary = validate(record), summarise(record)
    (deep,) = found.deep
    assert (deep.a, deep.b, deep.depth) == (0, 1, 0.45)
    assert deep.depth_time == touching["step"][3] * rear_end.dt
    assert deep.allowed >= DEEP
    assert report(found).count("NOT PHYSICAL from") == 1
    assert "WARNING" in table(summary)
    assert json.loads(summary.to_json())["deep_contacts"][0]["max_depth_m"] == 0.45


ROW = """\
name: row
time: {step: 0.1, duration: 0.6}
corridor: {centreline: [[-10, 0], [20, 0]], width: 8.0}
robots:
  - {name: behind, footprint: {length: 1.8, width: 1.0}, pose: [0.0, 0.0, 0.0], path: {offset: 0},
     limits: {v: 0.5, omega: 0.2}, omegas: [-0.2, 0, 0.2]}
  - {name: middle, footprint: {length: 1.8, width: 1.0}, pose: [1.803, 0, 0], path: {offset: 0},
     limits: {v: 0.5, omega: 0.2}, omegas: [-0.2, 0, 0.2]}
  - {name: heavy, footprint: {length: 1.8, width: 1.0}, pose: [3.613, 0.0, 0.0], path: {offset: 0},
     limits: {v: 0.5, omega: 0.2}, omegas: [-0.2, 0, 0.2], mass: 20000.0}
"""


class Knock:
    """The heavy one runs 20 mm into the middle one, which is eased back; then both leave."""

    def decide(self, observation, memory):
        first = observation.time < 0.05
        v = ((0.0, 0.0), (0.0, 0.5), (-0.3, 0.5))[observation.index][0 if first else 1]
        return Decision(v=v, omega=0.0, hold=0.1)


@pytest.fixture(scope="module")
def row():
    return physim.simulate(physim.parse_world(ROW), controller=Knock())


def test_a_robot_pushed_by_one_that_is_eased_out_of_a_contact_is_no_stray(row):
    moved = abs(row.pose[:, 0, 0] - row.pose[0, 0, 0])
    assert moved[-1] > 1e-4  # it stood by command
    touching = row.contacts[row.contacts["phase"] != Phase.ENDED]
    assert not (touching["a"] == 0).any()
    assert row.clearance[1, 0] == pytest.approx(0.003)
    found = validate(row)
    assert found.motion.strays == ()
    assert found.code == 1


@pytest.mark.parametrize(("step", "by"), [(2, -0.3), (5, 1e-3)])
def test_a_pose_beyond_what_a_push_can_do_is_found_beside_a_contact(row, tmp_path, step, by):
    shift = cells("/steps/pose", (step, 0, 0), lambda x: x + by)
    strays = judged(row, tmp_path, shift).motion.strays
    assert [one.bodies for one in strays] == [(0,)]
    assert strays[0].step == step
