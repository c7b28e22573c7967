"""Swept contacts of a run as contact rows: bodies that touch between two samples, apart at both.

The engine looks at samples only and lets such bodies pass; the geometry finds them, step by step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.contacts import CONTACT_ROW, Kind, Phase
from physim.geometry.shapes import FloatArray, read_only
from physim.geometry.swept_contacts import (
    FULL,
    SweptRows,
    find_swept_contacts,
    no_room,
    wear_off,
)
from physim.world.scene import Scene

NO_ROWS = read_only(np.zeros(0, CONTACT_ROW))
ROOM = 64
"""SweptRows that the search has room for at first."""


class SweptContactFinder:
    """Finds the swept contacts of steps; one that begins where the last one ended costs least."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._pose: FloatArray | None = None
        self._room = no_room(scene.shapes, np.isinf(scene.mass))
        """at ``_pose``"""

    def follow(
        self, step: int, old: FloatArray, now: FloatArray
    ) -> tuple[FloatArray, NDArray[np.void]]:
        """Velocities (N, 3) [m/s, rad/s] of a step, and its contact rows of kind *swept*.

        It leads from poses ``old`` (N, 3) to ``now``. In a row ``step`` is the sample at the end of
        its step; point, normal and depth are those of the instant at which the two are closest.
        """
        scene, velocity = self._scene, np.empty(old.shape)
        if old is not self._pose:
            self._forget()
        self._pose = now
        if not wear_off(old, now, scene.dt, scene.shapes.radius, self._room, velocity):
            return velocity, NO_ROWS
        who, values = self.search(old, now)
        if not len(who):
            return velocity, NO_ROWS
        rows = np.zeros(len(who), CONTACT_ROW)
        rows["step"] = step
        rows["a"], rows["b"] = who.T
        rows["phase"], rows["kind"] = Phase.BEGAN, Kind.SWEPT
        rows["x"], rows["y"], rows["nx"], rows["ny"] = values[:, :4].T
        rows["depth"] = np.maximum(-values[:, 4], 0.0)
        return velocity, rows

    def search(self, old: FloatArray, now: FloatArray) -> tuple[NDArray[np.int64], FloatArray]:
        """Output of `find_swept_contacts`, with as much room as it needs."""
        scene, room = self._scene, ROOM
        while True:
            out = SweptRows(np.empty((room, 2), dtype=np.int64), np.empty((room, 5)), room)
            count = find_swept_contacts(
                old, now, scene.shapes, scene.wall_tree, self._room, scene.dt, out
            )
            if count != FULL:
                return out.who[:count], out.values[:count]
            self._forget()
            room *= 4

    def _forget(self) -> None:
        """Let all robots be measured anew."""
        self._room.apart[:] = self._room.from_walls[:] = 0.0
