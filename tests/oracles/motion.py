"""Equation (1) with constant speeds: positions along circular arcs, many at once."""

from __future__ import annotations

import numpy as np


def arc(pose, command, t):
    """Poses (..., 3) after t [s] at constant (v, omega) from poses (..., 3); all broadcast.

    x' = v cos(heading), y' = v sin(heading), heading' = omega, integrated by hand.
    """
    x, y, heading = np.moveaxis(np.asarray(pose, dtype=float), -1, 0)
    v, omega = np.moveaxis(np.asarray(command, dtype=float), -1, 0)
    end = heading + omega * t
    turning = omega != 0.0
    radius = v / np.where(turning, omega, 1.0)
    dx = np.where(turning, radius * (np.sin(end) - np.sin(heading)), v * t * np.cos(heading))
    dy = np.where(turning, -radius * (np.cos(end) - np.cos(heading)), v * t * np.sin(heading))
    return np.stack(np.broadcast_arrays(x + dx, y + dy, end), axis=-1)


def placed(part, pose):
    """Vertices (..., n, 2) of a part (n, 2) of the robot's frame, at poses (..., 3)."""
    part, pose = np.asarray(part, dtype=float), np.asarray(pose, dtype=float)
    x, y, heading = (column[..., None] for column in np.moveaxis(pose, -1, 0))
    px, py = np.moveaxis(part, -1, 0)
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([x + c * px - s * py, y + s * px + c * py], axis=-1)
