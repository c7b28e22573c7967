"""Finely drawn walls: their points, and the safe area between them."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from physim.geometry.area import accessible_area
from physim.geometry.shapes import FloatArray
from physim.geometry.thinning import MANY, thinned
from physim.tolerances import LENGTH

ROOM = np.array([[-3.0, -3.0], [33.0, -3.0], [33.0, 3.0], [-3.0, 3.0], [-3.0, -3.0]])
MIDDLE = np.array([[0.0, 0.0], [30.0, 0.0]])


def turned(points: FloatArray, angle: float) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def finely(corners: FloatArray, pieces: int) -> FloatArray:
    """A polyline with each leg in so many pieces."""
    share = np.arange(pieces)[:, None] / pieces
    legs = [a + share * (b - a) for a, b in zip(corners[:-1], corners[1:], strict=True)]
    return np.concatenate([*legs, corners[-1:]])


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_straight_walls_keep_their_corners_alone(angle: float) -> None:
    corners = turned(ROOM, angle)
    (wall,) = thinned({"room": finely(corners, 5_000)}).values()
    assert wall == pytest.approx(corners, abs=LENGTH)
    assert len(wall) == len(corners)


def test_what_is_not_straight_keeps_its_points() -> None:
    x = np.linspace(0.0, 30.0, 2 * MANY)
    step = np.where(np.arange(len(x)) % 2, 3.0 * LENGTH, 0.0)
    line = np.stack([x, step], axis=1)
    assert thinned({"saw": line})["saw"] == pytest.approx(line, abs=0.0)


def test_a_dropped_point_lies_on_the_wall() -> None:
    rng = np.random.default_rng(5)
    line = finely(ROOM, 500) + rng.uniform(-2.0, 2.0, (2_001, 2)) * LENGTH
    kept = thinned({"room": line})["room"]
    assert len(kept) < len(line)
    away = shapely.distance(shapely.LineString(kept), shapely.points(line))
    assert away.max() <= LENGTH * (1.0 + 1e-6)


def test_few_points_are_taken_as_they_are() -> None:
    line = finely(ROOM, MANY // 8)
    assert len(line) < MANY
    assert thinned({"a": line})["a"] is line
    assert len(thinned({"a": line, "b": line})["b"]) < len(line)  # all together count


@pytest.mark.parametrize("pieces", [8_000, 25_000])
def test_the_safe_area_between_finely_drawn_straight_walls(pieces: int) -> None:
    """Two sides drawn finely, without a point on the two that close them."""
    sides = [finely(side, pieces) for side in (ROOM[:2], ROOM[2:4])]
    room = accessible_area([np.concatenate([*sides, ROOM[:1]])], [], MIDDLE)
    (ring,) = room.safe_rings(1.0)
    assert shapely.Polygon(ring).area == pytest.approx(34.0 * 4.0)


def winding(points: int) -> FloatArray:
    """Outline of a road whose two walls have so many points each."""
    x = np.linspace(-3.0, 33.0, points)
    left, right = (np.stack([x, y + 0.5 * np.sin(x / 3.0)], axis=1) for y in (3.0, -3.0))
    return np.concatenate([right, left[::-1], right[:1]])


@pytest.mark.parametrize("points", [1_000, 5_000, 20_000])
def test_the_safe_area_between_finely_drawn_winding_walls(points: int) -> None:
    room = accessible_area([winding(points)], [], MIDDLE)
    (safe,) = room.safe_rings(1.0)
    coarse = winding(500)
    legs = shapely.linestrings(np.stack([coarse[:-1], coarse[1:]], axis=1))
    near = shapely.union_all(shapely.buffer(legs, 1.0, quad_segs=64))
    true = shapely.Polygon(coarse).difference(near).area
    assert shapely.Polygon(safe).area == pytest.approx(true, rel=1e-3)
