from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from physim.world import World
from physim.world_file import parse_world
from physim.world_file.geometry_check import path_faults, shape_faults, start_faults
from tests.worlds_by_hand import STRAIGHT

EDGE = np.array([[-3, -4], [33, -4], [33, 4], [-3, 4], [-3, -4]], dtype=float)


def found(world: World, start=None, obstacles=(), accessible="free", paths=None):
    poses = [[x, y, 0.0 if h == "random" else h] for x, y, h in (r.pose for r in world.robots)]
    free = shapely.Polygon(EDGE)
    for ring in obstacles:
        free = free.difference(shapely.Polygon(ring))
    free = free if accessible == "free" else accessible
    paths = [np.array([[0, 1], [30, 1]])] * len(world.robots) if paths is None else paths
    faults = shape_faults(world) or [
        *path_faults(world, paths, free),
        *start_faults(
            world,
            start=np.array(poses if start is None else start, dtype=float),
            footprints=[np.array(robot.outline) for robot in world.robots],
            boundaries=[EDGE],
            obstacles=list(obstacles),
            accessible=free,
        ),
    ]
    return [(fault.location, fault.message) for fault in faults]


@pytest.fixture
def world() -> World:
    return parse_world(STRAIGHT)


def test_a_good_world_has_no_fault(world):
    assert found(world) == []


@pytest.mark.parametrize(
    ("first", "second", "where", "text"),
    [
        ((6, 1, 0), (7.5, 1, 0), 1, '"r2" overlaps "r1" by 0.3 m'),
        ((6, 1, 0), (7.8, 1, 0), 1, '"r2" touches "r1"'),
        ((6, 1, 0), (7.8 + 1e-10, 1, 0), 1, '"r2" touches "r1"'),
        ((6, 3.5, 0), (3, 0, 0), 0, '"r1" touches the edge of the corridor'),
        ((6, 3.5 - 5e-10, 0), (3, 0, 0), 0, '"r1" touches the edge of the corridor'),
        ((6, 3.75, 0), (3, 0, 0), 0, '"r1" reaches 0.25 m over the edge of the corridor'),
        ((6, 3.6, math.pi / 2), (3, 0, 0), 0, "reaches 0.5 m over"),
        ((6, 9, 0), (3, 0, 0), 0, '"r1" starts outside the accessible area, 4.5 m from it'),
        ((6, 1, 0), (20, 0, 0), 1, '"r2" overlaps obstacles[0] by 1 m'),
        ((6, 1, 0), (17.1, 0, 0), 1, '"r2" touches obstacles[0]'),
    ],
)
def test_robots_are_apart_from_all(world, first, second, where, text):
    block = np.array([[18, -1], [22, -1], [22, 1], [18, 1]], dtype=float)
    faults = found(world, start=[first, second], obstacles=[block])
    assert [location for location, _ in faults] == [("robots", where, "pose")]
    assert text in faults[0][1]


def test_a_gap_above_the_tolerance_is_a_gap(world):
    assert found(world, start=[(6, 1, 0), (7.8 + 2e-9, 1, 0)]) == []


def test_a_wall_inside_the_area_is_named(world):
    inner = [[10.0, 0.0], [12.0, 0.0]]
    boundaries = (tuple(map(tuple, EDGE)), tuple(map(tuple, inner)))
    drawn = world.changed(corridor=None, boundaries=boundaries, reference_path=[[0, 1], [30, 1]])
    faults = start_faults(
        drawn,
        start=[(11, 0, 0.3), (3, 0, 0)],
        footprints=[robot.outline for robot in drawn.robots],
        boundaries=[EDGE, np.array(inner)],
        obstacles=[],
        accessible=shapely.Polygon(EDGE),
    )
    assert [fault.location for fault in faults] == [("robots", 0, "pose")]
    assert "boundaries[1]" in faults[0].message


def test_boundaries_must_bound_a_face(world):
    faults = found(world, accessible=None)
    assert faults[0][0] == ("corridor",)
    assert "close no face" in faults[0][1]


def test_paths_need_two_points(world):
    paths = [np.array([[0, 1], [30, 1]]), np.array([[3, 1], [3, 1], [3, 1]])]
    assert found(world, paths=paths) == [(("robots", 1, "path"), "must have two distinct points")]


@pytest.mark.parametrize(
    ("outline", "text"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "crosses or touches itself at (0.5, 0.5)"),
        ([[0, 0], [1, 0], [2, 0]], "encloses no area"),
        ([[0, 0], [1, 0], [1, 1e-10]], "two"),
        ([[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]], "crosses or touches itself"),
    ],
)
def test_outlines_are_simple(world, outline, text):
    robots = (world.robots[0].model_copy(update={"footprint": tuple(map(tuple, outline))}),)
    bad = world.changed(robots=robots, formation=None, obstacles=[outline])
    faults = shape_faults(bad)
    assert [fault.location for fault in faults] == [("robots", 0, "footprint"), ("obstacles", 0)]
    if text != "two":
        assert text in faults[0].message
    assert found(bad)[0] == (faults[0].location, faults[0].message)


def test_a_step_that_would_tunnel_is_refused_and_the_largest_told(world):
    radius = math.hypot(0.9, 0.5)
    largest = 0.25 * 1.0 / (1.5 + radius * 1.6)
    just = world.changed(time={"step": largest * 0.999, "duration": largest * 9.99})
    assert shape_faults(just) == []
    over = world.changed(time={"step": largest * 1.001, "duration": largest * 10.01})
    faults = shape_faults(over)
    assert [fault.location for fault in faults] == [("time", "step")]
    assert "and 1 more too far" in faults[0].message
    told = float(faults[0].message.split("use a step of at most ")[1].split(" s")[0])
    assert told <= largest
    assert told == pytest.approx(largest, rel=0.01)
    assert "0.25 m are allowed" in faults[0].message


def test_one_robot_too_fast_for_a_usual_step_is_told_at_its_limits(world):
    fast = {**dict(world.robots[1]), "limits": {"v": 100.0}}
    faults = shape_faults(world.changed(robots=(world.robots[0], fast)))
    assert [fault.location for fault in faults] == [("robots", 1, "limits")]


def test_a_footprint_in_millimetres_is_told_as_such(world):
    large = {**dict(world.robots[1]), "footprint": [[900.0, 500.0], [-900.0, 500.0], [0.0, -500.0]]}
    faults = shape_faults(world.changed(robots=(world.robots[0], large)))
    assert [fault.location for fault in faults] == [("robots", 1, "footprint")]
    assert "is this one in millimetres?" in faults[0].message


def test_the_narrowest_part_of_any_robot_decides(world):
    thin = [[0, 0], [2, 0], [2, 0.05], [0.05, 0.05], [0.05, 2], [0, 2]]
    robots = (world.robots[0], world.robots[1].model_copy(update={"footprint": thin}))
    faults = shape_faults(world.changed(robots=(robots[0], {**dict(robots[1]), "footprint": thin})))
    assert [fault.location for fault in faults] == [("time", "step")]
    assert 'that of "r2"' in faults[0].message
