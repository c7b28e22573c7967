"""Swept contacts of a run as contact rows: bodies that touch between two samples, apart at both.

The engine looks at samples only and lets such bodies pass; the geometry finds them, block by block
as the run is recorded.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.contacts import CONTACT_ROW, Kind, Phase
from physim.geometry.clearance import Clearances
from physim.geometry.shapes import FloatArray
from physim.geometry.swept_contacts import FULL, find_swept_contacts, travel_bounds, within_reach
from physim.world.scene import Scene

ROOM = 64
"""Rows that the search has room for at first."""


class SweptContactFinder:
    """Finds the swept contacts of one run, given every sample once and in order."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        none = np.zeros((0, scene.robots))
        self._before = np.zeros((0, scene.robots, 3)), none, none

    def rows(self, first: int, poses: FloatArray, found: Clearances) -> NDArray[np.void]:
        """Contact rows of kind *swept* of the steps that end with the samples of a block.

        ``poses`` (B, N, 3) of samples ``first`` on, with their clearances. In a row ``step`` is
        the sample at the end of its step; point, normal and depth are those of the instant at
        which the two are closest.
        """
        scene = self._scene
        known = poses, found.clearance, found.boundary_clearance
        poses, gap, wall_gap = map(np.concatenate, zip(self._before, known, strict=True))
        self._before = poses[-1:].copy(), gap[-1:].copy(), wall_gap[-1:].copy()
        travel = travel_bounds(poses, scene.shapes.radius)
        robots, walls = within_reach(travel, gap, wall_gap)
        if not robots.any() and not walls.any():
            return np.zeros(0, CONTACT_ROW)
        who, values = _found(scene, poses, travel, robots, walls)
        rows = np.zeros(len(who), CONTACT_ROW)
        rows["step"] = who[:, 0] + first + len(known[0]) - len(poses)
        rows["a"], rows["b"] = who[:, 1], who[:, 2]
        rows["phase"], rows["kind"] = Phase.BEGAN, Kind.SWEPT
        rows["x"], rows["y"], rows["nx"], rows["ny"] = values[:, :4].T
        rows["depth"] = np.maximum(-values[:, 4], 0.0)
        return rows


def _found(
    scene: Scene,
    poses: FloatArray,
    travel: FloatArray,
    robots: NDArray[np.bool_],
    walls: NDArray[np.bool_],
) -> tuple[NDArray[np.int64], FloatArray]:
    """Output of the search, with as much room as it needs."""
    room = ROOM
    while True:
        who, values = np.empty((room, 3), dtype=np.int64), np.empty((room, 5))
        count = find_swept_contacts(
            poses, travel, robots, walls, scene.shapes, scene.walls, scene.dt, who, values
        )
        if count != FULL:
            return who[:count], values[:count]
        room *= 4


def warm_up_swept_contacts(scene: Scene) -> None:
    """Compile or load the kernel: a search in a step in which nobody is near anything."""
    none = np.zeros((1, scene.robots), dtype=np.bool_)
    _found(scene, np.stack((scene.start, scene.start)), np.zeros(none.shape), none, none)
