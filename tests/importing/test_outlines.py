"""The way a drawn robot heads: along its path, as far as its outline says."""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests.helpers import inside

DENT, footprint_of = inside("physim.authoring.importing", "DENT", "footprint_of")
rectangle_of, without_dents = inside("physim.authoring.importing", "rectangle_of", "without_dents")
convex_parts, FloatArray = inside("physim.geometry", "convex_parts", "FloatArray")

AHEAD = np.array([1.0, 0.0])


def turned(points: FloatArray, angle: float) -> FloatArray:
    c, s = cos(angle), sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


@given(
    length=st.floats(0.3, 3.0).map(lambda x: round(x, 1)),
    width=st.floats(0.3, 3.0).map(lambda x: round(x, 1)),
    notch=st.floats(0.0, 0.2),
    angle=st.floats(-pi, pi),
)
def test_an_arrow_heads_where_it_points(
    length: float, width: float, notch: float, angle: float
) -> None:
    """All three rectangles about a triangle are as small; coordinates are to the millimetre."""
    arrow = np.array([[length, 0], [0, width / 2], [notch * length, 0], [0, -width / 2]])
    drawn = turned(arrow, angle).round(3)
    middle, heading = rectangle_of(drawn, turned(AHEAD[None], angle)[0])
    off = (heading - angle + pi) % (2 * pi) - pi
    assert abs(off) <= 0.0015 / min(length, width) + 1e-9  # of the last digit of two points
    wanted = turned(np.array([[length / 2, 0.0]]), angle)[0]
    assert hypot(*(middle - wanted)) <= 0.003
    own = np.asarray(footprint_of(drawn, middle, heading))
    assert own[:, 0].max() == pytest.approx(length / 2, abs=0.01)


TRIANGLE = [(0.6, 0.0), (-0.4, 0.3), (-0.4, -0.3)]
SHAFTED = [(0.5, 0.0), (0.1, 0.4), (0.1, 0.15), (-0.5, 0.15), (-0.5, -0.15), (0.1, -0.15),
           (0.1, -0.4)]  # fmt: skip
ROUNDED = [(0.5 * cos(a) + 0.3, 0.4 * sin(a)) for a in np.linspace(-pi / 2, pi / 2, 400)] + [
    (-0.7, 0.4),
    (-0.7, -0.4),
]


@pytest.mark.parametrize("off", [-20.0, -10.0, 0.0, 3.0, 20.0])
@pytest.mark.parametrize("outline", [TRIANGLE, SHAFTED, ROUNDED], ids=["triangle", "shaft", "nose"])
def test_what_points_heads_where_it_points_not_as_its_path_leads(
    outline: list[tuple[float, float]], off: float
) -> None:
    """A side of a triangle, or of an arrow's head, is nearer to some of these paths."""
    angle = np.radians(off)
    drawn = turned(np.array(outline), angle).round(3)
    middle, heading = rectangle_of(drawn, AHEAD)
    assert np.degrees(heading) == pytest.approx(off, abs=0.2)
    own = turned(np.array(outline), 0.0)
    half = (own.max(axis=0) + own.min(axis=0)) / 2.0
    assert hypot(*(middle - turned(half[None], angle)[0])) <= 0.003


@pytest.mark.parametrize("off", [-40.0, -10.0, 3.0, 20.0])
def test_an_l_heads_along_its_longer_arm_though_it_has_no_line_of_symmetry(off: float) -> None:
    arms = np.array([(0, 0), (1, 0), (1, 0.3), (0.3, 0.3), (0.3, 0.7), (0, 0.7)])
    angle = np.radians(off)
    _, heading = rectangle_of(turned(arms, angle).round(3), AHEAD)
    assert np.degrees(heading) == pytest.approx(off, abs=0.2)


@pytest.mark.parametrize("off", [-40.0, -10.0, 3.0, 44.0])
def test_a_box_heads_as_it_is_drawn_however_its_path_leads(off: float) -> None:
    box = np.array([[0.9, 0.4], [-0.9, 0.4], [-0.9, -0.4], [0.9, -0.4]])
    angle = np.radians(off)
    _, heading = rectangle_of(turned(box, angle), AHEAD)
    assert heading == pytest.approx(angle)


@pytest.mark.parametrize("radius", [0.0165, 0.3])
@pytest.mark.parametrize("corners", [12, 15, 30, 200])
def test_a_round_robot_heads_along_its_path(radius: float, corners: int) -> None:
    """The rectangles about a circle are as small in many directions; rounding chose one."""
    for angle in np.linspace(0.0, 2.0, 9):
        at = angle + np.linspace(0.0, 2.0 * pi, corners, endpoint=False)
        circle = (radius * np.stack([np.cos(at), np.sin(at)], axis=1)).round(3) + [4.0, 7.0]
        middle, heading = rectangle_of(circle, turned(AHEAD[None], 0.4)[0])
        assert heading == pytest.approx(0.4)
        assert middle == pytest.approx([4.0, 7.0], abs=0.06 * radius)


@pytest.mark.parametrize("longer", [1.1, 1.4, 2.5])
@pytest.mark.parametrize("corners", [24, 40, 100])
@pytest.mark.parametrize("off", [-0.6, -0.1, 0.05, 0.2])
def test_an_oval_robot_heads_along_its_longer_axis(longer: float, corners: int, off: float) -> None:
    """The rectangles beside it are hardly larger, and were taken where they are nearer the path."""
    at = np.linspace(0.0, 2.0 * pi, corners, endpoint=False)
    oval = np.stack([0.5 * longer * np.cos(at), 0.5 * np.sin(at)], axis=1)
    for one in (oval, oval[::-1]):
        heading = rectangle_of(turned(one, off).round(3), AHEAD)[1]
        assert heading == pytest.approx(off, abs=0.006)


@pytest.mark.parametrize(("length", "width", "cut"), [
    (1.0, 0.8, 0.05), (1.0, 1.0, 0.1), (1.8, 1.0, 0.05), (1.2, 1.0, 0.1), (1.8, 1.0, 0.3),
])  # fmt: skip
@pytest.mark.parametrize("count", [1, 4])
def test_a_box_without_its_corners_is_not_round(
    length: float, width: float, cut: float, count: int
) -> None:
    """All eight of its corners lie about as far from the middle."""
    x, y = 0.5 * length - cut, 0.5 * width - cut
    inner = shapely.box(-x, -y, x, y)
    style: Any = "bevel" if count == 1 else "round"
    outline = shapely.get_coordinates(inner.buffer(cut, quad_segs=count, join_style=style))[:-1]
    for off in (-0.6, -0.2, 0.1, 0.5):
        heading = rectangle_of(turned(outline, off).round(3), AHEAD)[1]
        assert heading == pytest.approx(off, abs=0.004)


@given(st.lists(st.tuples(st.floats(-2, 2), st.floats(-2, 2)), min_size=4, max_size=9))
def test_the_rectangle_is_as_small_as_that_of_shapely(points: list[tuple[float, float]]) -> None:
    hull = shapely.MultiPoint(points).convex_hull
    if hull.geom_type != "Polygon" or hull.area < 0.01:
        return
    outline = np.array(hull.exterior.coords)[:-1]
    middle, heading = rectangle_of(outline, AHEAD)
    own = turned(outline - middle, -heading)
    area = np.prod(np.ptp(own, axis=0))
    assert area <= 1.0101 * hull.minimum_rotated_rectangle.area
    assert own.min(axis=0) == pytest.approx(-own.max(axis=0), abs=1e-9)


def test_a_rectangle_lies_on_a_side() -> None:
    quad = np.array([[0.0, 0.0], [2.0, 0.3], [1.8, 1.1], [-0.1, 0.9]])
    _, heading = rectangle_of(quad, AHEAD)
    sides = np.diff(np.vstack([quad, quad[:1]]), axis=0)
    angles = [atan2(y, x) - heading for x, y in sides]
    assert min(abs((one + pi / 4) % (pi / 2) - pi / 4) for one in angles) < 1e-12


@pytest.mark.parametrize("radius", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("count", [16, 64, 128, 500])
def test_a_round_robot_of_many_points_is_one_convex_part(radius: float, count: int) -> None:
    """To the millimetre its outline is dented, and would be slivers of a millimetre."""
    angle = np.linspace(0.0, 2.0 * pi, count, endpoint=False)
    drawn = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    own = np.asarray(footprint_of(drawn + 3.0, np.array([3.0, 3.0]), 0.3))
    assert len(convex_parts(own)) == 1
    off = shapely.Polygon(own).hausdorff_distance(shapely.Polygon(turned(drawn, -0.3)))
    assert off <= 0.001 + DENT


OUTLINES = st.lists(st.floats(0.3, 1.0), min_size=4, max_size=40)


@given(OUTLINES, st.sampled_from([1.0, 0.004]))
def test_dents_are_filled_as_far_as_stated_and_no_further(radii: list[float], share: float) -> None:
    """Any star, and one that is round but for 4 mm."""
    angle = np.linspace(0.0, 2.0 * pi, len(radii), endpoint=False)
    radius = 1.0 - share * (1.0 - np.array(radii))
    star = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    found = without_dents(star)
    given, kept = shapely.Polygon(star), shapely.Polygon(found)
    assert {*map(tuple, found.tolist())} <= {*map(tuple, star.tolist())}
    if kept.is_valid:
        assert kept.buffer(1e-9).covers(given)
    gaps = shapely.distance(shapely.points(star), kept.exterior)
    assert gaps.max() <= DENT + 1e-9


def test_a_notch_that_is_drawn_stays() -> None:
    notched = np.array([(0, 0), (1, 0), (1, 0.6), (0.5, 0.597), (0, 0.6)])
    assert len(without_dents(notched)) == 5
    notched[3, 1] = 0.5985
    assert len(without_dents(notched)) == 4


def _round(longer: float) -> FloatArray:
    """A circle with a nose in front."""
    nose = shapely.box(0.0, -0.1, longer, 0.1)
    return shapely.get_coordinates(shapely.Point(0, 0).buffer(1.0).union(nose))[:-1]


POINTED = {
    "kite": [(0.9, 0), (0, 0.4), (-0.6, 0), (0, -0.4)],
    "arrow with a shaft": [(0.9, 0), (0.3, 0.5), (0.3, 0.2), (-0.9, 0.2), (-0.9, -0.2), (0.3, -0.2),
                           (0.3, -0.5)],
    "drop": [(1.4, 0), *((cos(t), sin(t)) for t in np.linspace(0.8, 2 * pi - 0.8, 25))],
    "circle with a nose": _round(1.2),
    "house": [(0.9, 0), (0.6, 0.5), (-0.9, 0.5), (-0.9, -0.5), (0.6, -0.5)],
}  # fmt: skip


@pytest.mark.parametrize("off", [-40.0, -15.0, 5.0, 25.0, 44.0])
@pytest.mark.parametrize("shape", POINTED)
def test_what_is_alike_on_both_sides_heads_along_its_middle(shape: str, off: float) -> None:
    """However its path leads: some side of it was taken where that lies nearer to the path."""
    outline = turned(np.array(POINTED[shape]), np.radians(off)).round(3)
    for one in (outline, outline[::-1]):
        assert rectangle_of(one, AHEAD)[1] == pytest.approx(np.radians(off), abs=0.006)


SIDED = {
    "L of equal arms": [(0, 0), (1, 0), (1, 0.3), (0.3, 0.3), (0.3, 1), (0, 1)],
    "box without a corner": [(0.4, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.5, 0.4)],
    "box with less of it": [(0.1, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5), (0.5, 0.1)],
}


@pytest.mark.parametrize("off", [-40.0, -15.0, 0.0, 25.0, 44.0])
@pytest.mark.parametrize("shape", SIDED)
def test_what_has_square_sides_heads_along_them_not_across(shape: str, off: float) -> None:
    """Alike on both sides of a diagonal, it would drive on a corner."""
    outline = turned(np.array(SIDED[shape], dtype=np.float64), np.radians(off)).round(3)
    assert rectangle_of(outline, AHEAD)[1] == pytest.approx(np.radians(off), abs=0.004)
