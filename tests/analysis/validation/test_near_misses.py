"""Near misses: approaches that did not end in contact, and who had to give way."""

from __future__ import annotations

import pytest

import physim
from physim import Decision
from physim.analysis.validation import responsibility, validate
from tests.analysis.validation.runs import APART, DRIVERS, LANE, lane
from tests.helpers import inside

TOGETHER = inside("physim.analysis.validation", "TOGETHER")


def test_an_approach_that_ends_in_contact_is_none(rear_end, into_wall):
    for record in (rear_end, into_wall):
        found = validate(record)
        touched = {(one.a, one.b) for one in found.contacts}
        near = found.near_misses
        assert touched
        assert not touched & {(one.a, one.b) for one in (*near.distances, *near.times)}


@pytest.mark.parametrize(("x", "behind"), [(6.0, 1), (10.5, 0)])
def test_the_robot_behind_had_to_give_way(x, behind, monkeypatch):
    monkeypatch.setattr(responsibility, "PRIORITY", DRIVERS)
    found = validate(lane(APART, **{"robots.1.pose": f"[{x}, -1.3, 0.0]"})).near_misses
    pair = [one for one in found.distances if one.b == 1]
    assert pair
    assert {one.behind for one in pair} == {behind}
    assert {one.behind for one in found.distances if one.b > 1} <= {None}


class SlowsDown:
    """The second robot is the faster one, for a while."""

    def decide(self, observation, memory):
        fast = observation.index == 1 and observation.time < 1.95
        return Decision(v=1.0 if fast else 0.5, omega=0.0, hold=0.1)


def test_collision_times_are_those_of_the_moment():
    """The one behind closes at 0.5 m/s from 1.5 m, and slows down before it is there."""
    world = physim.parse_world(LANE, overrides=["robots.1.pose=[4.6, 0.0, 0.0]"])
    found = validate(physim.simulate(world, controller=SlowsDown()))
    assert found.code == 0
    gap = (8.0 - 0.9) - (4.6 + 1.0)
    (one,) = [one for one in found.near_misses.times if one.b == 1]
    assert one.time == pytest.approx(1.9)
    assert one.value == pytest.approx(gap / 0.5 - 1.9, abs=1e-6)


class Sways:
    """Swings to and fro before a wall, every four seconds, and goes far from it where asked."""

    def __init__(self, far: float) -> None:
        self.far = far

    def decide(self, observation, memory):
        time, away = observation.time, self.far if 8.0 <= observation.time < 16.0 else 0.1
        return Decision(v=away if time % 8.0 < 4.0 else -away, omega=0.0, hold=0.1)


@pytest.mark.parametrize(("far", "entries"), [(0.1, 1), (0.6, 2)])
def test_an_oscillation_is_one_near_miss_until_the_two_part(far, entries):
    """It starts 0.15 m off the right wall, its back to it, and comes back there every 8 s."""
    world = physim.parse_world(SWAYING)
    near = validate(physim.simulate(world, controller=Sways(far))).near_misses
    for some in (near.distances, near.times):
        walls = [one for one in some if one.b == 2]
        assert len(walls) == entries, walls
    if entries == 2:
        first, second = sorted(one.time for one in near.distances if one.b == 2)
        assert second - first >= TOGETHER
        assert near.distances[0].value <= near.distances[1].value


SWAYING = """\
name: swaying
time: {step: 0.02, duration: 24.0}
corridor: {centreline: [[0, 0], [30, 0]], width: 8.0}
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0},
     pose: [8.0, -2.95, 1.5707963], path: {offset: 0.0}}
"""
