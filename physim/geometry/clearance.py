"""Clearances of many samples: nearest robot, nearest wall, farthest pair. For monitoring.

Values are exact: discs inside and around the shapes only leave out pairs that cannot win, and the
list of walls near a robot is used only while it provably holds the nearest one. A sample's values
do not depend on the samples before it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.farthest import farthest_pair
from physim.geometry.nearest_robots import (
    Neighbours,
    Pairs,
    nearest_others,
    neighbours,
    no_pairs,
)
from physim.geometry.nearest_wall import WallLists, empty_lists, nearest_parts
from physim.geometry.robot_frames import bounding_discs, set_frames
from physim.geometry.shapes import FloatArray, IntArray, Shapes, locked, part_bodies
from physim.geometry.wall_grid import WallGrid


class Clearances(NamedTuple):
    """Signed distances [m] at B samples of N robots: negative = depth. Bodies by id, -1 = none."""

    clearance: FloatArray
    """(B, N) to the nearest other robot, inf if there is none"""
    other: IntArray
    """(B, N) that robot"""
    boundary_clearance: FloatArray
    """(B, N) to the nearest wall, inf if there is none"""
    boundary_other: IntArray
    """(B, N) body id of that wall: N + its index in ``walls``"""
    farthest: FloatArray
    """(B,) largest distance between the shapes of two robots, -inf if there is one robot only"""
    farthest_a: IntArray
    """(B,) the one robot of that pair, a < b"""
    farthest_b: IntArray
    """(B,)"""


class Known(NamedTuple):
    """What is known from the samples before."""

    robots: Neighbours
    walls: WallLists


class ClearanceFinder:
    """Finds clearances of one run, block by block; what it learns of a block speeds up the next."""

    def __init__(self, shapes: Shapes, walls: Shapes, wall_grid: WallGrid) -> None:
        robots = len(shapes.body_start) - 1
        # Read-only, whoever asks: for arrays that may be written to, kernels are compiled anew.
        self._world = (
            locked(shapes),
            locked(walls),
            locked(wall_grid),
            locked(part_bodies(walls)),
        )
        self._known: Known | None = None
        self._pairs = no_pairs(8 * robots)
        self.measured = 0
        """distances of two robots that were worked out for ``clearance``, over all blocks"""

    def find(self, poses: FloatArray) -> Clearances:
        """Clearances of poses (B, N, 3): as `clearances` gives them, whatever was found before."""
        samples, robots = poses.shape[:2]
        out = Clearances(
            np.empty((samples, robots)),
            np.empty((samples, robots), dtype=np.int64),
            np.empty((samples, robots)),
            np.empty((samples, robots), dtype=np.int64),
            np.empty(samples),
            np.empty(samples, dtype=np.int64),
            np.empty(samples, dtype=np.int64),
        )
        if not samples:
            return out
        if self._known is None:
            self._known = Known(neighbours(poses[0]), empty_lists(robots))
        poses = locked(np.ascontiguousarray(poses))
        self._pairs, measured = fill(poses, *self._world, self._known, self._pairs, out)
        self.measured += measured
        return out


def clearances(poses: FloatArray, shapes: Shapes, walls: Shapes, wall_grid: WallGrid) -> Clearances:
    """Work out the clearances of poses (B, N, 3) of the N robots in ``shapes``."""
    return ClearanceFinder(shapes, walls, wall_grid).find(poses)


@compiled
def fill(
    poses: FloatArray,
    shapes: Shapes,
    walls: Shapes,
    wall_grid: WallGrid,
    part_body: IntArray,
    known: Known,
    pairs: Pairs,
    out: Clearances,
) -> tuple[Pairs, int]:
    """Write `clearances` into ``out``; ``part_body`` (P,) names the body of each wall part.

    Returns ``pairs`` for the next block, and how many distances of two robots were worked out for
    ``clearance``.
    """
    robots = poses.shape[1]
    discs = bounding_discs(shapes)
    frame = np.empty((robots, 6))
    spread, rim = np.empty(robots), np.empty(robots, dtype=np.int64)
    part = np.empty(robots, dtype=np.int64)
    measured = 0
    for b in range(len(poses)):
        pose = poses[b]
        set_frames(pose, discs, frame)
        pairs, count = nearest_others(
            shapes, discs, pose, frame, known.robots, pairs, out.clearance[b], out.other[b]
        )
        measured += count
        out.farthest[b], out.farthest_a[b], out.farthest_b[b] = farthest_pair(
            shapes, discs, frame, spread, rim
        )
        gap = out.boundary_clearance[b]
        nearest_parts(shapes, pose, frame, walls, wall_grid, known.walls, gap, part)
        for i in range(robots):
            out.boundary_other[b, i] = robots + part_body[part[i]] if part[i] >= 0 else -1
    return pairs, measured
