"""Grazes of a run as rows: bodies that touch between two samples only, step by step."""

from __future__ import annotations

import copy
import math
from itertools import pairwise

import numpy as np
import pytest

from physim import Scene, Simulation, Step, build_scene, simulate
from physim.contacts import Kind, Phase
from physim.world.file import parse_world
from tests.helpers import inside, road

FloatArray, locked = inside("physim.geometry", "FloatArray", "locked")
ROOM, SweptContactFinder = inside("physim.simulation", "ROOM", "SweptContactFinder")

DEPTH = 4e-4
SPEED = 1.4


@pytest.fixture(scope="module")
def scene() -> Scene:
    """The second robot, on its corner, passes the front left corner of the first, a hair inside."""
    turn = 0.25 * math.pi - math.atan2(0.5, 0.9)
    out = math.hypot(0.9, 0.5) - DEPTH
    x, y = 20.9 + out * math.sqrt(0.5), 0.5 + out * math.sqrt(0.5)
    back = 0.5 + 0.5 * SPEED * 0.01  # so that it is nearest in the middle of a step
    poses = [[20.0, 0.0, 0.0], [x - back * math.sqrt(0.5), y + back * math.sqrt(0.5), turn]]
    return build_scene(road(poses, duration=1.0))


@pytest.fixture(scope="module")
def course(scene: Scene) -> FloatArray:
    """Poses (B, 2, 3): the second robot goes down to the right, without turning."""
    poses = np.repeat(scene.start[None], 101, axis=0)
    way = SPEED * 0.01 * np.arange(101)
    poses[:, 1, :2] += way[:, None] * np.array([math.sqrt(0.5), -math.sqrt(0.5)])
    return poses


def rows(scene: Scene, course: FloatArray) -> np.ndarray:
    """Rows of all steps of a course."""
    finder, steps = SweptContactFinder(scene), pairwise(locked(course))
    return np.concatenate([finder.follow(k, *pair)[1] for k, pair in enumerate(steps, 1)])


def test_a_graze_is_told_at_the_sample_after_it(scene: Scene, course: FloatArray) -> None:
    """The engine sees none of it, and a step looked at alone tells the same."""
    (row,) = whole = rows(scene, course)
    gap = np.hypot(*(course[:, 1, :2] - course[:, 0, :2] - [0.9, 0.5]).T)
    nearest = int(np.argmin(gap[:-1] + gap[1:])) + 1
    assert (row["step"], row["a"], row["b"]) == (nearest, 0, 1)
    assert (row["kind"], row["phase"], row["impulse"]) == (Kind.SWEPT, Phase.BEGAN, 0.0)
    assert 0.0 < row["depth"] < DEPTH
    assert (row["x"], row["y"]) == pytest.approx((20.9, 0.5), abs=2e-3)
    assert row["nx"] + row["ny"] > 0.0  # from the first to the second
    alone = SweptContactFinder(scene).follow(nearest, course[nearest - 1], course[nearest])[1]
    assert alone.tobytes() == whole.tobytes()
    assert len(Simulation(scene).contacts) == 0


def test_more_grazes_in_a_step_than_there_is_room_for_at_first(
    scene: Scene, course: FloatArray
) -> None:
    """As many pairs, five metres apart, each as the first."""
    pairs = ROOM + 1
    apart = [[5.0 * (k % 30), 8.0 * (k // 30 - 1), 0.0] for k in range(pairs)]
    many = (course[:, None] + np.array(apart)[:, None]).reshape(len(course), 2 * pairs, 3)
    found = rows(build_scene(road(many[0].tolist(), duration=1.0)), many)
    (alone,) = rows(scene, course)
    assert found["step"].tolist() == [alone["step"]] * pairs
    assert found["a"].tolist() == list(range(0, 2 * pairs, 2))


SPINNING = """
name: spinning
time: {step: 0.01, duration: 8.0}
boundaries: [[[-5, -5], [5, -5], [5, WALL], [-5, WALL], [-5, -5]]]
robots:
  - {name: a, footprint: {length: 1.8, width: 1.0}, pose: [0, 0, 0], path: [[-3, 0], [3, 0]]}
reference_path: [[-3, 0], [3, 0]]
controller: {type: constant, commands: [[0.0, 0.8]]}
"""
"""A robot that turns on the spot; its corners go a micrometre into a wall, between samples."""


class Looks:
    """Keeps every contact that an observer is told of, or finds in the simulation."""

    def start(self, simulation: Simulation) -> None:
        self.simulation, self.told, self.found = simulation, [], []
        self.copied: list[np.ndarray] = []

    def after_step(self, step: Step) -> None:
        self.told.append(step.contacts)
        self.found.append(self.simulation.contacts)
        self.copied.append(copy.deepcopy(self.simulation).contacts if len(step.contacts) else [])

    def close(self, ended: str) -> None:
        pass


def test_an_observer_is_told_of_grazes_as_the_record_has_them() -> None:
    wall = math.hypot(0.9, 0.5) - 1e-6
    looks = Looks()
    with simulate(parse_world(SPINNING.replace("WALL", repr(wall))), observers=[looks]) as record:
        contacts = record.contacts
    assert (contacts["kind"] == Kind.SWEPT).any()
    for seen in (looks.told, looks.found, [one for one in looks.copied if len(one)]):
        assert np.concatenate(seen).tobytes() == contacts.tobytes()
