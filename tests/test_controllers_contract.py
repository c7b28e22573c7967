"""What every registered controller keeps to, on every shipped world.

The rules of `check_controller`; observations of what is within range and nothing else; and no
decision, of all robots at once, by anything that a robot may not know.
"""

from __future__ import annotations

import copy
import os
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely

from physim import ControllerError, Decisions, Scene, Simulation, build_scene, per_robot
from physim.geometry import Shapes
from physim.testing import Rule, check_controller
from physim.world import World
from physim.world.file import load_world, parse_world
from tests.helpers import inside
from tests.testing import broken

CONTROLLER, make_part = inside("physim.parts", "CONTROLLER", "make_part")
part_names = inside("physim.parts", "part_names")
find_world, shipped_worlds = inside("physim.world.file", "find_world", "shipped_worlds")

WORLDS = tuple(shipped_worlds())
CONTROLLERS = tuple(part_names(CONTROLLER))
SECONDS = 3.0 if os.environ.get("PHYSIM_DEEP") else 1.0
MANY = 100
"""Robots from above which one step is tried and a few robots looked at"""
LARGE = tuple(name for name in WORLDS if load_world(find_world(name)).robot_count > MANY)

FAST = ("three_robots", "doorway", "nonconvex")
"""Worlds of the fast tier; the others are deep"""


def tiered(*values: Any, fast: bool) -> Any:
    """Parameters of a test, deep or not."""
    return pytest.param(*values, marks=() if fast else pytest.mark.deep)


every_world = pytest.mark.parametrize(
    "world_name", [tiered(name, fast=name in FAST) for name in WORLDS]
)


def shipped(name: str, *overrides: str) -> World:
    text = find_world(name).read_text(encoding="utf-8")
    return parse_world(text, name, overrides=overrides)


def run(simulation: Simulation, seconds: float = SECONDS) -> Iterator[Decisions]:
    """Step through a simulation; the decisions of every step that has some."""
    for _ in range(round(seconds / simulation.scene.dt)):
        simulation.step()
        if simulation.last is not None and simulation.last.decisions is not None:
            yield simulation.last.decisions


@pytest.mark.parametrize(
    ("name", "worlds"),
    [tiered(name, one, fast=bool(one)) for name in CONTROLLERS for one in (FAST, ())],
)
def test_registered_controllers_keep_to_the_rules(name: str, worlds: tuple[str, ...]) -> None:
    """In every situation; in the deep tier in every shipped world, and in the middle of a plan."""
    assert check_controller(name, worlds=worlds or None, seconds=2.0 if not worlds else 0.5) == []
    if name == "mode_switching" and not worlds:
        settings = {"dwell_times": [0.04, 0.03, 0.03], "omegas": [-1.0, 0.0, 1.0]}
        assert check_controller(name, settings=settings, worlds=["three_robots"]) == []


def same(a: Decisions, b: Decisions) -> bool:
    """Equal to the last bit, NaN equal to NaN."""
    return all(
        x.dtype == y.dtype and np.array_equal(x, y, equal_nan=x.dtype.kind == "f")
        for x, y in zip(a, b, strict=True)
    )


# What a controller sees


@every_world
def test_an_observation_holds_what_is_in_range_and_nothing_else(world_name: str) -> None:
    simulation = Simulation(build_scene(shipped(world_name, "sensing.stages=[]")))
    scene = simulation.scene
    walls = wall_geometry(scene.walls)
    plan = scene.formation
    hidden = 0
    for _ in run(simulation, scene.dt if world_name in LARGE else 1.0):
        for i in looked_at(scene):
            seen = simulation.observe(i)
            place = simulation.now.moving_pose
            gap = np.hypot(*(place[:, :2] - place[i, :2]).T)
            near = [j for j in range(scene.moving) if j != i and gap[j] <= scene.sensing_range]
            assert [other.index for other in seen.others] == near
            for other in seen.others:
                assert np.array_equal(other.pose, place[other.index])
                held = (other.v, other.omega, other.lateral)[: scene.columns]
                told = other.index < scene.robots
                assert held == (
                    tuple(simulation.command[other.index]) if told else (0.0,) * len(held)
                )
                assert other.time == seen.time == simulation.time
            here = shapely.Point(simulation.pose[i, :2])
            distance = shapely.distance(walls, here)
            clear = np.abs(distance - scene.sensing_range) > 1e-9
            parts = [p for p in range(len(walls)) if distance[p] <= scene.sensing_range]
            if clear.all():
                assert len(seen.walls) == len(parts)
                for wall, p in zip(seen.walls, parts, strict=True):
                    assert wall.index == p
                    assert np.array_equal(wall.points, part_of(scene.walls, p))
            hidden += len(walls) - len(parts) + scene.moving - 1 - len(near)
            stations = simulation.now.reference_station
            mates = {n.index for n in seen.neighbours}
            assert mates == (neighbours(scene, stations, i) if plan.active else set())
            assert all(n.station == stations[n.index] for n in seen.neighbours)
            assert seen.dt == scene.dt
            walls_seen = (wall.points for wall in seen.walls)
            for array in (seen.pose, *seen.footprint, *walls_seen, *(o.pose for o in seen.others)):
                assert not array.flags.writeable
    assert hidden > 0


def looked_at(scene: Scene) -> range:
    """Robots that a slow test looks at: all, or of a large world every hundredth."""
    return range(0, scene.robots, 1 if scene.robots <= MANY else 100)


def neighbours(scene: Scene, stations: np.ndarray, i: int) -> set[int]:
    """N_i in plain words: those listed, or those within range along the reference path."""
    others = set(range(scene.robots)) - {i}
    if len(scene.formation.adjacency):
        return {j for j in others if scene.formation.adjacency[i, j]}
    return {j for j in others if abs(stations[j] - stations[i]) <= scene.formation.range}


def part_of(shapes: Shapes, p: int) -> np.ndarray:
    return shapes.vertices[shapes.part_start[p] : shapes.part_start[p + 1]]


def wall_geometry(walls: Shapes) -> np.ndarray:
    parts = [part_of(walls, p) for p in range(len(walls.part_start) - 1)]
    return np.array(
        [shapely.LineString(part) if len(part) == 2 else shapely.Polygon(part) for part in parts]
    )


# All at once

OVERRIDES = {
    "short sight": ("sensing.range=3.0",),
    "listed neighbours": ("formation.neighbours=[[{0}, {1}]]", "sensing.range=5.0"),
    "plans of two": ("controller.dwell_times=[0.04, 0.06]", "controller.time_low=4.0",
                     "controller.time_high=6.0", "controller.horizon=10.0"),
}  # fmt: skip
"""Worlds in which neighbours are beyond the range, or plans last"""
CROWD = """\
name: crowd
seed: 1
time: {step: 0.025, duration: 5.0}
corridor: {centreline: [[0, 0], [60, 0]], width: 12.0}
start: {region: [[1, -5], [20, -5], [20, 5], [1, 5]], heading: along, abreast: 6}
robots:
  - count: 32
    footprint: {length: 0.5, width: 0.3}
    paths: [{offset: -3.0}, {offset: -1.0}, {offset: 1.0}, {offset: 3.0}]
    limits: {v: 1.5, omega: 1.6}
formation: {gain: 0.02, speed: 0.8, spacing: initial, range: 12.0}
sensing: {range: 7.0}
controller: {type: mode_switching, look_ahead: 1.0, safe_distance: 0.3, avoidance: time_first,
  time_low: 2.0, time_high: 3.0, distance_low: 0.3, distance_high: 0.5, boundary_low: 0.05}
"""


def sighted() -> list[World]:
    """Worlds in which much lies out of sight."""
    names = ("r1", "r3")
    worlds = [
        shipped("three_robots", *(text.format(*names) for text in own))
        for own in OVERRIDES.values()
    ]
    return [*worlds, parse_world(CROWD)]


@pytest.mark.parametrize("name", CONTROLLERS)
def test_nobody_goes_by_what_it_may_not_know(name: str) -> None:
    """By rows of its own, and robot by robot, each decides as from the common table."""
    assert check_controller(name, worlds=sighted(), seconds=0.5) == []


def test_who_looks_farther_than_it_may_is_found() -> None:
    found = check_controller(broken.FarSighted, worlds=sighted(), seconds=0.5)
    assert {one.rule for one in found} == {Rule.SIGHT}
    assert {"three robots", "crowd"} <= {one.world for one in found}
    for peeks in (broken.all_behind_the_first, broken.mind_every_wall):
        found = check_controller(broken.Together(peeks), worlds=sighted(), seconds=0.2)
        assert {one.rule for one in found} == {Rule.SIGHT}


def test_robot_by_robot_the_papers_decides_as_for_all_at_once() -> None:
    """A long run, to the bit, and from observations that a controller of one's own hands on."""
    scene = build_scene(load_world(find_world("ten_robots")))
    settings = scene.world.controller.settings
    inner = make_part(CONTROLLER, "mode_switching", settings)
    whole, alone = Simulation(scene), Simulation(scene, controller=per_robot(inner))
    for a, b in zip(run(whole, 8.0), run(alone, 8.0), strict=True):
        assert same(a, b), (whole.time, a, b)
    assert np.array_equal(whole.pose, alone.pose)
    seen = alone.observe(0)
    for made in (replace(seen, v=0.0), copy.deepcopy(seen)):
        with pytest.raises(ControllerError, match="by hand"):
            per_robot(inner).decide(made, None)
