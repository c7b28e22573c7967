"""Robots that turn by next to nothing: their turning circles are too large to be trusted."""

from __future__ import annotations

import math

import numpy as np
import pytest

from physim.geometry import collision_time
from tests.geometry.cases import BOX
from tests.helpers import inside

LARGEST_CIRCLE, clear_of_part = inside("physim.geometry", "LARGEST_CIRCLE", "clear_of_part")
never_meet, stays, arc_course = inside("physim.geometry", "never_meet", "stays", "arc_course")

SLOW = [sign * 10.0**power for power in (-300, -17, -16, -14, -12, -10, -8) for sign in (1, -1)]


@pytest.mark.parametrize("omega", SLOW)
def test_a_hit_straight_ahead_is_never_missed(omega: float) -> None:
    rng = np.random.default_rng(4)
    for _ in range(40):
        pose = (*rng.uniform(-500.0, 500.0, 2), rng.uniform(-math.pi, math.pi))
        ahead = np.array((math.cos(pose[2]), math.sin(pose[2])))
        across = np.array((-ahead[1], ahead[0]))
        place = np.array(pose[:2]) + rng.uniform(2.0, 9.0) * ahead
        wall = np.array((place - 2.0 * across, place + 2.0 * across))
        v = rng.uniform(0.5, 2.0)
        straight = collision_time(BOX, pose, (v, 0.0), wall, (0, 0, 0), (0, 0), 30.0)
        assert straight < 30.0
        turning = collision_time(BOX, pose, (v, omega), wall, (0, 0, 0), (0, 0), 30.0)
        assert turning == pytest.approx(straight, abs=1e-6 + 30.0**2 * abs(omega))
        other = (*place, rng.uniform(-math.pi, math.pi))
        straight = collision_time(BOX, pose, (v, 0.0), BOX, other, (-0.1, 0.0), 30.0)
        turning = collision_time(BOX, pose, (v, omega), BOX, other, (-0.1, -omega), 30.0)
        assert turning == pytest.approx(straight, abs=1e-6 + 30.0**2 * abs(omega))


def test_early_outs_leave_such_courses_alone() -> None:
    slow = arc_course(np.array((0.0, 0.0, 0.0)), 1.0, 1e-16, 1.0)
    round_and_round = arc_course(np.array((9.0, 5.0, 0.0)), 1.0, 2.0 / LARGEST_CIRCLE, 1.0)
    still = arc_course(np.array((5.0, 0.5, 0.0)), 0.0, 0.0, 1.0)
    assert not stays(slow)
    assert stays(round_and_round)
    assert not never_meet(slow, still, 10.0)
    assert not never_meet(still, slow, 10.0)
    assert not clear_of_part(slow, np.array(((5.0, -1.0), (5.0, 1.0))), 0, 2, 10.0)
    assert never_meet(slow, still, 1.0)  # too far for the time
