"""Bounds of collision times, against closed cases and marching."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from physim.geometry import collision_time, collision_time_certified, polyline
from physim.tolerances import TIME
from tests.geometry.cases import BOX, random_scene
from tests.geometry.test_collision_time import disc, random_twist
from tests.helpers import examples
from tests.oracles.collision_time import distance_at, marched_time

HORIZON = 10.0
STILL = ((0.0, 0.0, 0.0), (0.0, 0.0))
seeds = st.integers(0, 2**32 - 1)


def random_pair(seed):
    rng = np.random.default_rng(seed)
    bodies, _, poses = random_scene(rng, 2, spread=3.0)
    return [(bodies[k], poses[k], random_twist(rng)) for k in (0, 1)]


@examples(25, deep=150)
@given(seeds)
def test_bounds_hold_the_marched_time(seed):
    a, b = random_pair(seed)
    found = collision_time_certified(*a, *b, HORIZON)
    assert found.time == collision_time(*a, *b, HORIZON)
    assert found.lower <= found.time <= found.upper
    marched = marched_time(*a, *b, HORIZON)
    if marched is None or found.capped:
        return
    # The oracle stops within CONTACT, the exact time is no earlier.
    if math.isinf(marched):
        assert math.isinf(found.upper) or found.upper > HORIZON - TIME
    elif math.isfinite(found.lower):
        before = max(0.0, found.lower - TIME)
        assert distance_at(*a, *b, before) > 0.0 or found.lower == 0.0
    if found.lower > 0.0:
        for t in min(found.lower, HORIZON) * np.linspace(0.0, 1.0, 40, endpoint=False):
            assert distance_at(*a, *b, t) > 0.0
    if math.isfinite(found.upper):
        assert distance_at(*a, *b, found.upper) == 0.0


def test_head_on_bounds_are_tight():
    exact = (5.0 - 1.8) / 1.6
    for omega in (0.0, 1e-13):
        found = collision_time_certified(
            BOX, (0, 0, 0), (1, omega), BOX, (5, 0.1, math.pi), (0.6, 0)
        )
        assert found.lower <= exact <= found.upper
        assert found.upper - found.lower < 2e-9
        assert not found.capped


def test_turning_bounds_hold_the_closed_time():
    bar = [[-1.0, -0.1], [1.0, -0.1], [1.0, 0.1], [-1.0, 0.1]]
    wall = polyline([[-5.0, 0.8], [5.0, 0.8]])
    exact = (math.asin(0.8 / math.hypot(1.0, 0.1)) - math.atan2(0.1, 1.0)) / 0.5
    found = collision_time_certified(bar, (0, 0, 0), (0, 0.5), wall, *STILL)
    assert found.lower <= exact <= found.upper
    assert found.upper - found.lower < TIME


def test_overlap_touching_and_grazes():
    now = collision_time_certified(BOX, (0, 0, 0), (1, 0.2), BOX, (1, 0, 0), (0, 0))
    assert (now.time, now.lower, now.upper, now.capped) == (0.0, 0.0, 0.0, False)
    touch = collision_time_certified(BOX, (0, 0, 0), (-1, 0), BOX, (1.8, 0, 0), (0, 0))
    assert (touch.time, touch.lower, touch.upper) == (0.0, 0.0, math.inf)
    for gap in (0.0, 0.5e-9):  # sides slide past each other on one line
        graze = collision_time_certified(BOX, (0, 0, 0), (1, 0), BOX, (5, 1.0 + gap, 0), (0, 0))
        assert graze.lower == pytest.approx(3.2, abs=1e-8)
        assert graze.upper == math.inf
    none = collision_time_certified(BOX, (0, 0, 0), (1, 0), BOX, (5, 1.1, 0), (0, 0))
    assert (none.time, none.lower, none.upper, none.capped) == (math.inf, math.inf, math.inf, False)


def test_cap_is_reported():
    """A disc on its ring about another for hours: too many advances to tell."""
    small = disc(0.1, 16)
    found = collision_time_certified(small, (0, 0, 0), (1, 1), small, (0, 1, 0), (0, 0), 1e5)
    assert found.capped
    assert 0.0 < found.lower == found.time < 1e5
    assert found.upper == math.inf
    short = collision_time_certified(small, (0, 0, 0), (1, 1), small, (0, 1, 0), (0, 0), 20.0)
    assert (short.time, short.capped) == (math.inf, False)


def test_endless_horizon():
    motion = (BOX, (0, 0, 0), (1, 0), BOX, (5, 0, 0), (0, 0))
    assert collision_time_certified(*motion, math.inf).time == pytest.approx(3.2)
