"""Nearest safe point against shapely, and where there is none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely
from shapely.ops import nearest_points

from physim.geometry import Shapes
from tests.helpers import inside

FloatArray, pack_parts, Parts = inside("physim.geometry", "FloatArray", "pack_parts", "Parts")
nearest_safe_point, Place, Point = inside(
    "physim.controllers", "nearest_safe_point", "Place", "Point"
)
point_clearance, roomiest_point = inside("physim.controllers", "point_clearance", "roomiest_point")

L = 1.0
CHORD = L * (1.0 - np.cos(np.pi / 4 / 256))
"""[m] how far shapely's rounded corners (256 segments a quarter) lie off the circle"""


def all_parts(walls: Shapes) -> Any:
    count = len(walls.part_start) - 1
    return Parts(np.arange(count), count)


def place(walls: Shapes, target: tuple[float, float], eye: tuple[float, float], back: float) -> Any:
    at, ahead = Point(*target), Point(1.0, 0.0)
    return Place(walls, all_parts(walls), at, ahead, Point(*eye), L, back)


def nearest_safe(
    walls: Shapes,
    target: tuple[float, float],
    eye: tuple[float, float],
    reach: float,
    back: float,
) -> Any:
    found, at = nearest_safe_point(place(walls, target, eye, back), reach)
    return found, *at


def room(corners: FloatArray) -> Shapes:
    n = len(corners)
    segments = [corners[[k, (k + 1) % n]] for k in range(n)]
    return pack_parts([segments])


@pytest.mark.parametrize("seed", range(12))
def test_nearest_safe_point_agrees_with_shapely(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, rng.integers(4, 9)))
    corners = rng.uniform(2.0, 6.0, len(angles))[:, None] * np.stack(
        [np.cos(angles), np.sin(angles)], axis=1
    )
    polygon = shapely.Polygon(corners)
    safe = polygon.buffer(-L, quad_segs=256)
    if not polygon.is_valid or safe.is_empty:
        pytest.skip("no such room")
    walls = room(corners)
    for x, y in rng.uniform(-6.0, 6.0, (20, 2)):
        point = shapely.Point(x, y)
        nearest = nearest_points(safe, point)[0]
        way = shapely.LineString([(x, y), (nearest.x, nearest.y)])
        if not polygon.contains(point) or safe.contains(point) or not polygon.covers(way):
            continue
        found, sx, sy = nearest_safe(walls, (x, y), (x, y), 50.0, 50.0)
        assert found
        assert point_clearance(walls, all_parts(walls), sx, sy) >= L - 1e-9
        assert abs(np.hypot(sx - x, sy - y) - safe.distance(point)) <= 20.0 * CHORD


def test_point_beyond_a_thin_wall_is_not_taken() -> None:
    """A wall between two lanes, 1.2 m from the outer wall: safe points lie beyond it only."""
    walls = pack_parts([[np.array([[0.0, 0.0], [20.0, 0.0]]), np.array([[0.0, 1.2], [20.0, 1.2]])]])
    target = (10.0, 1.0)
    found, _, y = nearest_safe(walls, target, (10.0, 3.0), 4.0, 4.0)
    assert found
    assert y == pytest.approx(2.2)
    found, _, _ = nearest_safe(walls, target, target, 4.0, 4.0)
    assert not found


def test_safe_point_behind_the_target_is_not_taken() -> None:
    """A narrow stretch begins at x = 0: no safe point ahead, so none further than ``back``."""
    walls = pack_parts(
        [[np.array([[0.0, s * 0.7], [30.0, s * 0.7]]), np.array([[0.0, s * 0.7], [0.0, s * 5.0]])]
         for s in (-1.0, 1.0)]
    )  # fmt: skip
    target = (2.5, 0.2)
    far, x, _ = nearest_safe(walls, target, target, 6.0, 6.0)
    assert far
    assert x < 0.0
    near, _, _ = nearest_safe(walls, target, target, 6.0, 1.0)
    assert not near
    here = place(walls, target, target, 4.0)
    assert roomiest_point(here, here.parts, 4.0) == pytest.approx((2.5, 0.0), abs=1e-6)
