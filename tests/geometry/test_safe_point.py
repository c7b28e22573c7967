"""Nearest safe point against shapely, and where there is none."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.ops import nearest_points

from physim.geometry import Shapes, safe_point
from tests.helpers import inside

nearest_safe_point = inside("physim.geometry", "nearest_safe_point")
point_clearance, roomiest_point = inside("physim.geometry", "point_clearance", "roomiest_point")
FloatArray, IntArray, pack_parts = inside("physim.geometry", "FloatArray", "IntArray", "pack_parts")

L = 1.0
CHORD = L * (1.0 - np.cos(np.pi / 4 / 256))
"""[m] how far shapely's rounded corners (256 segments a quarter) lie off the circle"""


def room(corners: FloatArray) -> tuple[Shapes, IntArray]:
    n = len(corners)
    segments = [corners[[k, (k + 1) % n]] for k in range(n)]
    return pack_parts([segments]), np.arange(n)


@pytest.mark.parametrize("seed", range(40))
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
        found, sx, sy = nearest_safe_point(walls, parts, (x, y), (1.0, 0.0), (x, y), L, 50.0, 50.0)
        assert found
        assert point_clearance(walls, parts, sx, sy) >= L - 1e-9
        assert abs(np.hypot(sx - x, sy - y) - safe.distance(point)) <= 20.0 * CHORD


def by_all_pairs(
    walls: Shapes, parts: IntArray, target: tuple[float, float], ahead: tuple[float, float],
    eye: tuple[float, float], reach: float, back: float,
) -> tuple[bool, float, float]:  # fmt: skip
    """The same by every crossing of every two border curves, in their order."""
    (tx, ty), points = target, np.empty((2, 2))
    edges = safe_point._edges(walls, parts, tx, ty, reach + 2.0 * L)
    between = safe_point._edges(
        walls, parts, tx, ty, max(reach, np.hypot(eye[0] - tx, eye[1] - ty))
    )
    curves = safe_point._curves(edges, L)
    best = (reach, False, tx, ty)
    for c in range(len(curves)):
        for d in range(c, len(curves)):
            count = 1
            if c == d:
                points[0] = safe_point._nearest_on(curves[c], L, tx, ty)
            else:
                count = safe_point._crossings(curves[c], curves[d], L, points)
            for x, y in points[:count].tolist():
                gap = float(np.hypot(x - tx, y - ty))
                if gap >= best[0] or (x - tx) * ahead[0] + (y - ty) * ahead[1] < -back:
                    continue
                if point_clearance(walls, parts, x, y) < L - 1e-9:
                    continue
                if not safe_point._crosses(between, eye[0], eye[1], x, y):
                    best = (gap, True, x, y)
    return best[1:]


def test_curves_that_are_left_out_change_nothing() -> None:
    """To the last bit, in rooms with straight walls of several segments, and obstacles in them."""
    found = moved = 0
    for seed in range(120):
        rng = np.random.default_rng([5, seed])
        width, bend = rng.uniform(1.5, 5.0), rng.uniform(-0.5, 0.5)
        x = np.linspace(0.0, 12.0, int(rng.integers(3, 9)))
        side = np.column_stack((x, np.where(x > 6.0, bend * (x - 6.0), 0.0)))
        posts = rng.uniform([2.0, 0.0], [10.0, width], (2, 2))
        lines = [side, side + [0.0, width], *(post + [[0, 0], [0.2, 0.1]] for post in posts)]
        segments = [line[k : k + 2] for line in lines for k in range(len(line) - 1)]
        walls, parts = pack_parts([segments]), np.arange(len(segments))
        for _ in range(3):
            target = tuple(rng.uniform([1.0, 0.0], [11.0, width]).tolist())
            eye = target if rng.random() < 0.5 else (0.5, width / 2)
            reach, back = float(rng.uniform(0.5, 4.0)), float(rng.choice([0.5, 3.0]))
            plain = by_all_pairs(walls, parts, target, (1.0, 0.0), eye, reach, back)
            given = nearest_safe_point(walls, parts, target, (1.0, 0.0), eye, L, reach, back)
            assert given == plain
            found += plain[0]
            moved += plain[0] and plain[1:] != target
    assert 100 <= moved <= found < 360


def test_point_beyond_a_thin_wall_is_not_taken() -> None:
    """A wall between two lanes, 1.2 m from the outer wall: safe points lie beyond it only."""
    walls = pack_parts([[np.array([[0.0, 0.0], [20.0, 0.0]]), np.array([[0.0, 1.2], [20.0, 1.2]])]])
    target = (10.0, 1.0)
    found, _, y = nearest_safe_point(
        walls, np.arange(2), target, (1.0, 0.0), (10.0, 3.0), L, 4.0, 4.0
    )
    assert found
    assert y == pytest.approx(2.2)
    found, _, _ = nearest_safe_point(walls, np.arange(2), target, (1.0, 0.0), target, L, 4.0, 4.0)
    assert not found


def test_safe_point_behind_the_target_is_not_taken() -> None:
    """A narrow stretch begins at x = 0: no safe point ahead, so none further than ``back``."""
    walls = pack_parts(
        [[np.array([[0.0, s * 0.7], [30.0, s * 0.7]]), np.array([[0.0, s * 0.7], [0.0, s * 5.0]])]
         for s in (-1.0, 1.0)]
    )  # fmt: skip
    parts = np.arange(4)
    target = (2.5, 0.2)
    far, x, _ = nearest_safe_point(walls, parts, target, (1.0, 0.0), target, L, 6.0, 6.0)
    assert far
    assert x < 0.0
    near, _, _ = nearest_safe_point(walls, parts, target, (1.0, 0.0), target, L, 6.0, 1.0)
    assert not near
    assert roomiest_point(walls, parts, target, (1.0, 0.0), target, 4.0) == pytest.approx(
        (2.5, 0.0), abs=1e-6
    )


def test_inside_an_obstacle_clearance_is_zero() -> None:
    walls = pack_parts([[np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])]])
    assert point_clearance(walls, np.arange(1), 1.0, 1.0) == 0.0
    assert point_clearance(walls, np.arange(1), 3.0, 1.0) == pytest.approx(1.0)


def test_a_wall_far_from_the_target_hides_points_from_the_eye() -> None:
    """It is 20 m from the target, where no safe point is sought, but stands before the eye."""
    far, near = np.array([[0.0, -50.0], [0.0, 50.0]]), np.array([[20.3, -50.0], [20.3, 50.0]])
    walls, parts = pack_parts([[far, near]]), np.arange(2)
    target, ahead = (20.0, 0.0), (1.0, 0.0)
    for x, seen in ((-1.0, False), (1.0, True)):
        found, sx, _ = nearest_safe_point(walls, parts, target, ahead, (x, 0.0), 0.5, 2.0, 0.5)
        assert found == seen
        roomiest, _ = roomiest_point(walls, parts, target, (0.0, 1.0), (x, 0.0), 2.0)
        assert roomiest == pytest.approx(18.0 if seen else 20.0, abs=0.05)
        if seen:
            assert sx == pytest.approx(19.8)
