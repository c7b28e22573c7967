"""Grazes of a run as rows: bodies that touch between two samples only, block by block."""

from __future__ import annotations

import math

import numpy as np
import pytest

from physim.contacts import Kind, Phase
from physim.geometry.clearance import clearances
from physim.geometry.shapes import FloatArray
from physim.parts.controller import Decision
from physim.simulation.loop import Simulation
from physim.simulation.swept_contacts import ROOM, SweptContactFinder
from physim.world.layout.scene_builder import build_scene
from physim.world.scene import Scene
from tests.roads import road
from tests.says import Says

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


def rows(scene: Scene, course: FloatArray, cuts: list[int]) -> np.ndarray:
    """Rows of a course that is looked at in blocks."""
    finder, found = SweptContactFinder(scene), []
    for first, last in zip([0, *cuts], [*cuts, len(course)], strict=True):
        block = np.ascontiguousarray(course[first:last])
        near = clearances(block, scene.shapes, scene.walls, scene.wall_grid)
        found.append(finder.rows(first, block, near))
    return np.concatenate(found)


def test_a_graze_is_told_at_the_sample_after_it(scene: Scene, course: FloatArray) -> None:
    (row,) = rows(scene, course, [])
    gap = np.hypot(*(course[:, 1, :2] - course[:, 0, :2] - [0.9, 0.5]).T)
    nearest = int(np.argmin(gap[:-1] + gap[1:])) + 1
    assert (row["step"], row["a"], row["b"]) == (nearest, 0, 1)
    assert (row["kind"], row["phase"], row["impulse"]) == (Kind.SWEPT, Phase.BEGAN, 0.0)
    assert 0.0 < row["depth"] < DEPTH
    assert (row["x"], row["y"]) == pytest.approx((20.9, 0.5), abs=2e-3)
    assert row["nx"] + row["ny"] > 0.0  # from the first to the second


def test_blocks_of_any_size_find_the_same_grazes(scene: Scene, course: FloatArray) -> None:
    whole = rows(scene, course, [])
    step = int(whole["step"][0])
    for cuts in ([step], [step - 1], [step - 1, step], [step, step + 1], list(range(1, 101))):
        assert rows(scene, course, cuts).tobytes() == whole.tobytes()


def test_more_grazes_in_a_block_than_there_is_room_for_at_first(
    scene: Scene, course: FloatArray
) -> None:
    """To and fro past the corner."""
    step = int(rows(scene, course, [])["step"][0])
    to_and_fro = course[[step - 1, step] * ROOM]
    assert rows(scene, to_and_fro, [])["step"].tolist() == list(range(1, 2 * ROOM))


def test_the_engine_sees_none_of_it(scene: Scene) -> None:
    """So that it is the search that finds it."""
    simulation = Simulation(scene, controller=Says(lambda o: Decision(0.0, 0.0, hold=1.0)))
    assert len(simulation.contacts) == 0
