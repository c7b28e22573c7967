"""Poses and velocities of all robots as arrays: the one user of `pymunk.batch`.

pymunk marks that module experimental, so nothing else depends on it. Bodies are listed in the
order in which they were added, dynamic ones first; the space's static body closes the list.
"""

from __future__ import annotations

import numpy as np
import pymunk
from pymunk.batch import BodyFields, Buffer, get_space_bodies, set_space_bodies

from physim.geometry.shapes import FloatArray

_POSE = BodyFields.POSITION | BodyFields.ANGLE
_VELOCITY = BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
_DRIVE = _VELOCITY | BodyFields.FORCE | BodyFields.TORQUE


class BodyArrays:
    """Reads and writes the N robots of a space; the arrays are shared with the engine.

    Fill ``pose``, ``velocity`` or ``drive`` and call the method of that name to pass it on.
    """

    def __init__(self, space: pymunk.Space, robots: int) -> None:
        """Attach to a space that has ``robots`` dynamic bodies."""
        self._space = space
        rows = robots + 1  # the static body is listed too
        pose, self._pose_buffer = _shared(rows, 3)
        velocity, self._velocity_buffer = _shared(rows, 3)
        drive, self._drive_buffer = _shared(rows, 6)
        self.pose: FloatArray = pose[:robots]
        """(N, 3) x, y [m], heading [rad, unwrapped], as last read or to be written"""
        self.velocity: FloatArray = velocity[:robots]
        """(N, 3) vx, vy [m/s], omega [rad/s], as last read or to be written"""
        self.drive: FloatArray = drive[:robots]
        """(N, 6) vx, vy, omega, fx, fy [N], torque [N m], to be written"""

    def read_pose(self) -> None:
        """Fill ``pose``."""
        self._pose_buffer.clear()
        get_space_bodies(self._space, _POSE, self._pose_buffer)

    def read_velocity(self) -> None:
        """Fill ``velocity``."""
        self._velocity_buffer.clear()
        get_space_bodies(self._space, _VELOCITY, self._velocity_buffer)

    def write_pose(self) -> None:
        """Put every robot at its row of ``pose``."""
        set_space_bodies(self._space, _POSE, self._pose_buffer)

    def write_velocity(self) -> None:
        """Give every robot its row of ``velocity``."""
        set_space_bodies(self._space, _VELOCITY, self._velocity_buffer)

    def write_drive(self) -> None:
        """Give every robot its row of ``drive``; the engine forgets forces after a step."""
        set_space_bodies(self._space, _DRIVE, self._drive_buffer)


def _shared(rows: int, columns: int) -> tuple[FloatArray, Buffer]:
    # One spare row: the engine must never find the array full, or it would reallocate it.
    array = np.zeros((rows + 1, columns))
    buffer = Buffer()
    buffer.set_float_buf(array)
    return array, buffer
