"""Stations followed from step to step: on the own path, and on the reference path."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers import inside

offset_polyline, SHORTEST_WINDOW = inside("physim.geometry", "offset_polyline", "SHORTEST_WINDOW")
Path, track, pack_polylines = inside("physim.geometry", "Path", "track", "pack_polylines")
Tracking = inside("physim.geometry", "Tracking")

OWN = [[[0.0, 2.0], [60.0, 2.0]], [[10.0, -3.0], [10.0, 40.0]]]
REFERENCE = [[-5.0, 0.0], [60.0, 0.0]]


@pytest.mark.parametrize("step", [0.015, 0.15])
def test_stations_follow_the_robots(step: float) -> None:
    """Two robots on straight paths, seen from a reference path that begins elsewhere."""
    t = step * np.arange(100)
    poses = np.zeros((100, 2, 3))
    poses[:, 0, 0], poses[:, 0, 1] = 3.0 + t, 2.5
    poses[:, 1, 0], poses[:, 1, 1] = 9.0, 1.0 + t
    paths, reference = pack_polylines(OWN), pack_polylines([REFERENCE])
    tracking = Tracking(paths, reference, np.array([0.2, 1.0]), poses[0])
    one_by_one = []
    for pose in poses:
        tracking.follow(pose)
        one_by_one.append(
            np.stack((tracking.station, tracking.deviation, tracking.reference_station), axis=1)
        )
    found = np.array(one_by_one)
    assert found[:, 0, 0] == pytest.approx(3.0 + t)
    assert found[:, 1, 0] == pytest.approx(4.0 + t)
    assert found[:, :, 1] == pytest.approx(np.tile([0.5, 1.0], (100, 1)))  # left positive
    assert found[:, 0, 2] == pytest.approx(8.0 + t)
    assert found[:, 1, 2] == pytest.approx(np.full(100, 14.0))
    again = Tracking(paths, reference, np.array([0.2, 1.0]), poses[0])
    assert np.array_equal(again.course(poses), found)


def test_a_path_that_passes_near_itself_does_not_attract() -> None:
    """Out along one leg of a hairpin 0.8 m wide, nearer to the other leg."""
    paths = pack_polylines([[[0.0, 0.0], [30.0, 0.0], [30.0, 0.8], [0.0, 0.8]]])
    start = np.array([[1.0, 0.1, 0.0]])
    tracking = Tracking(paths, paths, np.array([0.5]), start)
    for x in np.arange(1.0, 25.0, 0.1):
        tracking.follow(np.array([[x, 0.5, 0.0]]))
    assert tracking.station == pytest.approx([24.9])
    assert tracking.reference_station == pytest.approx([24.9])


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


def plain(paths, reference, radius, poses):
    """Stations (K, 3, N) by `track`, one robot after the other."""
    windows = np.maximum(SHORTEST_WINDOW, 2.0 * radius)
    found = np.zeros((len(poses) + 1, 3, len(radius)))
    for i in range(len(radius)):
        for k, (x, y, _) in enumerate(poses[:, i]):
            window = windows[i] if k else np.inf
            found[k + 1, :2, i] = track(paths, i, x, y, found[k, 0, i], window)
            found[k + 1, 2, i] = track(reference, 0, x, y, found[k, 2, i], window)[0]
    return found[1:]


def winding(rng, points):
    """A polyline that turns back on itself now and then, on a raster so that gaps tie."""
    turns = rng.choice([0.0, 0.0, 0.5, -0.5, 1.0, 0.25], points - 1) * np.pi
    length = rng.choice([0.05, 0.25, 0.5, 1.0, 3.0], points - 1)
    heading = np.cumsum(turns)
    steps = np.stack((length * np.cos(heading), length * np.sin(heading)), 1)
    return np.concatenate((np.zeros((1, 2)), np.cumsum(steps, axis=0))).round(rng.integers(2, 16))


def test_the_fast_form_is_the_plain_one_bit_for_bit() -> None:
    """Robots that wander, jump, and stand on corners and far beyond either end."""
    for seed in range(60):
        rng = np.random.default_rng(seed)
        robots = 4
        lines = [winding(rng, rng.integers(2, 40)) for _ in range(robots + 1)]
        paths, reference = pack_polylines(lines[:robots]), pack_polylines(lines[robots:])
        radius = rng.choice([0.2, 0.5, 1.5], robots)
        walk = rng.normal(0.0, rng.choice([0.05, 0.4]), (200, robots, 2)).cumsum(axis=0)
        at = (np.linspace(0.0, 1.2, 200)[:, None] * [len(line) for line in lines[:-1]]).astype(int)
        along = [line[np.minimum(at[:, i], len(line) - 1)] for i, line in enumerate(lines[:robots])]
        poses = np.zeros((200, robots, 3))
        poses[..., :2] = np.stack(along, axis=1) + walk * rng.choice([0.0, 0.1, 1.0])
        poses[rng.random((200, robots)) < 0.05, :2] = 0.0  # on the first point, all of a sudden
        tracking = Tracking(paths, reference, radius, poses[0])
        found = [tracking.stations]
        for pose in poses[1:]:
            tracking.follow(pose)
            found.append(tracking.stations)
        assert np.array(found).tobytes() == plain(paths, reference, radius, poses).tobytes()


def test_where_a_search_begins_changes_nothing() -> None:
    rng = np.random.default_rng(0)
    paths, reference = pack_polylines([winding(rng, 30)]), pack_polylines([winding(rng, 20)])
    poses = np.concatenate((rng.normal(0.0, 4.0, (100, 1, 2)), np.zeros((100, 1, 1))), axis=2)
    one, other = (Tracking(paths, reference, np.array([0.5]), poses[0]) for _ in range(2))
    for pose in poses:
        other.last[:, 0] = rng.integers(0, 29), 30 + rng.integers(0, 19)
        one.follow(pose)
        other.follow(pose)
        assert one.stations.tobytes() == other.stations.tobytes()
