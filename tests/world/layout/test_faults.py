"""Faults of shapes and places, as the layout of a world finds them."""

from __future__ import annotations

import math
import re

import pytest

from physim.errors import Fault, WorldError
from physim.world import World
from physim.world.file import parse_world
from tests.helpers import STRAIGHT, facts, inside

lay_out = inside("physim.world.layout", "lay_out")


def found(world: World) -> list[Fault]:
    try:
        lay_out(world)
    except WorldError as error:
        return list(error.faults)
    return []


def standing(world: World, *poses: tuple[float, float, float]) -> World:
    """The world with its robots at these poses."""
    pairs = zip(world.robots, poses, strict=True)
    return world.changed(robots=[{**dict(robot), "pose": pose} for robot, pose in pairs])


def places(faults: list[Fault]) -> list[tuple]:
    return [fault.location for fault in faults]


@pytest.fixture
def world() -> World:
    return parse_world(STRAIGHT)


def test_a_gap_above_the_tolerance_is_a_gap(world):
    assert found(standing(world, (6, 1, 0), (7.8 + 2e-9, 1, 0))) == []


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


def test_the_narrowest_part_of_any_robot_decides(world):
    thin = [[0, 0], [2, 0], [2, 0.05], [0.05, 0.05], [0.05, 2], [0, 2]]
    robots = (world.robots[0], world.robots[1].model_copy(update={"footprint": thin}))
    faults = found(world.changed(robots=(robots[0], {**dict(robots[1]), "footprint": thin})))
    assert places(faults)[0] == ("time", "step")
    assert 'that of "r2"' in faults[0].message
