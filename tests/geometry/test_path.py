"""Paths: points, projection, and stations followed from step to step where a path nears itself."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.helpers import examples, inside

Path, track = inside("physim.geometry", "Path", "track")
offset_polyline = inside("physim.world.ground", "offset_polyline")
Tracking = inside("physim.geometry", "Tracking")

coordinate = st.floats(-50.0, 50.0).map(lambda value: round(value, 3))
points = st.lists(st.tuples(coordinate, coordinate), min_size=2, max_size=8)


def without_repeats(waypoints: list[tuple[float, float]]) -> list[tuple[float, float]]:
    kept = [waypoints[0]]
    kept += [b for a, b in zip(waypoints, waypoints[1:], strict=False) if a != b]
    assume(len(kept) >= 2)
    return kept


@examples(25, deep=100)
@given(points, coordinate, coordinate)
def test_projection_agrees_with_shapely(
    waypoints: list[tuple[float, float]], x: float, y: float
) -> None:
    waypoints = without_repeats(waypoints)
    path = Path(waypoints)
    line = shapely.LineString(waypoints)
    station, deviation = path.project(x, y)
    assert path.length == pytest.approx(line.length)
    assert abs(deviation) == pytest.approx(line.distance(shapely.Point(x, y)), abs=1e-9)
    assert np.hypot(*(path.point(station) - (x, y))) == pytest.approx(abs(deviation), abs=1e-9)


@examples(25, deep=100)
@given(points, st.floats(-10.0, 300.0))
def test_point_at_a_station_agrees_with_shapely(
    waypoints: list[tuple[float, float]], station: float
) -> None:
    waypoints = without_repeats(waypoints)
    path = Path(waypoints)
    clamped = min(max(station, 0.0), path.length)
    expected = shapely.LineString(waypoints).interpolate(clamped)
    assert path.point(station) == pytest.approx((expected.x, expected.y), abs=1e-9)


def test_left_of_the_path_is_positive() -> None:
    path = Path([(0.0, 0.0), (10.0, 0.0)])
    assert path.project(4.0, 1.5) == pytest.approx((4.0, 1.5))
    assert path.project(4.0, -1.5) == pytest.approx((4.0, -1.5))


@pytest.mark.parametrize("turn", [20, 60, 90, 120, 150, 170])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_outside_of_a_turn_is_one_side_all_the_way_round(turn: float, side: float) -> None:
    """Of either leg alone, past 90 degrees, a part of the outside lies on the other side."""
    angle = side * np.radians(turn)
    path = Path([(0.0, 0.0), (20.0, 0.0), (20.0 + 9.0 * np.cos(angle), 9.0 * np.sin(angle))])
    for bearing in np.linspace(-0.5 * np.pi, turn * np.pi / 180.0 - 0.5 * np.pi, 9)[1:-1]:
        x, y = 20.0 + 0.7 * np.cos(bearing), side * 0.7 * np.sin(bearing)
        assert path.project(x, y) == pytest.approx((20.0, -side * 0.7))
        assert path.project(x, y, near=20.2, window=0.5) == pytest.approx((20.0, -side * 0.7))
        tracking = Tracking(path.lines, path.lines, np.array([0.3]), np.array([[x, y, 0.0]]))
        assert tracking.deviation == pytest.approx(-side * 0.7)


def test_outside_of_a_turn_is_one_side_though_rounding_puts_it_on_the_leg_behind() -> None:
    """A waypoint lies nearest as the end of one leg, and by a digit nearer as that of the other."""
    path = Path([(0.0, 0.0), (3.1, 3.9), (4.3, 0.1)])
    pose = np.array([[2.6, 4.6, 0.0]])
    assert path.project(*pose[0, :2])[1] == pytest.approx(np.hypot(0.5, 0.7))
    tracking = Tracking(path.lines, path.lines, np.array([0.3]), pose)
    assert tracking.deviation == pytest.approx(np.hypot(0.5, 0.7))


def test_projection_does_not_jump_to_a_branch_nearby() -> None:
    """A hairpin 0.8 m wide: driving out along one leg, 0.5 m to the side of the other leg."""
    path = Path([(0.0, 0.0), (30.0, 0.0), (30.0, 0.8), (0.0, 0.8)])
    station, jumped = 0.0, False
    for x in np.arange(0.0, 25.0, 0.02):
        new, *_ = track(path.lines, 0, x, 0.5, station, 1.0)
        assert abs(new - station) < 0.05
        station = new
        jumped = jumped or abs(path.project(x, 0.5)[0] - station) > 5.0
    assert station == pytest.approx(24.98)
    assert jumped  # the plain nearest point lies on the other leg: the test can fail


def test_target_past_the_end_is_the_last_waypoint() -> None:
    path = Path([(0.0, 0.0), (3.0, 0.0)])
    assert path.target(2.5, 2.0) == pytest.approx((3.0, 0.0))


# Followed from step to step


@pytest.mark.parametrize(("radius", "moved"), [(0.05, 0.11), (0.05, 1.0), (0.8, 1.6)])
def test_a_robot_is_looked_for_two_radii_away_and_a_metre_at_least(
    radius: float, moved: float
) -> None:
    path = Path([(0.0, 0.0), (9.0, 0.0)])
    tracking = Tracking(path.lines, path.lines, np.array([radius]), np.array([[4.0, 0.0, 0.0]]))
    for x in (4.0 + moved, 4.0):
        tracking.follow(np.array([[x, 0.0, 0.0]]))
        assert tracking.stations == pytest.approx(np.array([[x], [0.0], [x]]), abs=1e-12)


@pytest.mark.parametrize("turn", [30, 60, 90, 120, 140])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_stations_go_round_a_corner_with_the_robot(turn: float, side: float) -> None:
    """2 m inside of the corner, or outside: at the end the nearest point of the path is the one
    that it has of all its points, and nowhere farther from the robot than that by 1 mm. So of the
    robot's own path, and of s*."""
    angle = np.radians(turn)
    line = np.array([[0.0, 0.0], [40.0, 0.0], [40.0 + 40.0 * np.cos(angle), 40.0 * np.sin(angle)]])
    lane = offset_polyline(line, np.full(3, 2.0 * side))
    way = Path(lane)
    poses = np.array([[[*way.point(s), 0.0]] for s in np.arange(0.0, way.length, 0.02)])
    reference = Path(line)
    tracking = Tracking(reference.lines, reference.lines, np.array([0.5]), poses[0])
    found = tracking.course(poses)[:, 0]
    assert np.array_equal(found[:, 0], found[:, 2])
    for (x, y, _), (station, deviation, _) in zip(poses[:, 0], found, strict=True):
        nearest = abs(reference.project(x, y)[1])
        assert np.hypot(*(reference.point(station) - (x, y))) <= nearest + 1e-3
        assert abs(deviation) <= nearest + 1e-3
    assert found[-1, 0] == pytest.approx(reference.project(*poses[-1, 0, :2])[0])
