"""Grazes of a run as rows: bodies that touch between two samples only, step by step."""

from __future__ import annotations

import copy
import math

import numpy as np
import pytest

from physim import Simulation, Step, simulate
from physim.contacts import Kind, Phase
from physim.world import World
from physim.world.file import parse_world

DEPTH, SPEED = 4e-4, 1.4
BOX = {"length": 1.8, "width": 1.0}
DIAMOND = [[0.5, 0.0], [0.0, 0.5], [-0.5, 0.0], [0.0, -0.5]]


def grazing(pairs: int) -> World:
    """Of each pair one stands, and the corner of the other passes its front left corner, a hair
    inside, nearest in the middle of the eleventh step."""
    robots = []
    for k in range(pairs):
        x, y = 5.0 * (k % 30), 8.0 * (k // 30)
        out, back = (0.5 - DEPTH) * math.sqrt(0.5), 10.5 * SPEED * 0.01 * math.sqrt(0.5)
        pose = [x + 0.9 + out - back, y + 0.5 + out + back, -0.25 * math.pi]
        path = [[x - 2.0, y], [x + 2.5, y]]
        robots += [
            {"name": f"a{k}", "footprint": BOX, "pose": [x, y, 0.0], "path": path},
            {"name": f"b{k}", "footprint": DIAMOND, "pose": pose, "path": path,
             "limits": {"v": 2.0}},
        ]  # fmt: skip
    walls = [[[-9.0, -9.0], [160.0, -9.0], [160.0, 40.0], [-9.0, 40.0], [-9.0, -9.0]]]
    return World(
        name="grazing", time={"step": 0.01, "duration": 0.2}, boundaries=walls, robots=robots,
        reference_path=[[-5.0, 0.0], [150.0, 0.0]],
        controller={"type": "constant", "commands": [[0.0, 0.0], [SPEED, 0.0]] * pairs},
    )  # fmt: skip


@pytest.mark.parametrize("pairs", [1, 65])
def test_a_graze_is_told_at_the_sample_after_it(pairs: int) -> None:
    """The engine sees none of it; and 65 are more than the search has room for at first."""
    with simulate(grazing(pairs)) as record:
        rows = record.contacts
    assert rows["a"].tolist() == list(range(0, 2 * pairs, 2))
    assert rows["b"].tolist() == list(range(1, 2 * pairs, 2))
    assert set(rows["step"]) == {11}
    assert set(rows["kind"]) == {Kind.SWEPT}
    assert set(rows["phase"]) == {Phase.BEGAN}
    assert set(rows["impulse"]) == {0.0}
    assert ((rows["depth"] > 0.0) & (rows["depth"] < 1.01 * DEPTH)).all()
    assert (rows["x"][0], rows["y"][0]) == pytest.approx((0.9, 0.5), abs=2e-3)
    assert (rows["nx"] + rows["ny"] > 0.0).all()  # from the first to the second


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
