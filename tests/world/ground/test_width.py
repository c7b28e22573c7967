"""Width on the two sides of a path, against half-planes cut out by shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import examples, inside

corridor_boundaries, feet = inside("physim.world.ground", "corridor_boundaries", "feet")
offset_polyline, widths_at = inside("physim.world.ground", "offset_polyline", "widths_at")

SIDES = (1.0, -1.0)
"""left and right of a path"""
place = st.tuples(*[st.integers(-20, 20)] * 2)


@examples(25, deep=100)
@given(st.lists(st.tuples(place, place), max_size=8), place, st.integers(0, 62))
def test_sides_are_half_planes(
    lines: list[tuple[tuple[int, int], tuple[int, int]]], origin: tuple[int, int], turn: int
) -> None:
    """The nearest point on each side, where the half-plane is a large box."""
    lines = [line for line in lines if line[0] != line[1]]
    segments = np.array(lines, dtype=float).reshape(-1, 4)
    x, y = origin
    c, s = np.cos(0.1 * turn), np.sin(0.1 * turn)
    points, directions = np.array([[x, y]], dtype=float), np.array([[c, s]])
    found = [np.hypot(*(foot - points).T) for foot in feet(points, directions, segments, SIDES)]
    ends = segments.reshape(-1, 2) - points
    border = (abs(c * ends[:, 1] - s * ends[:, 0]) < 1e-9).any()  # there rounding decides
    for gap, side in zip(found, SIDES, strict=True):
        corners = [(-200, 0), (200, 0), (200, 200 * side), (-200, 200 * side)]
        half = shapely.Polygon([(x + a * c - b * s, y + a * s + b * c) for a, b in corners])
        part = shapely.MultiLineString(lines).intersection(half)
        expected = np.inf if part.is_empty else part.distance(shapely.Point(x, y))
        assert np.isclose(expected, gap[0], rtol=0, atol=1e-6) or border


def test_feet_lie_on_their_side_and_the_nearer_is_the_nearest_of_all() -> None:
    rng = np.random.default_rng(5)
    segments = rng.uniform(-10, 10, (3000, 4))
    points, angle = rng.uniform(-5, 5, (200, 2)), rng.uniform(0, 7, 200)
    directions = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    *sides, nearest = feet(points, directions, segments, (*SIDES, 0.0))
    for foot, sign in zip(sides, SIDES, strict=True):
        side = directions[:, 0] * (foot - points)[:, 1] - directions[:, 1] * (foot - points)[:, 0]
        assert (sign * side > -1e-9).all()
    gaps = [np.hypot(*(foot - points).T) for foot in (*sides, nearest)]
    assert np.allclose(np.minimum(*gaps[:2]), gaps[2])
    assert not np.isfinite(feet(points, directions, np.zeros((0, 4)), SIDES)).any()


def test_the_narrowest_place_is_the_middle_of_the_longest_narrow_stretch() -> None:
    """Two stretches, equally narrow: from 2 to 4 m and from 8 to 14 m."""
    walls = [[0.0, -3.0, 20.0, -3.0], [0.0, 3.0, 20.0, 3.0], [2.0, 1.0, 4.0, 1.0],
             [8.0, 1.0, 14.0, 1.0]]  # fmt: skip
    path = np.array([[0.0, 0.0], [20.0, 0.0]])
    found = widths_at(path, np.linspace(0.0, 20.0, 201), np.array(walls))
    assert found.narrowest is not None
    assert found.station[found.narrowest] == pytest.approx(11.0)


@pytest.mark.parametrize("aside", [-1.2, 0.0, 1.2])
@pytest.mark.parametrize("inward", [True, False])
def test_a_road_that_passes_itself_has_its_own_width_everywhere(aside: float, inward: bool) -> None:
    """A spiral of 2.5 turns, 5 m wide and 0.5 m between its turns: behind either wall of a turn
    lies the other wall of the next, nearer than the far side of the road."""
    angle = np.linspace(0.0, 5.0 * np.pi, 400)
    line = (8.0 + 5.5 * angle / (2.0 * np.pi))[:, None] * np.stack(
        [np.cos(angle), np.sin(angle)], axis=1
    )
    line = line[::-1] if inward else line
    walls = corridor_boundaries(line, np.full(len(line), 5.0), 2.0)
    left, right = (
        np.hstack([walls[side][:-1], walls[side][1:]]) for side in ("left wall", "right wall")
    )
    path = offset_polyline(line, np.full(len(line), aside))
    stations = np.linspace(0.0, np.hypot(*np.diff(path, axis=0).T).sum(), 600)
    found = widths_at(path, stations, np.zeros((0, 4)), (left, right))
    assert found.between.all()
    # chords of 0.1 m of a radius of 8 m leave the arc by less than 1 mm; the spiral's own widths
    # differ from 5 m by what its radius grows within the turn of a normal, 5.5 / (2 pi 8) of it
    assert np.allclose(found.width, 5.0, rtol=0, atol=0.02)
    assert np.allclose(found.left, 2.5 - aside, rtol=0, atol=0.02)
