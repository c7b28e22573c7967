"""Collision times (11) lie between the bounds that are worked out before them."""

from __future__ import annotations

import numpy as np
import pytest

from tests.controllers.random_scenes import BOX, footprint
from tests.helpers import inside

bodies_time, arc_course = inside("physim.geometry", "bodies_time", "arc_course")
pack_parts, discs_meet = inside("physim.geometry", "pack_parts", "discs_meet")
overlap_at, overlap_time = inside("physim.geometry", "overlap_at", "overlap_time")

HORIZON = 10.0


def two_on_their_way(rng: np.random.Generator):
    """Shapes of two robots and their courses."""
    shapes = pack_parts([footprint(rng), footprint(rng)])
    courses = [
        arc_course(
            rng.uniform(-1.0, 1.0, 3) * [2.5, 2.5, np.pi],
            float(rng.choice([0.0, rng.uniform(-1.5, 1.5)])),
            float(rng.choice([0.0, 1e-7, rng.uniform(-2.0, 2.0)])),
            radius,
        )
        for radius in shapes.radius
    ]
    return shapes, courses[0], courses[1]


def test_times_lie_between_the_bounds() -> None:
    never = above = 0
    for k in range(1500):
        rng = np.random.default_rng([41, k])
        shapes, a, b = two_on_their_way(rng)
        xi = bodies_time(shapes, 0, a, shapes, 1, b, HORIZON)
        low = discs_meet(a, b, 0.0, HORIZON)
        assert low <= xi
        never += low == np.inf
        if low < np.inf:
            limit = float(rng.choice([HORIZON, low + rng.uniform(0.0, 2.0)]))
            high = overlap_time(shapes, 0, a, shapes, 1, b, low, limit)
            assert high == np.inf or xi <= high < limit
            above += high < np.inf
            start = float(rng.uniform(0.0, low))  # they are apart up to then
            assert discs_meet(a, b, start, HORIZON) <= xi
    assert never >= 200
    assert above >= 150


def test_discs_are_followed_to_where_they_meet() -> None:
    a = arc_course((0.0, 0.0, 0.0), 1.0, 0.0, 0.5)
    b = arc_course((11.0, 0.0, np.pi), 1.0, 0.0, 0.5)
    assert discs_meet(a, b, 0.0, HORIZON) == pytest.approx(5.0, abs=0.03)
    assert discs_meet(a, b, 0.0, 4.9) == np.inf


def test_what_merely_touches_is_no_sure_overlap() -> None:
    shapes = pack_parts([BOX, BOX])
    a = arc_course((0.0, 0.0, 0.0), 1.0, 0.0, shapes.radius[0])
    for gap, sure in ((0.0, False), (-1e-3, True), (1e-3, False)):
        b = arc_course((3.8 + gap, 0.0, 0.0), -1.0, 0.0, shapes.radius[1])
        assert overlap_at(shapes, 0, a, shapes, 1, b, 1.0) is sure
