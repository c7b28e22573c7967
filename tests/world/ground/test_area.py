"""Corridor walls, accessible and safe area, width along a path."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.helpers import inside

accessible_area = inside("physim.world.ground", "accessible_area")
FloatArray = inside("physim.geometry", "FloatArray")
corridor_boundaries = inside("physim.world.ground", "corridor_boundaries")
offset_polyline = inside("physim.world.ground", "offset_polyline")

STRAIGHT = np.array([[0.0, 0.0], [20.0, 0.0]])


def box(x0: float, y0: float, x1: float, y1: float) -> FloatArray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def test_straight_corridor_is_closed_beyond_both_ends() -> None:
    walls = corridor_boundaries(STRAIGHT, np.array([8.0, 8.0]), 3.0)
    area = accessible_area(list(walls.values()), [], STRAIGHT)
    assert area.polygon.equals(shapely.box(-3.0, -4.0, 23.0, 4.0))


def test_obstacles_are_holes_and_what_they_cut_off_is_not_accessible() -> None:
    walls = corridor_boundaries(STRAIGHT, np.array([8.0, 8.0]), 3.0)
    area = accessible_area(list(walls.values()), [box(5, 1, 7, 3), box(21.5, -5, 22, 5)], STRAIGHT)
    assert area.polygon.equals(
        shapely.box(-3.0, -4.0, 21.5, 4.0).difference(shapely.box(5, 1, 7, 3))
    )
    assert len(area.accessible_rings) == 2


def test_what_an_obstacle_cuts_off_is_not_accessible_however_large_it_is() -> None:
    rim = box(-3, -4, 100, 4)
    area = accessible_area([np.vstack([rim, rim[:1]])], [box(21, -5, 22, 5)], STRAIGHT)
    assert area.polygon.equals(shapely.box(-3, -4, 21, 4))


def row_of_shelves(draw: np.random.Generator) -> list[list[list[float]]]:
    """Boxes end to end at any angle, whose corners differ by rounding."""
    angle, length, depth = draw.uniform(0, 2 * np.pi), draw.uniform(0.3, 6), draw.uniform(0.2, 3)
    along, aside = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    first = draw.uniform(-300, 300, 2)
    corners = [first + k * length * along for k in range(draw.integers(3, 12))]
    return [
        [list(a), list(a + length * along), list(a + length * along + depth * aside),
         list(a + depth * aside)] for a in corners
    ]  # fmt: skip


def test_no_shelf_of_a_row_is_left_out() -> None:
    draw = np.random.default_rng(5)
    for shelves in (row_of_shelves(draw) for _ in range(150)):
        solids = [shapely.Polygon(shelf) for shelf in shelves]
        x0, y0, x1, y1 = shapely.total_bounds(solids) + (-5, -5, 5, 5)
        face, path = box(x0, y0, x1, y1), np.array([[x0 + 1, y0 + 1], [x1 - 1, y0 + 1]])
        free = accessible_area([np.vstack([face, face[:1]])], list(map(np.array, shelves)), path)
        assert not shapely.contains(free.polygon, shapely.point_on_surface(solids)).any()
        left = (x1 - x0) * (y1 - y0) - shapely.area(solids).sum()
        assert free.polygon.area == pytest.approx(left, abs=1e-5)


def test_of_two_faces_the_one_with_the_path_is_accessible() -> None:
    """Whichever is drawn first, and however large the other is."""
    rooms = [box(-3, -4, 23, 4), box(-3, 10, 60, 40)]
    lines = [np.vstack([room, room[:1]]) for room in rooms]
    for drawn in (lines, lines[::-1]):
        assert accessible_area(drawn, [], STRAIGHT).polygon.equals(shapely.box(-3, -4, 23, 4))
        away = accessible_area(drawn, [], STRAIGHT + (0, 20))
        assert away.polygon.equals(shapely.box(-3, 10, 60, 40))


@pytest.mark.parametrize(
    ("boundaries", "reference"),
    [
        ([STRAIGHT + (0, 4), STRAIGHT - (0, 4)], STRAIGHT),
        ([np.vstack([box(30, 0, 40, 5), [[30, 0]]])], STRAIGHT),
    ],
)
def test_boundaries_that_enclose_nothing_are_refused(
    boundaries: list[FloatArray], reference: FloatArray
) -> None:
    with pytest.raises(ValueError, match="enclose"):
        accessible_area(boundaries, [], reference)


def test_offset_of_a_right_angle_is_mitred() -> None:
    corner = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    assert offset_polyline(corner, np.full(3, 1.0)) == pytest.approx(
        np.array([[0.0, 1.0], [9.0, 1.0], [9.0, 10.0]])
    )


def test_outside_stretches_of_a_path_of_two_laps() -> None:
    """An obstacle on the road is on the path in every lap; it was so in the first alone."""
    lap = [(5.0, 0.0), (20.0, 0.0), (20.0, 15.0), (0.0, 15.0), (0.0, 0.0)]
    path = np.array([(2.0, 0.0), *lap, *lap, (5.0, 0.0)])
    hall = np.array([(-5.0, -5.0), (25.0, -5.0), (25.0, 20.0), (-5.0, 20.0), (-5.0, -5.0)])
    block = np.array([(9.0, -0.5), (11.0, -0.5), (11.0, 0.5), (9.0, 0.5)])
    area = accessible_area([hall], [block], path[:5])
    wanted = np.array([[7.0, 9.0], [77.0, 79.0]])
    assert area.outside_stretches(path) == pytest.approx(wanted)


def test_safe_rings_lie_inside_the_true_safe_area() -> None:
    walls = corridor_boundaries(STRAIGHT, np.array([8.0, 6.0]), 3.0)
    area = accessible_area(list(walls.values()), [], STRAIGHT)
    (ring,) = area.safe_rings(1.0)
    gaps = shapely.distance(area.polygon.exterior, shapely.points(ring))
    assert gaps.min() == pytest.approx(1.0, abs=1e-9)


def test_a_wall_that_stands_in_the_area_has_a_danger_area() -> None:
    """It encloses nothing, so it is no edge of the face, but no place near it is safe."""
    walls = list(corridor_boundaries(STRAIGHT, np.array([8.0, 8.0]), 3.0).values())
    wall, alone = np.array([[10.0, -4.0], [10.0, 1.0]]), np.array([[15.0, -1.0], [15.0, 1.0]])
    area = accessible_area([*walls, wall, alone], [], STRAIGHT)
    assert area.polygon.equals(shapely.box(-3.0, -4.0, 23.0, 4.0))
    for line in (wall, alone):
        assert area.inner.covers(shapely.LineString(line))
    safe = shapely.unary_union([shapely.Polygon(ring) for ring in area.safe_rings(1.0)[:1]])
    holes = [shapely.Polygon(ring) for ring in area.safe_rings(1.0)[1:]]
    safe = safe.difference(shapely.unary_union(holes))
    for line in (wall, alone):
        assert safe.distance(shapely.LineString(line)) == pytest.approx(1.0, abs=2e-3)
    room = safe.buffer(1e-9).covers(shapely.points([[8.9, 0.0], [11.1, 0.0], [15.0, 2.1]]))
    assert room.all()


@given(angle=st.floats(-3.2, 3.2), x=st.floats(-1e3, 1e3), y=st.floats(-1e3, 1e3))
@settings(max_examples=25)
def test_walls_that_end_on_slanted_walls_enclose_what_they_do_when_level(
    angle: float, x: float, y: float
) -> None:
    """A room of 33 x 8 m; digits of a point beside the origin are lost with the distance."""
    c, s = np.cos(angle), np.sin(angle)
    lines = [
        [[-5, 4], [55, 4]],
        [[-5, -4], [55, -4]],
        *([[at, 4], [at, -4]] for at in (-3, 51, 30)),
    ]
    way, *walls = (
        np.array(line, float) @ np.array([[c, s], [-s, c]]) + (x, y)
        for line in ([[0, 0], [25, 0]], *lines)
    )
    area = accessible_area(walls, [], way)
    assert area.polygon.area == pytest.approx(33.0 * 8.0, abs=1e-6)
    assert len(area.accessible_rings) == 1
