"""Near misses: of pairs that never touched, and who had to give way."""

from __future__ import annotations

import pytest

import physim
from physim import Decision
from physim.analysis.validation import responsibility, validate
from tests.analysis.validation.runs import APART, DRIVERS, LANE, lane


def test_of_each_pair_that_never_touched_the_smallest(rear_end, into_wall):
    for record in (rear_end, into_wall):
        found = validate(record)
        touched = {(one.a, one.b) for one in found.contacts}
        assert touched
        for some in (found.near_misses.distances, found.near_misses.times):
            pairs = [(one.a, one.b) for one in some]
            assert len(set(pairs)) == len(pairs)
            assert not touched & set(pairs)
            assert [one.value for one in some] == sorted(one.value for one in some)


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
