from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from physim.errors import PhysimError
from tests.helpers import examples, inside

circumscribed_radius = inside("physim.geometry", "circumscribed_radius")
convex_parts, counter_clockwise = inside("physim.geometry", "convex_parts", "counter_clockwise")
is_simple, least_width = inside("physim.geometry", "is_simple", "least_width")
signed_area, smallest_width = inside("physim.geometry", "signed_area", "smallest_width")

L = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
U = [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]
T = [(0, 0), (1, 0), (1, 2), (2, 2), (2, 3), (-1, 3), (-1, 2), (0, 2)]
PLUS = [(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2),
        (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)]  # fmt: skip


@st.composite
def star_polygons(draw):
    """Simple polygons of any kind of corner: a ray each, at increasing angles."""
    n = draw(st.integers(3, 14))
    radii = draw(st.lists(st.floats(0.2, 5.0), min_size=n, max_size=n))
    steps = np.array(draw(st.lists(st.floats(0.1, 1.0), min_size=n, max_size=n)))
    angles = np.cumsum(steps) / steps.sum() * 2 * math.pi
    ring = np.array(radii)[:, None] * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    return ring[:: draw(st.sampled_from([1, -1]))] + draw(st.sampled_from([0.0, 100.0]))


@st.composite
def grid_polygons(draw):
    """Unions of cells of a grid, outlines with many collinear corners."""
    cells = draw(st.sets(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=1, max_size=14))
    union = shapely.unary_union([shapely.box(x, y, x + 1, y + 1) for x, y in cells])
    assume(union.geom_type == "Polygon" and not union.interiors)
    ring = shapely.get_coordinates(union.segmentize(draw(st.sampled_from([0.5, 9.0]))))[:-1]
    angle = draw(st.sampled_from([0.0, 0.3, 1.0]))
    c, s = math.cos(angle), math.sin(angle)
    return ring @ np.array([[c, s], [-s, c]])


def check_parts(polygon, parts):
    whole = shapely.Polygon(polygon)
    scale = max(1.0, whole.area)
    shapes = [shapely.Polygon(part) for part in parts]
    for part, shape in zip(parts, shapes, strict=True):
        assert signed_area(part) > 0.0
        assert shape.convex_hull.area - shape.area <= 1e-9 * scale
    assert abs(sum(shape.area for shape in shapes) - whole.area) <= 1e-9 * scale
    assert shapely.unary_union(shapes).symmetric_difference(whole).area <= 1e-9 * scale
    given_corners = {tuple(corner) for corner in np.asarray(polygon, dtype=float).tolist()}
    assert all(tuple(corner) in given_corners for part in parts for corner in part.tolist())


@examples(25, deep=100)
@given(star_polygons() | grid_polygons())
def test_parts_are_convex_and_cover_exactly(polygon):
    assume(is_simple(polygon))
    check_parts(polygon, convex_parts(polygon))


@pytest.mark.parametrize(("polygon", "parts"), [(L, 2), (U, 3), (T, 2), (PLUS, 3)])
@pytest.mark.parametrize("angle", [0.0, 0.7])
@pytest.mark.parametrize("turn", [1, -1])
def test_shapes_of_robots_have_few_fat_parts(polygon, parts, angle, turn):
    c, s = math.cos(angle), math.sin(angle)
    ring = np.array(polygon[::turn], dtype=float) @ np.array([[c, s], [-s, c]])
    found = convex_parts(ring)
    check_parts(ring, found)
    assert len(found) == parts
    assert smallest_width(found) == pytest.approx(1.0)


def test_a_convex_polygon_is_its_own_part():
    ring = [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)]
    (part,) = convex_parts(ring)
    assert part.tolist() == [[0, 0], [2, 0], [2, 1], [0, 1]]


@pytest.mark.parametrize(
    "polygon",
    [
        [(0, 0), (1, 1), (1, 0), (0, 1)],
        [(0, 0), (1, 0), (2, 0)],
        [(0, 0), (1, 0)],
        [],
        [(0, 0), (2, 0), (2, 2), (1, 0), (0, 2)],
        [(0, 0), (1, 0), (math.nan, 1)],
        [(0, 0), (2, 0), (1, 0), (1, 1)],
    ],
)
def test_polygons_that_are_not_simple_are_refused(polygon):
    assert not is_simple(polygon)
    with pytest.raises(PhysimError, match="crosses or touches itself"):
        convex_parts(polygon)


@examples(25, deep=100)
@given(star_polygons())
def test_area_and_direction(polygon):
    assert abs(signed_area(polygon)) == pytest.approx(shapely.Polygon(polygon).area, abs=1e-9)
    assert signed_area(counter_clockwise(polygon)) > 0.0
    assert signed_area(counter_clockwise(polygon[::-1])) == pytest.approx(
        signed_area(counter_clockwise(polygon)), abs=1e-9
    )


@examples(25, deep=100)
@given(star_polygons())
def test_width_against_sampled_directions(polygon):
    hull = shapely.Polygon(polygon).convex_hull
    rectangle = shapely.get_coordinates(shapely.oriented_envelope(hull))
    sides = np.hypot(*np.diff(rectangle, axis=0).T)
    assert least_width(polygon) <= sides.min() + 1e-9
    angles = np.linspace(0, math.pi, 2001)
    spans = np.ptp(np.asarray(polygon) @ np.stack((np.cos(angles), np.sin(angles))), axis=0)
    assert least_width(polygon) <= spans.min() + 1e-9
    assert spans.min() <= least_width(polygon) + 10.0 * math.pi / 2000


def test_width_of_known_shapes():
    assert least_width([(0, 0), (2, 0), (2, 1), (0, 1)]) == 1.0
    assert least_width([(0, 0), (3, 0), (0, 4)]) == pytest.approx(2.4)
    assert least_width([(0, 0), (1, 1), (2, 2)]) == 0.0
    assert circumscribed_radius([(0, 0), (3, 4), (1, 0)]) == 5.0
