"""Robots pushed, between two samples, by one that is eased out of an overlap; and tampered ones."""

from __future__ import annotations

import h5py
import pytest

import physim
from physim import Decision
from physim.analysis.validation import validate
from physim.contacts import Phase

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


def shifted(record, path, robot, step, by):
    """Copy of a record with one pose shifted along x [m]."""
    record.save(path)
    with h5py.File(path, "r+") as file:
        file["/steps/pose"][step, robot, 0] += by
    return physim.Record.load(path)


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
    with shifted(row, tmp_path / "record.h5", 0, step, by) as record:
        strays = validate(record).motion.strays
    assert [one.robot for one in strays] == [0]
    assert strays[0].step == step
