"""What every shipped world keeps to: found by `shipped_worlds`, so a new file is tested at once."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
import shapely

from physim import Scene, build_scene, simulate
from physim.analysis.metrics import finished
from physim.analysis.summary import summarise
from physim.analysis.validation import validate
from physim.world.file import load_world, parse_world
from tests.helpers import inside

signed_area = inside("physim.geometry", "signed_area")
find_world, shipped_worlds = inside("physim.world.file", "find_world", "shipped_worlds")

NAMES = tuple(shipped_worlds())
MANY = 100
"""Robots up to which a record is validated here: of a thousand that takes a minute"""
every_world = pytest.mark.parametrize("name", NAMES)


def short(name: str, robot_seconds: float = 500.0, most: float = 5.0) -> Any:
    """A shipped world cut down to its first seconds, fewer where many robots make them long."""
    world = load_world(find_world(name))
    step = world.time.step
    seconds = min(most, robot_seconds / len(world.robots))
    time = type(world.time)(step=step, duration=round(seconds / step) * step)
    return world.changed(time=time)


def differences(a: Any, b: Any, place: str = "scene") -> list[str]:
    """Places where two values, arrays within them included, are not equal to the last bit."""
    if type(a) is not type(b):
        return [place]
    if isinstance(a, np.ndarray):
        same = a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
        return [] if same else [place]
    if isinstance(a, dict) and a.keys() == b.keys():
        return [d for key in a for d in differences(a[key], b[key], f"{place}.{key}")]
    if isinstance(a, tuple | list) and len(a) == len(b):
        return [d for k in range(len(a)) for d in differences(a[k], b[k], f"{place}[{k}]")]
    if dataclasses.is_dataclass(a):
        return [
            d
            for field in dataclasses.fields(a)
            for d in differences(
                getattr(a, field.name), getattr(b, field.name), f"{place}.{field.name}"
            )
        ]
    return [] if a == b else [place]


@every_world
def test_file_explains_itself(name: str) -> None:
    path = find_world(name)
    text = path.read_text(encoding="utf-8")
    world = load_world(path)
    assert world.description == shipped_worlds()[name]
    assert world.description.strip()
    assert world.name.replace(" ", "_") == name == path.stem
    assert world.expect is not None
    assert world.expect.finished is not None
    bounds = (world.expect.min_distance, world.expect.min_boundary_distance)
    assert world.expect.contacts == 0 or None not in bounds, "touching is bounded or ruled out"
    comments = [line.partition("#")[2] for line in text.splitlines()]
    posed = any(robot.pose is not None for robot in world.robots)
    for unit in ("[m]", "[s]", *(["[m, m, rad]"] if posed else [])):
        assert any(unit in comment for comment in comments), unit


@every_world
def test_file_and_saved_world_mean_the_same_scene(name: str) -> None:
    world = load_world(find_world(name))
    again = parse_world(world.to_yaml())
    assert again == world
    assert again.to_yaml() == world.to_yaml()
    assert differences(build_scene(world), build_scene(again)) == []


@every_world
def test_scene_of_another_seed_differs_where_something_is_random_and_there_alone(name: str) -> None:
    world = load_world(find_world(name))
    poses = [robot.pose for robot in world.robots]
    free = [i for i, pose in enumerate(poses) if pose is None or pose[2] == "random"]
    fixed = [i for i, pose in enumerate(poses) if pose is not None]
    a, b = build_scene(world, 10), build_scene(world, 11)
    changed = np.flatnonzero((a.start != b.start).any(axis=1))
    assert changed.tolist() == free
    assert np.array_equal(a.start[fixed, :2], b.start[fixed, :2])


@every_world
def test_scene_is_sound(name: str) -> None:
    scene = build_scene(load_world(find_world(name)))
    n = scene.robots
    assert [body.id for body in scene.bodies] == list(range(len(scene.bodies)))
    kinds = [body.kind for body in scene.bodies]
    assert kinds == sorted(kinds, key=("robot", "boundary", "obstacle").index)
    assert kinds.count("robot") == n == len(scene.world.robots)
    assert scene.names == tuple(robot.name for robot in scene.world.robots)
    assert len(scene.bodies) - n == len(scene.walls.body_start) - 1
    assert scene.steps * scene.dt == pytest.approx(scene.world.time.duration, rel=1e-9)
    assert scene.formation.lead.shape == (n,)
    assert scene.formation.lead[0] == 0.0
    assert (scene.mass > 0.0).all()
    assert (scene.stop_station > 0.0).all()
    _check_arrays(scene)
    area = scene.area.polygon
    parts = scene.shapes
    for i, (x, y, heading) in enumerate(scene.start):
        turn = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
        for p in range(parts.body_start[i], parts.body_start[i + 1]):
            corners = parts.vertices[parts.part_start[p] : parts.part_start[p + 1]]
            assert signed_area(corners) > 0.0
            assert area.contains(shapely.Polygon(corners @ turn + (x, y)))


def _check_arrays(scene: Scene) -> None:
    n = scene.robots
    assert scene.start.shape == (n, 3)
    assert scene.limits.shape == (n, 2)
    for value in (scene.start, scene.limits, scene.mass, scene.stop_station, scene.walls.vertices):
        assert value.dtype == np.float64
        assert np.isfinite(value).all()
    assert len(scene.paths.start) == n + 1
    assert len(scene.reference.start) == 2
    assert len(scene.outside) == len(scene.speeds) == len(scene.omegas) == n


@every_world
def test_run_is_finite_and_repeats_bit_for_bit(name: str) -> None:
    world = short(name)
    first, second = simulate(world), simulate(world)
    assert first.digest() == second.digest()
    k = round(world.time.duration / first.dt) + 1
    assert first.pose.shape == (k, len(world.robots), 3)
    assert np.isfinite(first.pose).all()
    assert np.isfinite(first.boundary_clearance).all()
    assert not np.isnan(first.clearance).any()
    assert np.abs(np.diff(first.pose, axis=0)).max() > 0.0
    assert first.steps.tolist() == list(range(k))
    assert first.world == world


@every_world
def test_shipped_seed_holds_every_expectation(name: str) -> None:
    """The whole run, as the world's author promises: who arrives, and what touches how deeply."""
    world = load_world(find_world(name))
    assert world.expect is not None
    with simulate(world) as record:
        assert [one for one in summarise(record).expectations if not one.held] == []
        assert finished(record) == (record.ended == "finished") == world.expect.finished
        if world.expect.finished:
            robots, last = np.unique(record.updates["robot"][::-1], return_index=True)
            modes = np.unique(record.updates["mode"][::-1][last])
            assert {record.modes[mode].name for mode in modes} == {"arrived"}
            assert len(robots) == record.robots
        if world.expect.contacts == 0 and record.robots <= MANY:
            judged = validate(record)
            assert (judged.verdict, judged.comparison.disagreements) == ("contact-free", ())
        elif world.expect.contacts != 0:  # pressed against walls, and never beyond one
            area = build_scene(world).area.polygon
            assert len(record.contacts)
            assert shapely.contains_xy(area, *np.moveaxis(record.pose[::100, :, :2], 2, 0)).all()
            assert shapely.contains_xy(area, *record.pose[-1, :, :2].T).all()
