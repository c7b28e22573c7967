"""Walls that end on one another enclose an area, however they are turned and drawn."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from physim.geometry.area import accessible_area
from physim.geometry.joints import REACH, joined
from physim.geometry.shapes import FloatArray

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


@pytest.mark.parametrize("angle", np.linspace(0.1, 1.4, 14).tolist())
def test_without_the_joints_such_walls_may_enclose_nothing(angle: float) -> None:
    """What the test above rests on: as they are drawn some of the ends do not touch."""
    walls = [turned(wall, angle) for wall in WALLS]
    plain = shapely.polygonize([shapely.unary_union(list(map(shapely.LineString, walls)))])
    whole = shapely.polygonize([shapely.unary_union(list(map(shapely.LineString, joined(walls))))])
    areas = sorted(round(part.area, 6) for part in shapely.get_parts(whole))
    assert areas == [21.0 * 8.0, 33.0 * 8.0]
    assert len(shapely.get_parts(plain)) <= 2


def test_some_turn_tears_them_apart_without() -> None:
    apart = 0
    for angle in np.linspace(0.1, 1.4, 14):
        lines = [shapely.LineString(turned(wall, angle)) for wall in WALLS]
        apart += len(shapely.get_parts(shapely.polygonize([shapely.unary_union(lines)]))) < 2
    assert apart


def test_lines_that_share_their_points_stay_as_they_are() -> None:
    room = np.array([[0.0, 0.0], [3.0, 1.0], [2.0, 5.0], [0.0, 0.0]])
    beside = room[:2] + (0.0, -10.0 * REACH)
    lines = [room, room[1:3], beside]
    for one, other in zip(joined(lines), lines, strict=True):
        assert one is other


def test_points_stand_in_the_order_in_which_the_line_passes_them() -> None:
    wall = np.array([[10.0, 5.0], [0.0, 0.0]])
    ends = [np.array([[2.0, 1.0], [2.0, -4.0]]), np.array([[8.0, 9.0], [8.0, 4.0]]),
            np.array([[4.0, 2.0], [6.0, 3.0], [5.0, 9.0]])]  # fmt: skip
    first, *rest = joined([wall, *ends])
    assert first[:, 0].tolist() == [10.0, 8.0, 6.0, 4.0, 2.0, 0.0]
    # the third lies along the wall, so that the ends of it are on the wall and nothing on it
    for one, other in zip(rest, ends, strict=True):
        assert np.array_equal(one, other)
