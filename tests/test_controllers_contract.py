"""What every registered controller keeps to, on every shipped world.

The rules of `check_controller`; sight no further than the range; and a batch form that decides
exactly as the plain one, which sees no more than that, under all settings and in a crowd.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import shapely

from physim import (
    Controller,
    Decision,
    Decisions,
    Observation,
    Scene,
    Sensed,
    Simulation,
    build_scene,
)
from physim.geometry import Shapes
from physim.testing import check_controller
from physim.world import World, each_robot
from physim.world.file import load_world, parse_world
from tests.helpers import inside

pack_parts, read_only = inside("physim.geometry", "pack_parts", "read_only")
BatchCapable, Declared = inside("physim.parts", "BatchCapable", "Declared")
CONTROLLER, part_names = inside("physim.parts", "CONTROLLER", "part_names")
make_part, everybody, shared = inside("physim.parts", "make_part", "everybody", "shared")
PerRobotAdapter = inside("physim.simulation", "PerRobotAdapter")
find_world, shipped_worlds = inside("physim.world.file", "find_world", "shipped_worlds")

WORLDS = tuple(shipped_worlds())
CONTROLLERS = tuple(part_names(CONTROLLER))
SECONDS = 3.0 if os.environ.get("PHYSIM_DEEP") else 1.0
MANY = 100
"""Robots from above which one step is tried, as shipped, and a few robots looked at: the plain form
of a thousand takes half a second a step, and all of them see the like"""
LARGE = tuple(name for name in WORLDS if load_world(find_world(name)).robot_count > MANY)

FAST = ("three_robots", "doorway", "nonconvex")
"""Worlds of the fast tier; the others are deep"""


def tiered(*values: Any, fast: bool) -> Any:
    """Parameters of a test, deep or not."""
    return pytest.param(*values, marks=() if fast else pytest.mark.deep)


every_world = pytest.mark.parametrize(
    "world_name", [tiered(name, fast=name in FAST) for name in WORLDS]
)


class Plain:
    """The plain form of a controller: `batch` is out of sight."""

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        declared = Declared.of(controller)
        self.modes, self.rules = declared.modes, declared.rules
        self.columns = declared.columns

    def decide(self, observation: Observation, memory: Any) -> Decision:
        return self.controller.decide(observation, memory)


def shipped(name: str, *overrides: str) -> World:
    text = find_world(name).read_text(encoding="utf-8")
    return parse_world(text, name, overrides=overrides)


def run(simulation: Simulation, seconds: float = SECONDS) -> Iterator[Decisions]:
    """Step through a simulation; the decisions of every step that has some."""
    for _ in range(round(seconds / simulation.scene.dt)):
        simulation.step()
        if simulation.last is not None and simulation.last.decisions is not None:
            yield simulation.last.decisions


def made(name: str, world: World) -> Controller:
    settings = world.controller.settings if world.controller.type == name else {}
    controller: Controller = make_part(CONTROLLER, name, settings)
    return controller


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
    simulation = Simulation(build_scene(load_world(find_world(world_name))))
    scene = simulation.scene
    walls = wall_geometry(scene.walls)
    plan = scene.formation
    hidden = 0
    for _ in run(simulation, scene.dt if world_name in LARGE else 1.0):
        for i in looked_at(scene):
            seen = simulation.observe(i)
            gap = np.hypot(*(simulation.pose[:, :2] - simulation.pose[i, :2]).T)
            near = [j for j in range(scene.robots) if j != i and gap[j] <= scene.sensing_range]
            assert [other.index for other in seen.others] == near
            for other in seen.others:
                assert np.array_equal(other.pose, simulation.pose[other.index])
                assert (other.v, other.omega) == tuple(simulation.command[other.index])
                assert other.time == seen.time == simulation.time
            here = shapely.Point(simulation.pose[i, :2])
            distance = shapely.distance(walls, here)
            clear = np.abs(distance - scene.sensing_range) > 1e-9
            parts = [p for p in range(len(walls)) if distance[p] <= scene.sensing_range]
            if clear.all():
                assert len(seen.walls) == len(parts)
                for corners, p in zip(seen.walls, parts, strict=True):
                    assert np.array_equal(corners, part_of(scene.walls, p))
            hidden += len(walls) - len(parts) + scene.robots - 1 - len(near)
            stations = simulation.now.reference_station
            mates = {n.index for n in seen.neighbours}
            assert mates == (neighbours(scene, stations, i) if plan.active else set())
            assert all(n.station == stations[n.index] for n in seen.neighbours)
            assert seen.dt == scene.dt
            for array in (seen.pose, *seen.footprint, *seen.walls, *(o.pose for o in seen.others)):
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


def later(scene: Scene, seconds: float = 12.0) -> Simulation:
    simulation = Simulation(scene)
    for _ in range(round(seconds / scene.dt)):
        simulation.step()
    return simulation


# The batch form and the plain one

VARIANTS = {
    "as shipped": (),
    "two dwell times": ("controller.dwell_times=[0.05, 0.05]",),
    "three dwell times, not ahead": (
        "controller.dwell_times=[0.02, 0.03, 0.05]", "controller.omegas=[-1.0, 0.0, 1.0]",
        "controller.speeds=[0.0, 1.0]", "controller.judge_ahead=0.0",
    ),
    "reverse in safe mode": ("controller.reverse_in_safe_mode=true",),
    "forward only": ("controller.reverse_in_safe_mode=false",),
    "two dwell times, reverse": (
        "controller.reverse_in_safe_mode=true", "controller.dwell_times=[0.04, 0.06]",
    ),
    "translation": ("controller.collision_motion=translation",),
    "easily alarmed": (
        "controller.horizon=10.0",
        "controller.distance_low=3.0", "controller.distance_high=4.0",
        "controller.time_low=4.0", "controller.time_high=6.0", "controller.beta=0.05",
        "controller.safe_distance=2.0",
    ),
    "own speeds and omegas": (
        "robots.0.speeds=[-0.5, 0.0, 0.5, 1.0]", "robots.0.omegas=[-0.3, 0.0, 0.3]",
    ),
    "slow robot": ("robots.0.limits.v=0.9",),
    "large steps": ("time.step=0.025", "time.duration=8.0"),
}  # fmt: skip
OF_THE_FORMATION = {
    "all are neighbours": ("formation.neighbours=all",),
    "short range": ("formation.range=4.0",),
    "short sight": ("sensing.range=3.0",),
    "long sight": ("sensing.range=25.0",),
    "listed neighbours": ("formation.neighbours=[[{0}, {1}]]",),
    "wanted leads": ("formation.gain=0.3", "formation.limits=[0.0, 1.4]"),
}


def variants() -> Iterator[Any]:
    for world_name in WORLDS:
        with_formation = load_world(find_world(world_name)).formation is not None
        every = VARIANTS | (OF_THE_FORMATION if with_formation else {})
        for variant in ("as shipped",) if world_name in LARGE else every:
            of_all = world_name in FAST and variant == "as shipped"
            yield tiered(world_name, variant, fast=of_all or world_name == "three_robots")


@pytest.mark.parametrize(("world_name", "variant"), list(variants()))
def test_batch_decides_as_the_plain_form(world_name: str, variant: str) -> None:
    plain = load_world(find_world(world_name))
    names = [one.name for one in each_robot(plain.robots, plain.seed)[0][-2:]]
    overrides = [text.format(*names) for text in (VARIANTS | OF_THE_FORMATION)[variant]]
    seconds = 20.0 if (world_name, variant) == ("ten_robots", "as shipped") else SECONDS
    scene = build_scene(shipped(world_name, *overrides))
    check_alike(scene, scene.dt if world_name in LARGE else seconds)


def check_alike(scene: Scene, seconds: float) -> set[int]:
    """Run both forms side by side; every decision must be equal to the bit. The modes seen."""
    settings = scene.world.controller.settings
    batch = Simulation(scene, controller=make_part(CONTROLLER, "mode_switching", settings))
    plain = Simulation(scene, controller=Plain(make_part(CONTROLLER, "mode_switching", settings)))
    assert not isinstance(plain.parts.controller, BatchCapable)
    modes: set[int] = set()
    for a, b in zip(run(batch, seconds), run(plain, seconds), strict=True):
        assert same(a, b), (batch.time, a, b)
        assert np.array_equal(batch.pose, plain.pose)
        assert np.array_equal(batch.next_decision, plain.next_decision)
        modes |= set(a.mode.tolist())
    assert modes
    return modes


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
controller: {type: mode_switching, look_ahead: 1.0, safe_distance: 0.3, avoidance: time_first,
  time_low: 2.0, time_high: 3.0, distance_low: 0.3, distance_high: 0.5, boundary_low: 0.05}
"""


def each_with_rows_of_its_own(sensed: Sensed, rng: np.random.Generator) -> Sensed:
    """Everyone knows some of the others, in an order of its own and not quite where they are."""
    robots = len(sensed.first)
    rows = [
        rng.permutation([i, *(j for j in range(robots) if j != i and rng.random() < 0.9)])
        for i in range(robots)
    ]
    taken, ends = np.concatenate(rows), np.cumsum([len(one) for one in rows])
    return sensed._replace(
        robot=sensed.robot[taken],
        pose=sensed.pose[taken] + rng.normal(0.0, 0.1, (len(taken), 3)),
        command=sensed.command[taken],
        velocity=sensed.velocity[taken],
        reference_station=sensed.reference_station[taken] + rng.normal(0.0, 2.0, len(taken)),
        age=sensed.age[taken],
        first=ends - [len(one) for one in rows],
        end=ends,
    )


@pytest.mark.parametrize("own", [False, True], ids=["the same rows", "rows of their own"])
def test_batch_decides_as_the_plain_form_in_a_crowd(own: bool) -> None:
    """Whether all know the same of each other or not; each considers many."""
    scene = build_scene(parse_world(CROWD))
    simulation, rng = later(scene, 2.0), np.random.default_rng(6)
    controller = made("mode_switching", scene.world)
    assert isinstance(controller, BatchCapable)
    forms = controller.batch(scene), PerRobotAdapter(controller, scene, Declared.of(controller))
    memories = [form.memory() for form in forms]
    modes: set[int] = set()
    for _ in range(3):
        sensed = everybody(simulation.now, shared(scene.robots))
        if own:
            sensed = each_with_rows_of_its_own(sensed, rng)
        due = np.flatnonzero(rng.random(scene.robots) < 0.9)
        both = [f.decide_due(sensed, due, m) for f, m in zip(forms, memories, strict=True)]
        assert same(*both)
        assert len(both[0].considered) > 9 * len(due)
        modes |= set(both[0].mode.tolist())
        simulation.step()
    assert {0, 2} <= modes
