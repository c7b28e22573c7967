"""Finely drawn walls: their points, and the safe area between them."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from physim.tolerances import LENGTH
from tests.helpers import inside

FloatArray = inside("physim.geometry", "FloatArray")
accessible_area = inside("physim.world.ground", "accessible_area")
shrunk, SIMPLER, SMALL, thinned = inside(
    "physim.world.ground", "shrunk", "SIMPLER", "SMALL", "thinned"
)

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


TAKEN = 0.01 + 0.0012 + SIMPLER + SMALL**2 / 8.0
"""Share of the distance that shapely, chords, simplification and hulls may take."""


def check_gaps(room: shapely.Polygon, safe: shapely.Geometry, distance: float) -> None:
    """Assert that the edge of a safe area lies where it should."""
    rings = [shapely.get_coordinates(one) for one in shapely.get_rings(room)]
    legs = np.concatenate([np.stack([one[:-1], one[1:]], axis=1) for one in rings])
    edge = shapely.points(shapely.get_coordinates(safe))
    # of each the nearest leg alone: of the whole boundary at once it takes minutes
    _, gaps = shapely.STRtree(shapely.linestrings(legs)).query_nearest(
        edge, return_distance=True, all_matches=False
    )
    assert len(gaps) == len(edge)
    assert np.abs(gaps - distance).max() <= TAKEN * distance


def winding(points: int) -> FloatArray:
    """Outline of a road whose two walls have so many points each."""
    x = np.linspace(-3.0, 33.0, points)
    left, right = (np.stack([x, y + 0.5 * np.sin(x / 3.0)], axis=1) for y in (3.0, -3.0))
    return np.concatenate([right, left[::-1], right[:1]])


DEEP = pytest.mark.deep


@pytest.mark.parametrize("points", [1_000, pytest.param(20_000, marks=DEEP)])
def test_the_safe_area_between_finely_drawn_winding_walls(points: int) -> None:
    room = accessible_area([winding(points)], [], MIDDLE)
    (safe,) = room.safe_rings(1.0)
    coarse = winding(500)
    legs = shapely.linestrings(np.stack([coarse[:-1], coarse[1:]], axis=1))
    near = shapely.union_all(shapely.buffer(legs, 1.0, quad_segs=64))
    true = shapely.Polygon(coarse).difference(near).area
    assert shapely.Polygon(safe).area == pytest.approx(true, rel=1e-3)
    check_gaps(room.polygon, shapely.Polygon(safe), 1.0)


def rough(points: int, roughness: float) -> FloatArray:
    """Outline of a room of 3 x 2 m as a scanner sees it."""
    rng = np.random.default_rng(3)
    corners = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0], [0.0, 0.0]])
    line = finely(corners, points // 4)
    line += roughness * rng.standard_normal(line.shape)
    line[-1] = line[0]
    return line


@pytest.mark.parametrize(
    ("points", "roughness"),
    [(1_200, 0.1), *(pytest.param(4_000, share, marks=DEEP) for share in (1e-3, 4e-2))],
)
def test_the_safe_area_between_rough_walls(points: int, roughness: float) -> None:
    ring = rough(points, roughness)
    face = shapely.get_parts(shapely.make_valid(shapely.Polygon(ring)))
    room = max(face, key=lambda one: float(one.area))
    found = shrunk(room, 0.5, 16)
    edges = [shapely.get_coordinates(one) for one in shapely.get_rings(room)]
    legs = np.concatenate([np.stack([one[:-1], one[1:]], axis=1) for one in edges])
    near = shapely.union_all(shapely.buffer(shapely.linestrings(legs), 0.5, quad_segs=64))
    true = room.difference(near)
    assert found.area == pytest.approx(true.area, rel=5e-3)
    check_gaps(room, found, 0.5)
