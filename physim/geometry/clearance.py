"""Clearances of many samples: nearest robot, nearest wall, farthest pair. For monitoring.

Values are exact, and a sample's values do not depend on the samples before it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.convex import frame_at
from physim.geometry.neighbours import (
    BoundingDiscs,
    Neighbours,
    bounding_discs,
    farthest_pair,
    nearest_others,
    neighbours,
    set_frames,
)
from physim.geometry.shapes import FloatArray, IntArray, Rows3, Shapes, part_bodies
from physim.geometry.walls import NearestWalls, Sight, WallTree, nearest_seen, nearest_walls


class Clearances(NamedTuple):
    """Signed distances [m] at B samples of N robots: negative = depth. Bodies by id, -1 = none."""

    clearance: FloatArray
    """(B, N) to the nearest other body that moves, inf if there is none"""
    other: IntArray
    """(B, N) that body"""
    boundary_clearance: FloatArray
    """(B, N) to the nearest wall, inf if there is none"""
    boundary_other: IntArray
    """(B, N) body id of that wall: its index in ``walls`` and the number of bodies that move"""
    farthest: FloatArray
    """(B,) largest distance between the shapes of two robots, -inf if there is one robot only"""
    farthest_a: IntArray
    """(B,) the one robot of that pair, a < b"""
    farthest_b: IntArray
    """(B,)"""


class ClearanceFinder:
    """Finds clearances of one run, block by block; what it learns of a block speeds up the next."""

    def __init__(self, shapes: Shapes, wall_tree: WallTree, robots: int | None = None) -> None:
        """Bodies of these shapes, of which the first are so many ``robots``, or all of them."""
        moving = len(shapes.body_start) - 1
        self._robots = moving if robots is None else robots
        self._world = shapes, wall_tree, part_bodies(wall_tree.walls), bounding_discs(shapes)
        self._known = neighbours(moving), nearest_walls(moving)
        self.measured = 0
        """distances of two robots that were worked out for ``clearance``, over all blocks"""

    def find(self, poses: FloatArray) -> Clearances:
        """Clearances of poses (B, M, 3) of the M bodies, those of the robots: as `clearances` gives
        them, whatever was found before."""
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
        flat = Clearances._make(array.reshape(-1) for array in out)
        rows = np.ascontiguousarray(poses).reshape(-1, 3)
        counted = self._robots, *self._world, *self._known
        self.measured += fill_clearances(rows, samples, *counted, flat)
        if self._robots == robots:
            return out
        return Clearances._make(
            array if array.ndim == 1 else np.ascontiguousarray(array[:, : self._robots])
            for array in out
        )


def clearances(
    poses: FloatArray, shapes: Shapes, wall_tree: WallTree, robots: int | None = None
) -> Clearances:
    """Work out the clearances of poses (B, M, 3) of the bodies in ``shapes``: of ``robots``."""
    return ClearanceFinder(shapes, wall_tree, robots).find(poses)


@compiled
def fill_clearances(
    poses: Rows3,
    samples: int,
    only: int,
    shapes: Shapes,
    wall_tree: WallTree,
    part_body: IntArray,
    discs: BoundingDiscs,
    known: Neighbours,
    nearest: NearestWalls,
    out: Clearances,
) -> int:
    """Write `clearances` of poses (B N, 3) into ``out``, of the first ``only`` bodies, the robots.

    What is written of the others has no meaning. ``part_body`` (P,) names the body of each wall
    part; ``known`` and ``nearest`` go from block to block. Returns how many distances of two bodies
    were worked out for ``clearance``.
    """
    robots, measured = discs.robots, 0
    frame, spread, rim = np.empty((robots, 6)), np.empty(robots), np.empty(robots, np.int64)
    sight = Sight(wall_tree, 0.0, 0.0, np.inf, nearest)
    cluster = BoundingDiscs(discs.x, discs.y, discs.inner, discs.outer, only)
    for b in range(samples):
        row = robots * b
        set_frames(poses[row:], discs, frame)
        measured += nearest_others(
            shapes, discs, frame, known, out.clearance[row:], out.other[row:]
        )
        out.farthest[b], out.farthest_a[b], out.farthest_b[b] = farthest_pair(
            shapes, cluster, frame, spread, rim
        )
        for i in range(only):
            f = frame_at(frame[i, 2], frame[i, 3], frame[i, 0], frame[i, 1])
            out.boundary_clearance[row + i], part = nearest_seen(shapes, i, f, sight)
            out.boundary_other[row + i] = robots + part_body[part] if part >= 0 else -1
    return measured
