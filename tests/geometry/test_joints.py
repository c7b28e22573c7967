"""Walls that end on one another enclose an area, however they are turned and drawn."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import inside

accessible_area, REACH, joined = inside("physim.geometry", "accessible_area", "REACH", "joined")
FloatArray = inside("physim.geometry", "FloatArray")

WALLS = [
    np.array([[-5.0, 4.0], [55.0, 4.0]]),
    np.array([[-5.0, -4.0], [55.0, -4.0]]),
    np.array([[-3.0, 4.0], [-3.0, -4.0]]),
    np.array([[51.0, 4.0], [51.0, -4.0]]),
    np.array([[30.0, 4.0], [30.0, -4.0]]),
]
WAY = np.array([[0.0, 0.0], [25.0, 0.0]])


def turned(points: FloatArray, angle: float, at: tuple[float, float] = (0.0, 0.0)) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + at)


@given(angle=st.floats(-3.2, 3.2), x=st.floats(-1e3, 1e3), y=st.floats(-1e3, 1e3))
def test_walls_that_end_on_slanted_walls_enclose_what_they_do_when_level(
    angle: float, x: float, y: float
) -> None:
    """A room of 33 x 8 m; digits of a point beside the origin are lost with the distance."""
    walls = [turned(wall, angle, (x, y)) for wall in WALLS]
    area = accessible_area(walls, [], turned(WAY, angle, (x, y)))
    assert area.polygon.area == pytest.approx(33.0 * 8.0, abs=1e-6)
    assert len(area.accessible_rings) == 1


def rooms(walls: list[FloatArray]) -> list[float]:
    """Areas [m^2] that walls enclose, as they stand."""
    found = shapely.polygonize([shapely.unary_union(list(map(shapely.LineString, walls)))])
    return sorted(round(part.area, 6) for part in shapely.get_parts(found))


def test_without_their_joints_some_slanted_walls_do_not_enclose_their_rooms() -> None:
    """The null arm: of a turn either way the ends lie on the walls, or 1e-16 m beside."""
    whole = [21.0 * 8.0, 33.0 * 8.0]
    turns = [[turned(wall, angle) for wall in WALLS] for angle in np.linspace(0.1, 1.4, 14)]
    assert all(rooms(joined(walls)) == whole for walls in turns)
    assert any(rooms(walls) != whole for walls in turns)


def test_lines_that_share_their_points_stay_as_they_are() -> None:
    room = np.array([[0.0, 0.0], [3.0, 1.0], [2.0, 5.0], [0.0, 0.0]])
    beside = room[:2] + (0.0, -10.0 * REACH)
    lines = [room, room[1:3], beside]
    for one, other in zip(joined(lines), lines, strict=True):
        assert one is other


def test_only_the_wall_gets_points_in_the_order_in_which_it_passes_them() -> None:
    wall = np.array([[10.0, 5.0], [0.0, 0.0]])
    ends = [np.array([[2.0, 1.0], [2.0, -4.0]]), np.array([[8.0, 9.0], [8.0, 4.0]]),
            np.array([[4.0, 2.0], [6.0, 3.0], [5.0, 9.0]])]  # fmt: skip
    first, *rest = joined([wall, *ends])
    assert first[:, 0].tolist() == [10.0, 8.0, 6.0, 4.0, 2.0, 0.0]
    for one, other in zip(rest, ends, strict=True):
        assert np.array_equal(one, other)
