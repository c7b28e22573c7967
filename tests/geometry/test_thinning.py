"""Finely drawn walls: their points, and the safe area between them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely

from physim.geometry.thinning import MANY
from physim.tolerances import LENGTH
from tests.helpers import inside

SIMPLER, SMALL, accessible_area = inside("physim.geometry", "SIMPLER", "SMALL", "accessible_area")
shrunk, FloatArray, LONGEST_RUN = inside("physim.geometry", "shrunk", "FloatArray", "LONGEST_RUN")
simplified, thinned = inside("physim.geometry", "simplified", "thinned")

ROOT = Path(__file__).parents[2]
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
    ("points", "roughness"), [(4_000, 1e-3), (4_000, 4e-3), (4_000, 4e-2), (1_200, 0.1)]
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


def comb(tooth: float, count: int) -> FloatArray:
    """Outline of a room of 3 m whose floor has teeth, eight edges from one to the next."""
    x = np.arange(8 * count + 1) * tooth / 8.0
    floor = np.stack([x, -0.4 * np.minimum(np.arange(len(x)) % 8, 1)], axis=1)
    return np.concatenate([floor, [[x[-1], 3.0], [0.0, 3.0]]])


def test_the_safe_area_reaches_in_between_teeth() -> None:
    """By 1.6 cm, between teeth that are 0.25 m apart."""
    room = shapely.Polygon(comb(0.25, 150))
    check_gaps(room, shrunk(room, 0.5, 16), 0.5)


MEMORY = """
from resource import RUSAGE_SELF, getrusage
from shapely import Polygon, get_parts, make_valid
from physim.geometry.area import shrunk
from tests.geometry.test_thinning import rough
room = max(get_parts(make_valid(Polygon(rough(20_000, 3e-3)))), key=lambda one: one.area)
before = getrusage(RUSAGE_SELF).ru_maxrss
area = shrunk(room, 0.5, 16).area
print(area, getrusage(RUSAGE_SELF).ru_maxrss - before)
"""


def test_rough_walls_of_many_points_take_little_memory() -> None:
    """Their arcs cross each other in pairs: 790 MB, if they are all grown at once."""
    command = [sys.executable, "-c", MEMORY]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-500:]
    area, grown = map(float, done.stdout.split())
    assert area == pytest.approx(2.0 * 1.0, rel=3e-2)
    assert grown < 200_000.0  # [kB]


ZIGZAG = np.stack((np.arange(100_000), np.arange(100_000) % 2), axis=1).astype(float)
"""A line all of whose points are corners: in one go it took all of the stack."""


def test_lines_of_many_corners_are_kept_whole() -> None:
    assert np.array_equal(thinned({"a": ZIGZAG})["a"], ZIGZAG)
    assert np.array_equal(simplified(ZIGZAG, LENGTH), ZIGZAG)


def test_what_stays_of_a_simplified_line_is_as_near_as_it_should() -> None:
    line = np.stack((np.linspace(0.0, 60.0, 35_000), np.zeros(35_000)), axis=1)
    line[:, 1] = np.sin(line[:, 0])
    kept = simplified(line, 1e-3, [7])
    assert len(kept) < 2_000
    for one in (line[0], line[7], line[LONGEST_RUN], line[-1]):
        assert (kept == one).all(axis=1).sum() == 1
    assert shapely.distance(shapely.LineString(kept), shapely.points(line)).max() <= 1e-3


def test_the_safe_area_of_an_outline_of_many_corners() -> None:
    sides = ZIGZAG[:35_000], ZIGZAG[:35_000][::-1] + (0.0, 8.0)
    room = shapely.Polygon(np.concatenate(sides))
    safe = shrunk(room, 1.0, 4)
    check_gaps(room, safe, 1.0)
    assert shapely.covers(safe, shapely.points(np.arange(2.0, 34_990.0, 500.0), 4.5)).all()
