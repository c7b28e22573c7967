"""Many cases of one time step in one space, far apart: arrays for engine and kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.crashtest.case import Case
from physim.geometry.shapes import FloatArray, IntArray, Shapes, pack_shapes
from physim.scene import DENSITY

SPACING = 60.0
"""[m] between the places of two cases: twice what any of them can reach"""


class Batch(NamedTuple):
    """M cases of one time step with N robots in all."""

    dt: float
    """[s]"""
    cases: tuple[Case, ...]
    shapes: Shapes
    """of the N robots"""
    walls: Shapes
    """of all cases, world frame"""
    start: FloatArray
    """(N, 3)"""
    command: FloatArray
    """(N, 2)"""
    mass: FloatArray
    """(N,) [kg]"""
    first_robot: IntArray
    """(M + 1,) case k has the robots from first_robot[k] to first_robot[k + 1] - 1"""
    first_wall: IntArray
    """(M + 1,) likewise of the bodies of ``walls``"""


def place_of(index: int) -> tuple[float, float]:
    """Middle of the place of a case [m]: a spiral of squares about the origin."""
    ring = int((np.sqrt(index) + 1.0) / 2.0)
    along = index - (2 * ring - 1) ** 2 if ring else 0
    side, offset = divmod(along, 2 * ring) if ring else (0, 0)
    far, near = ring, offset - ring
    x, y = ((far, near), (-near, far), (-far, -near), (near, -far))[side]
    return SPACING * x, SPACING * y


def pack(dt: float, cases: tuple[Case, ...]) -> Batch:
    """Pack cases of one time step."""
    robots = [robot for case in cases for robot in case.layout.robots]
    return Batch(
        dt,
        cases,
        pack_shapes([robot.parts for robot in robots]),
        pack_shapes([parts for case in cases for parts in case.walls]),
        np.concatenate([case.layout.start for case in cases]),
        np.concatenate([case.layout.command for case in cases]),
        np.array([DENSITY * robot.area for robot in robots]),
        _firsts([len(case.layout.robots) for case in cases]),
        _firsts([len(case.walls) for case in cases]),
    )


def _firsts(lengths: list[int]) -> IntArray:
    return np.concatenate(([0], np.cumsum(lengths))).astype(np.int64)
