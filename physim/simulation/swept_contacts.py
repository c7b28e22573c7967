"""Swept contacts of a run as contact rows: bodies that touch between two samples, apart at both.

The engine looks at samples only and lets such bodies pass; the geometry finds them, step by step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.compiled import direct
from physim.contacts import CONTACT_ROW, Kind, Phase
from physim.geometry.clearance import ClearanceFinder
from physim.geometry.shapes import FloatArray, joined_shapes, locked, read_only
from physim.geometry.swept import FULL, find_swept_contacts, wear_off
from physim.world.scene import Scene

NO_ROWS = read_only(np.zeros(0, CONTACT_ROW))
ROOM = 64
"""Rows that the search has room for at first."""


class SweptContactFinder:
    """Finds the swept contacts of steps; one that begins where the last one ended costs least."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._bodies = locked(joined_shapes(scene.shapes, scene.walls))
        self._clearances = ClearanceFinder(scene.shapes, scene.wall_tree)
        self._wear_off = direct(wear_off)
        self._pose: FloatArray | None = None
        self._room, self._reach = np.empty((2, 2, scene.robots))
        """(2, N) [m] of `wear_off`, at ``_pose``"""

    def rows(self, step: int, old: FloatArray, now: FloatArray) -> NDArray[np.void]:
        """Contact rows of kind *swept* of the step from poses ``old`` (N, 3) to ``now``.

        In a row ``step`` is the sample at the end of its step; point, normal and depth are those of
        the instant at which the two are closest.
        """
        scene = self._scene
        if old is not self._pose:
            self._room[:] = -np.inf
        self._pose = now
        if not self._wear_off(old, now, scene.shapes.radius, self._reach, self._room):
            return NO_ROWS
        found = self._clearances.find(now[None])
        self._room[0], self._room[1] = found.clearance, found.boundary_clearance
        near = self._room <= self._reach
        if not near.any():
            return NO_ROWS
        who, values = self.search(old, now, self._reach, near)
        rows = np.zeros(len(who), CONTACT_ROW)
        rows["step"] = step
        rows["a"], rows["b"] = who.T
        rows["phase"], rows["kind"] = Phase.BEGAN, Kind.SWEPT
        rows["x"], rows["y"], rows["nx"], rows["ny"] = values[:, :4].T
        rows["depth"] = np.maximum(-values[:, 4], 0.0)
        return rows

    def search(
        self, old: FloatArray, now: FloatArray, reach: FloatArray, near: NDArray[np.bool_]
    ) -> tuple[NDArray[np.int64], FloatArray]:
        """Output of `find_swept_contacts`, with as much room as it needs; walls stand still."""
        still, room = np.zeros((len(self._bodies.radius) - len(now), 3)), ROOM
        old, now = np.concatenate((old, still)), np.concatenate((now, still))
        while True:
            who, values = np.empty((room, 2), dtype=np.int64), np.empty((room, 5))
            count = find_swept_contacts(
                old, now, reach, near, self._bodies, self._scene.dt, who, values
            )
            if count != FULL:
                return who[:count], values[:count]
            room *= 4
