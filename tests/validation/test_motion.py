"""Poses that were tampered with, and bodies that the engine could not hold, are found out."""

from __future__ import annotations

import json

import h5py
import numpy as np
import pytest

import physim
from physim import Decision
from physim.analysis.summary import summarise, table
from physim.analysis.validation import report, validate
from physim.contacts import Phase
from physim.tolerances import DEEP
from tests.helpers import inside
from tests.validation.reports import states
from tests.validation.runs import APART, LANE, REAR_END, Drivers, edited, lane

json_of_validation = inside("physim.analysis.validation", "json_of_validation")


def tampered(record, path, change):
    """Copy of a record on disk, its open file changed in place by ``change(file)``."""
    record.save(path)
    with h5py.File(path, "r+") as file:
        change(file)
    return physim.Record.load(path)


def test_runs_as_they_are_follow_their_commands(apart, rear_end, into_wall):
    for record in (apart, rear_end, into_wall):
        found = validate(record)
        assert found.motion.strays == ()
        assert found.motion.checked > 300
        assert "agree within 1e-11 m" in report(found)


@pytest.mark.parametrize("column", [0, 1, 2])
def test_one_pose_shifted_by_a_millimetre(tmp_path, apart, column):
    def shift(file):
        file["/steps/pose"][200, 1, column] += 1e-3

    with tampered(apart, tmp_path / "record.h5", shift) as record:
        found = validate(record)
    (stray,) = found.motion.strays
    assert (stray.robot, stray.step, stray.steps) == (1, 200, 2)
    assert max(stray.gap, stray.turn) == pytest.approx(1e-3, rel=0.01)
    assert found.code == 3
    assert states(found.verdict, "poses", "commands", "once")
    said = " ".join(report(found).split())
    assert states(said, "2.0000 s", "fast", "unexplained", within=40)
    assert json.loads(json_of_validation(found))["motion"]["strays"][0]["step"] == 200


def test_two_robots_swapped(tmp_path, apart):
    def swap(file):
        file["/steps/pose"][...] = file["/steps/pose"][()][:, ::-1]

    with tampered(apart, tmp_path / "record.h5", swap) as record:
        found = validate(record)
    assert {one.robot for one in found.motion.strays} == {0, 1}
    assert found.code == 3


def test_one_command_changed(tmp_path, apart):
    def faster(file):
        rows = file["/updates"][()]
        k = np.flatnonzero((rows["robot"] == 0) & (rows["step"] == 150))[0]
        rows["nominal_v"][k] += 1e-3
        file["/updates"][...] = rows

    with tampered(apart, tmp_path / "record.h5", faster) as record:
        (stray,) = validate(record).motion.strays
    assert (stray.robot, stray.step, stray.steps) == (0, 151, 10)
    assert stray.gap == pytest.approx(1e-5, rel=1e-3)


def test_a_pose_beside_a_contact_is_looked_at_too(tmp_path, into_wall):
    # The other robot is in contact all the while: it is left out, this one is not.
    step = into_wall.samples - 5
    assert (into_wall.contacts["step"] == step).any()

    def shift(file):
        file["/steps/pose"][step, 1, 0] += 1e-6

    with tampered(into_wall, tmp_path / "record.h5", shift) as record:
        assert [one.robot for one in validate(record).motion.strays] == [1]


@pytest.mark.parametrize(("column", "by"), [(0, 0.05), (1, -0.05), (2, 0.2)])
def test_a_robot_in_contact_goes_no_farther_than_pushes_bring_it(tmp_path, rear_end, column, by):
    rows = rear_end.contacts
    step = int(rows["step"][rows["phase"] == Phase.STAYS][5])

    def shift(file):
        file["/steps/pose"][step:, 0, column] += by

    assert validate(rear_end).motion.held > 100
    with tampered(rear_end, tmp_path / "record.h5", shift) as record:
        found = validate(record)
    (stray,) = (one for one in found.motion.strays if one.allowed is not None)
    assert (stray.robot, stray.step, stray.steps) == (0, step, 1)
    assert max(stray.gap, stray.turn) == pytest.approx(abs(by), abs=0.02)
    assert stray.allowed < 0.02
    said = " ".join(report(found).split())
    assert states(said, "slow", "in contact it moved", f"{stray.allowed:.3g} m", within=120)
    assert found.code == 3


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


def test_masses_let_no_light_robot_go_anywhere(tmp_path):
    # What a world says of masses is held against nothing: a million to one is 1000 times as fast.
    heavy = {"robots.0.mass": "1", "robots.1.mass": "1000000"}
    record = lane(REAR_END, **heavy)
    rows = record.contacts
    step = int(rows["step"][rows["phase"] == Phase.STAYS][5])

    def shift(file):
        file["/steps/pose"][step:, 0, 0] += 3.0

    assert validate(record).motion.strays == ()
    with tampered(record, tmp_path / "record.h5", shift) as forged:
        far = [one for one in validate(forged).motion.strays if one.allowed is not None]
    assert (far[0].robot, far[0].step) == (0, step)


class Slower:
    """A filter that halves every seventh command."""

    def start(self, scene):
        return 0

    def filter(self, scene, sensed, nominal, state):
        return nominal * (0.5 if sensed.step % 7 == 0 else 1.0), state + 1


def test_motion_is_held_against_filtered_commands_at_every_step(tmp_path):
    world = physim.parse_world(LANE, overrides=["robots.1.pose=[6.0, -1.3, 0.0]"])
    record = physim.simulate(world, controller=Drivers(*APART), filters=[Slower()])
    found = validate(record)
    assert (found.code, found.motion.strays) == (0, ())
    assert found.motion.checked == 2 * record.steps_run
    assert states(
        report(found), "tests.validation.test_motion:Slower", "filter", "given from Python"
    )

    def teleport(file):
        file["/steps/pose"][150:, 1, 0] += 0.3

    with tampered(record, tmp_path / "record.h5", teleport) as record:
        (stray,) = validate(record).motion.strays
    assert (stray.robot, stray.step, stray.steps) == (1, 150, 1)
    assert stray.gap == pytest.approx(0.3)


def test_a_contact_that_is_too_deep_is_told_loudly(tmp_path, rear_end):
    assert validate(rear_end).deep == ()
    assert summarise(rear_end).deep_contacts == ()
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
    said = " ".join(report(found).split())
    assert said.count("NOT PHYSICAL from") == 2  # with the verdict, above and below
    assert states(said, "slow and fast", "450.0 mm", within=60)
    assert "WARNING" in table(summary)
    assert json.loads(summary.to_json())["deep_contacts"][0]["max_depth_m"] == 0.45


class Plain:
    """Looks at nothing and has no modes."""

    def decide(self, observation, memory):
        return Decision(v=1.0, omega=0.0, hold=0.1)


def test_a_controller_without_modes_is_told_without_them():
    record = physim.simulate(physim.parse_world(LANE), controller=Plain())
    assert set(record.updates["mode"]) == {-1}
    summary = summarise(record)
    assert summary.value("danger_share") is None
    assert not {"danger_share", "safe_share", "mode_switches"} & set(summary.metrics)
    found = validate(record)
    assert "safe mode" not in report(found)


def test_pairs_are_counted_beside_contacts(into_wall, rear_end):
    found = validate(rear_end)
    count, pairs = len(found.contacts), len({(one.a, one.b) for one in found.contacts})
    assert found.verdict == f"contacts: {count} of {pairs} pair{'s' if pairs != 1 else ''}"
    assert json.loads(json_of_validation(found))["pairs_in_contact"] == pairs


def test_the_report_says_what_foretold_means(rear_end):
    text = report(validate(rear_end))
    assert states(text, "foretold: ", "share of decisions", within=40)
    assert max(len(line) for line in text.splitlines()) <= 100


SQUEEZED = """\
name: squeezed
time: {step: 0.01, duration: 0.5}
boundaries: [[[-5.6, -2.545], [5.6, -2.545], [5.6, 2.545], [-5.6, 2.545], [-5.6, -2.545]]]
reference_path: [[-4.89, 0], [5.09, 0]]
robots:
  - {name: a, footprint: {length: 0.8, width: 0.6}, mass: 1240927.3, path: {offset: 0},
     pose: [2.8170773283208357, -0.9106364289298421, -2.3306764797952706]}
  - {name: b, footprint: {length: 1.8, width: 1.0}, mass: 5.392222746862628, path: {offset: 0},
     pose: [1.5899950120109612, -0.8536493389162545, -1.1133371763104298]}
  - {name: c, footprint: [[1, 0], [-0.7, 0.55], [-0.7, -0.55]], mass: 684656.3, path: {offset: 0},
     pose: [0.47475453207287366, -1.1954205460187861, 1.8834819664204563]}
controller:
  type: constant
  commands: [[0.36806231139392387, -0.397205397641], [-0.154033526961, 0], [0.0243985147, 0.64965]]
"""
"""Two of a thousand tonnes and more close on one of five kilograms, which slips out by levers."""


def test_a_light_robot_that_heavy_ones_squeeze_out_is_not_doubted():
    found = validate(physim.simulate(physim.parse_world(SQUEEZED)))
    assert found.contacts
    assert found.motion.strays == ()
    assert found.code == 1
