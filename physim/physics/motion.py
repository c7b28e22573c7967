"""Exact motion under a held command, as a velocity that the engine applies over one step."""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray


@compiled
def chord_velocities(pose: FloatArray, command: FloatArray, dt: float, out: FloatArray) -> None:
    """Write to ``out`` (N, 3) the velocity vx, vy, omega that ends each step on its arc.

    The solution of (1) for a command (v, omega) held over ``dt`` is a circular arc. Its chord
    has the length v dt sin(h)/h and the direction heading + h, with h = omega dt / 2.
    """
    for i in range(len(pose)):
        h = 0.5 * command[i, 1] * dt
        along = command[i, 0] * (np.sin(h) / h if h != 0.0 else 1.0)
        out[i, 0] = along * np.cos(pose[i, 2] + h)
        out[i, 1] = along * np.sin(pose[i, 2] + h)
        out[i, 2] = command[i, 1]
