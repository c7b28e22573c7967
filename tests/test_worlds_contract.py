"""What every shipped world keeps to: found by `shipped_worlds`, so a new file is tested at once."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest
import shapely

from physim import Scene, World, build_scene, simulate
from physim.analysis.metrics import Figures
from physim.analysis.summary import summarise
from physim.analysis.validation import validate
from physim.world.file import load_world, parse_world
from tests.helpers import inside
from tests.helpers.same import differences

signed_area = inside("physim.geometry", "signed_area")
find_world, shipped_worlds = inside("physim.world.file", "find_world", "shipped_worlds")

MANY = 10
"""Robots up to which the fast tier makes the whole run"""
shipped = functools.cache(load_world)
scene_of = functools.cache(lambda name: build_scene(shipped(name)))
NAMES = tuple(shipped_worlds())
every_world = pytest.mark.parametrize("name", NAMES)
LARGE = {name for name in NAMES if shipped(name).robot_count > MANY}


@every_world
def test_file_explains_itself(name: str) -> None:
    path = find_world(name)
    text = path.read_text(encoding="utf-8")
    world = shipped(name)
    assert world.description == shipped_worlds()[name]
    assert world.description.strip()
    assert world.name.replace(" ", "_") == name == path.stem
    assert world.expect is not None
    assert world.expect.finished is not None
    bounds = (world.expect.min_distance, world.expect.min_boundary_distance)
    assert world.expect.contacts == 0 or None not in bounds, "touching is bounded or ruled out"
    comments = [line.partition("#")[2] for line in text.splitlines()]
    posed = any(world.start_of(entry) is None for entry in world.robots)
    for unit in ("[m]", "[s]", *(["[m, m, rad]"] if posed else [])):
        assert any(unit in comment for comment in comments), unit


@every_world
def test_file_and_saved_world_mean_the_same_scene(name: str) -> None:
    world = shipped(name)
    again = parse_world(world.to_yaml())
    assert again == world
    assert again.to_yaml() == world.to_yaml()
    assert differences(scene_of(name), build_scene(again)) == []


@every_world
def test_scene_of_another_seed_differs_where_something_is_random_and_there_alone(name: str) -> None:
    world = shipped(name)
    poses = [robot.pose for robot in scene_of(name).layout.robots]
    free = [i for i, pose in enumerate(poses) if pose is None or pose[2] == "random"]
    fixed = [i for i, pose in enumerate(poses) if pose is not None]
    a, b = scene_of(name), build_scene(world, world.seed + 1)
    assert np.flatnonzero((a.start != b.start).any(axis=1)).tolist() == free
    assert np.array_equal(a.start[fixed, :2], b.start[fixed, :2])


@every_world
def test_scene_is_sound(name: str) -> None:
    scene = scene_of(name)
    n = scene.robots
    assert [body.id for body in scene.bodies] == list(range(len(scene.bodies)))
    kinds = [body.kind for body in scene.bodies]
    assert kinds == sorted(kinds, key=("robot", "mover", "boundary", "obstacle").index)
    assert kinds.count("robot") == n == scene.world.robot_count
    assert scene.names == tuple(robot.name for robot in scene.layout.robots)
    assert len(scene.bodies) - scene.moving == len(scene.walls.body_start) - 1
    assert scene.steps * scene.dt == pytest.approx(scene.world.time.duration, rel=1e-9)
    assert scene.formation.lead.shape == (n,)
    assert scene.formation.lead[0] == 0.0
    assert (scene.mass > 0.0).all()
    assert (scene.stop_station > 0.0).all()
    _check_arrays(scene)
    area = scene.area.polygon
    parts = scene.shapes
    for i, (x, y, heading) in enumerate(scene.moving_start):
        turn = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
        for p in range(parts.body_start[i], parts.body_start[i + 1]):
            corners = parts.vertices[parts.part_start[p] : parts.part_start[p + 1]]
            assert signed_area(corners) > 0.0
            assert area.contains(shapely.Polygon(corners @ turn + (x, y)))


def _check_arrays(scene: Scene) -> None:
    n = scene.robots
    assert scene.start.shape == (n, 3)
    assert scene.limits.shape == (n, scene.columns)
    for value in (
        scene.start,
        scene.limits,
        scene.mass[:n],
        scene.stop_station,
        scene.walls.vertices,
    ):
        assert value.dtype == np.float64
        assert np.isfinite(value).all()
    assert len(scene.paths.start) == n + 1
    assert len(scene.reference.start) == 2
    assert len(scene.outside) == len(scene.speeds) == len(scene.omegas) == n


def first_seconds(world: World, most: float = 5.0) -> World:
    """The same world for a short time, shorter where many robots make it long."""
    step, seconds = world.time.step, min(most, 500.0 / world.robot_count)
    return world.changed(time={"step": step, "duration": round(seconds / step) * step})


@pytest.mark.parametrize("name", sorted(LARGE))
def test_the_first_seconds_of_a_large_world_repeat_bit_for_bit(name: str) -> None:
    world = first_seconds(shipped(name), 1.0)
    with simulate(world) as record, simulate(world) as again:
        assert record.digest() == again.digest()
        _check_run(record, world)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.deep) if n in LARGE else n for n in NAMES]
)
def test_a_run_repeats_and_holds_every_expectation(name: str) -> None:
    """The whole run, as the world's author promises: who arrives, and what touches how deeply."""
    world, short = shipped(name), first_seconds(shipped(name))
    assert world.expect is not None
    with simulate(world) as record, simulate(short) as again:
        k = len(again.pose)
        assert again.pose.tobytes() == record.pose[:k].tobytes()
        assert again.clearance.tobytes() == record.clearance[:k].tobytes()
        _check_run(record, world)
        assert [one for one in summarise(record).expectations if not one.held] == []
        assert (
            Figures(record).value("finished")
            == (record.ended == "finished")
            == world.expect.finished
        )
        if world.expect.finished:
            robots, last = np.unique(record.updates["robot"][::-1], return_index=True)
            modes = np.unique(record.updates["mode"][::-1][last])
            assert {record.modes[mode].name for mode in modes} == {"arrived"}
            assert len(robots) == record.robots
        if world.expect.contacts == 0 and record.robots <= 100:
            judged = validate(record)
            assert (judged.verdict, judged.comparison.disagreements) == ("contact-free", ())
        elif world.expect.contacts != 0:  # pressed against walls, and never beyond one
            area = scene_of(name).area.polygon
            assert len(record.contacts)
            assert shapely.contains_xy(area, *np.moveaxis(record.pose[::100, :, :2], 2, 0)).all()
            assert shapely.contains_xy(area, *record.pose[-1, :, :2].T).all()


def _check_run(record: Any, world: World) -> None:
    steps = len(record.pose)
    assert record.pose.shape == (steps, world.robot_count, 3)
    assert np.isfinite(record.pose).all()
    assert np.isfinite(record.boundary_clearance).all()
    assert not np.isnan(record.clearance).any()
    assert np.abs(np.diff(record.pose, axis=0)).max() > 0.0
    assert record.steps.tolist() == list(range(steps))
    assert record.world == world
