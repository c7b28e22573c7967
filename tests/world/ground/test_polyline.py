"""Polylines by arc length, held against shapely's own stations, and outlines where they stand."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.helpers import inside

Polyline, placed_outline, placed_outlines = inside(
    "physim.world.ground", "Polyline", "placed_outline", "placed_outlines"
)

CORNER = Polyline([(0, 0), (4, 0), (4, 3)])
RING = Polyline([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)])
coordinates = st.floats(-50, 50).map(lambda value: round(value, 3))
points = st.lists(st.tuples(coordinates, coordinates), min_size=2, max_size=8, unique=True)


@given(points, st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=5))
@settings(max_examples=40)
def test_stations_are_those_of_shapely(line, places):
    made, shape = Polyline(line), shapely.LineString(line)
    station = made.nearest(places)
    assert made.length == pytest.approx(shape.length)
    found = made.at(station)[0]
    away = np.hypot(*(found - np.array(places)).T)
    assert away == pytest.approx(shapely.distance(shape, shapely.points(places)), abs=1e-9)
    on = shapely.line_interpolate_point(shape, station)
    assert shapely.get_coordinates(on) == pytest.approx(found, abs=1e-9)
    place, _, at, far = made.within(places, away + 1e-6)
    assert set(place) == set(range(len(places)))
    assert (far <= away[place] + 1e-6 + 1e-12).all()
    assert np.hypot(*(made.at(at)[0] - np.array(places)[place]).T) == pytest.approx(far, abs=1e-9)


def test_places_directions_and_stretches():
    place, direction = CORNER.at([-1.0, 1.0, 4.0, 9.0])
    assert place.tolist() == [[0, 0], [1, 0], [4, 0], [4, 3]]
    assert direction.tolist() == [[1, 0], [1, 0], [0, 1], [0, 1]]
    assert CORNER.at(5.0)[0].tolist() == [4, 1]
    assert CORNER.stretch(1.0, 6.0).tolist() == [[1, 0], [4, 0], [4, 2]]
    assert RING.nearest([(0, 0)]).tolist() == [0.0]
    assert CORNER.chords(4.0, 2.0) == pytest.approx([0.5**0.5, 0.5**0.5])
    assert CORNER.chords([0.0], 2.0).tolist() == [[1, 0]]
    assert RING.chords(0.0, 2.0) == pytest.approx([0.5**0.5, -(0.5**0.5)])
    assert (RING.is_ring(), CORNER.is_ring(), CORNER.is_ring(within=5.0)) == (True, False, True)


@pytest.mark.parametrize(
    ("line", "pairs"),
    [
        (CORNER.points, []),
        (RING.points, []),
        ([(0, 0), (4, 0), (4, 4), (2, 4), (2, -1)], [(0, 3)]),
        ([(0, 0), (4, 0), (2, 0), (2, 3)], [(0, 1), (0, 2)]),  # turned back, then off it
    ],
)
def test_crossings_are_where_it_meets_itself_but_for_joints(line, pairs):
    found = Polyline(line).crossings()
    assert [(i, j) for i, j, _ in found] == pairs
    segments = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    for i, j, at in found:
        assert shapely.distance(segments[[i, j]], shapely.Point(at)) == pytest.approx([0, 0])


def test_an_outline_stands_as_its_pose_says():
    box = np.array([(-1, -0.5), (2, -0.5), (2, 0.5), (-1, 0.5)])
    poses = np.array([(10, 20, 0.0), (10, 20, np.pi / 2)])
    straight, turned = placed_outlines(box, poses)
    assert straight.bounds == pytest.approx((9, 19.5, 12, 20.5))
    assert turned.bounds == pytest.approx((9.5, 19, 10.5, 22))
    assert placed_outline(box, poses[1]).equals(turned)
