"""Faults of shapes and places, as the layout of a world finds them."""

from __future__ import annotations

import math
import re

import pytest

from physim.errors import Fault
from physim.world import World
from physim.world.file import parse_world
from tests.helpers import STRAIGHT, facts, inside

partial_layout = inside("physim.world.layout", "partial_layout")

EDGE = [[-3.0, -4.0], [33.0, -4.0], [33.0, 4.0], [-3.0, 4.0], [-3.0, -4.0]]


def found(world: World) -> list[Fault]:
    return list(partial_layout(world).faults)


def standing(world: World, *poses: tuple[float, float, float]) -> World:
    """The world with its robots at these poses."""
    pairs = zip(world.robots, poses, strict=True)
    return world.changed(robots=[{**dict(robot), "pose": pose} for robot, pose in pairs])


def places(faults: list[Fault]) -> list[tuple]:
    return [fault.location for fault in faults]


@pytest.fixture
def world() -> World:
    return parse_world(STRAIGHT)


def test_a_good_world_has_no_fault(world):
    assert found(world) == []


@pytest.mark.parametrize(
    ("first", "second", "where", "parts"),
    [
        ((6, 1, 0), (7.5, 1, 0), 1, ('"r2"', "overlaps", '"r1"', "0.3 m")),
        ((6, 1, 0), (7.8, 1, 0), 1, ('"r2"', "touches", '"r1"')),
        ((6, 1, 0), (7.8 + 1e-10, 1, 0), 1, ('"r2"', "touches", '"r1"')),
        ((6, 3.5, 0), (3, 0, 0), 0, ('"r1"', "touches", "corridor")),
        ((6, 3.5 - 5e-10, 0), (3, 0, 0), 0, ('"r1"', "touches", "corridor")),
        ((6, 3.75, 0), (3, 0, 0), 0, ('"r1"', "0.25 m over", "corridor")),
        ((6, 3.6, math.pi / 2), (3, 0, 0), 0, ('"r1"', "0.5 m over", "corridor")),
        ((6, 9, 0), (3, 0, 0), 0, ('"r1"', "outside", "4.5 m")),
        ((6, 1, 0), (20, 0, 0), 1, ('"r2"', "overlaps", "obstacles[0]", "at least 1 m")),
        ((6, 1, 0), (17.1, 0, 0), 1, ('"r2"', "touches", "obstacles[0]")),
    ],
)
def test_robots_are_apart_from_all(world, first, second, where, parts):
    block = [[18, -1], [22, -1], [22, 1], [18, 1]]
    beside = world.changed(obstacles=[block], reference_path=[[0, 2], [30, 2]])
    faults = found(standing(beside, first, second))
    assert places(faults) == [("robots", where, "pose")]
    assert re.search(facts(*parts), faults[0].message)


def test_a_gap_above_the_tolerance_is_a_gap(world):
    assert found(standing(world, (6, 1, 0), (7.8 + 2e-9, 1, 0))) == []


def test_a_wall_inside_the_area_is_named(world):
    inner = [[10.0, 0.0], [12.0, 0.0]]
    drawn = world.changed(corridor=None, boundaries=[EDGE, inner], reference_path=[[0, 1], [30, 1]])
    faults = found(standing(drawn, (11, 0, 0.3), (3, 0, 0)))
    assert places(faults) == [("robots", 0, "pose")]
    assert "boundaries[1]" in faults[0].message




def test_paths_need_two_points(world):
    """Beside a bend as tight as the offset, all waypoints are one."""
    bend = world.changed(reference_path=[[10, 0], [11, 0], [11, 1]], formation=None)
    beside = {**dict(world.robots[1]), "path": {"offset": 1.0}}
    faults = found(bend.changed(robots=(world.robots[0], beside)))
    assert places(faults) == [("robots", 1, "path")]




def test_a_step_that_would_tunnel_is_refused_and_the_largest_told(world):
    radius = math.hypot(0.9, 0.5)
    largest = 0.25 * 1.0 / (1.5 + radius * 1.6)
    just = world.changed(time={"step": largest * 0.999, "duration": largest * 9.99})
    assert found(just) == []
    over = world.changed(time={"step": largest * 1.001, "duration": largest * 10.01})
    faults = found(over)
    assert places(faults) == [("time", "step")]
    assert "1 more" in faults[0].message
    (named,) = re.findall(r"at most ([\d.e-]+) s\b", faults[0].message)
    assert float(named) <= largest
    assert float(named) == pytest.approx(largest, rel=0.01)
    assert re.search(facts("0.25 m"), faults[0].message)






def test_one_robot_too_fast_for_a_usual_step_is_told_at_its_limits(world):
    fast = {**dict(world.robots[1]), "limits": {"v": 100.0}}
    faults = found(world.changed(robots=(world.robots[0], fast)))
    assert places(faults) == [("robots", 1, "limits")]




def test_the_narrowest_part_of_any_robot_decides(world):
    thin = [[0, 0], [2, 0], [2, 0.05], [0.05, 0.05], [0.05, 2], [0, 2]]
    robots = (world.robots[0], world.robots[1].model_copy(update={"footprint": thin}))
    faults = found(world.changed(robots=(robots[0], {**dict(robots[1]), "footprint": thin})))
    assert places(faults)[0] == ("time", "step")
    assert 'that of "r2"' in faults[0].message
