"""Swept contacts of a run as contact rows: bodies that touch between two samples, apart at both.

The engine looks at samples only and lets such bodies pass; the geometry finds them, step by step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.compiled import direct
from physim.contacts import CONTACT_ROW, Kind, Phase
from physim.geometry.shapes import FloatArray, read_only
from physim.geometry.swept_contacts import (
    FULL,
    find_swept_contacts,
    no_room,
    wear_off,
)
from physim.world.scene import Scene

NO_ROWS = read_only(np.zeros(0, CONTACT_ROW))
ROOM = 64
"""Rows that the search has room for at first."""


class SweptContactFinder:
    """Finds the swept contacts of steps; one that begins where the last one ended costs least."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._wear_off = direct(wear_off)
        self._pose: FloatArray | None = None
        self._room = no_room(scene.shapes)
        """at ``_pose``"""

    def follow(
        self, step: int, old: FloatArray, now: FloatArray
    ) -> tuple[FloatArray, NDArray[np.void]]:
        """Velocities (N, 3) [m/s, rad/s] of a step, and its contact rows of kind *swept*.

        It leads from poses ``old`` (N, 3) to ``now``. In a row ``step`` is the sample at the end of
        its step; point, normal and depth are those of the instant at which the two are closest.
        """
        scene, velocity = self._scene, np.empty(old.shape)
        bound, reach = self._room.bound, self._room.reach
        if old is not self._pose:
            bound[:] = 0.0
        self._pose = now
        if not self._wear_off(old, now, scene.dt, scene.shapes.radius, bound, reach, velocity):
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
        scene, known, room = self._scene, self._room, ROOM
        while True:
            who, values = np.empty((room, 2), dtype=np.int64), np.empty((room, 5))
            count = find_swept_contacts(
                old, now, scene.shapes, scene.wall_tree, known, scene.dt, who, values
            )
            if count != FULL:
                return who[:count], values[:count]
            known.bound[:] = 0.0
            room *= 4
