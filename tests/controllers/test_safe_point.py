"""Nearest safe point against shapely, and where there is none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely
from shapely.ops import nearest_points

from physim.geometry import Shapes
from tests.helpers import inside

FloatArray, IntArray = inside("physim.geometry", "FloatArray", "IntArray")
pack_parts = inside("physim.geometry", "pack_parts")
nearest_safe_point, SafePlace = inside("physim.controllers", "nearest_safe_point", "Place")
point_clearance, roomiest_point = inside("physim.controllers", "point_clearance", "roomiest_point")

L = 1.0
CHORD = L * (1.0 - np.cos(np.pi / 4 / 256))
"""[m] how far shapely's rounded corners (256 segments a quarter) lie off the circle"""


def nearest_safe(
    walls: Shapes,
    parts: IntArray,
    target: tuple[float, float],
    eye: tuple[float, float],
    reach: float,
    back: float,
) -> Any:
    place = SafePlace(walls, parts, target, (1.0, 0.0), eye, L, back)
    return nearest_safe_point(place, reach)


def room(corners: FloatArray) -> tuple[Shapes, IntArray]:
    n = len(corners)
    segments = [corners[[k, (k + 1) % n]] for k in range(n)]
    return pack_parts([segments]), np.arange(n)


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
    walls, parts = room(corners)
    for x, y in rng.uniform(-6.0, 6.0, (20, 2)):
        point = shapely.Point(x, y)
        nearest = nearest_points(safe, point)[0]
        way = shapely.LineString([(x, y), (nearest.x, nearest.y)])
        if not polygon.contains(point) or safe.contains(point) or not polygon.covers(way):
            continue
        found, sx, sy = nearest_safe(walls, parts, (x, y), (x, y), 50.0, 50.0)
        assert found
        assert point_clearance(walls, parts, sx, sy) >= L - 1e-9
        assert abs(np.hypot(sx - x, sy - y) - safe.distance(point)) <= 20.0 * CHORD


def test_point_beyond_a_thin_wall_is_not_taken() -> None:
    """A wall between two lanes, 1.2 m from the outer wall: safe points lie beyond it only."""
    walls = pack_parts([[np.array([[0.0, 0.0], [20.0, 0.0]]), np.array([[0.0, 1.2], [20.0, 1.2]])]])
    target = (10.0, 1.0)
    found, _, y = nearest_safe(walls, np.arange(2), target, (10.0, 3.0), 4.0, 4.0)
    assert found
    assert y == pytest.approx(2.2)
    found, _, _ = nearest_safe(walls, np.arange(2), target, target, 4.0, 4.0)
    assert not found


def test_safe_point_behind_the_target_is_not_taken() -> None:
    """A narrow stretch begins at x = 0: no safe point ahead, so none further than ``back``."""
    walls = pack_parts(
        [[np.array([[0.0, s * 0.7], [30.0, s * 0.7]]), np.array([[0.0, s * 0.7], [0.0, s * 5.0]])]
         for s in (-1.0, 1.0)]
    )  # fmt: skip
    parts = np.arange(4)
    target = (2.5, 0.2)
    far, x, _ = nearest_safe(walls, parts, target, target, 6.0, 6.0)
    assert far
    assert x < 0.0
    near, _, _ = nearest_safe(walls, parts, target, target, 6.0, 1.0)
    assert not near
    assert roomiest_point(walls, parts, target, (1.0, 0.0), target, 4.0) == pytest.approx(
        (2.5, 0.0), abs=1e-6
    )
