"""Equation (1) solved exactly: constant (v, omega) is motion on a circular arc.

Over a time t the robot turns by ``omega t`` and its reference point moves along the chord of the
arc: ``v t sin(h) / h`` in the direction heading + h, with h = omega t / 2. ``sin(h) / h`` is
accurate to the last bits for every h but 0, so no case distinction by size is needed.
"""

from __future__ import annotations

import math

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray


@compiled
def chord_factor(h: float) -> float:
    """Return sin(h) / h, 1 at h = 0: chord of an arc over its length, h = half its angle [rad]."""
    if h == 0.0:
        return 1.0
    return math.sin(h) / h


@compiled
def arc(pose: FloatArray, v: float, omega: float, t: float) -> tuple[float, float, float]:
    """Return (x, y, heading) [m, m, rad] after time t [s] at constant (v, omega), equation (1).

    ``pose`` is (3,), world frame; the heading is not wrapped; t may be negative.
    """
    h = 0.5 * omega * t
    length = v * t * chord_factor(h)
    direction = pose[2] + h
    return (
        pose[0] + length * math.cos(direction),
        pose[1] + length * math.sin(direction),
        pose[2] + omega * t,
    )


@compiled
def chord_velocity(heading: float, v: float, omega: float, dt: float) -> tuple[float, float]:
    """Return the constant (vx, vy) [m/s], world frame, that ends where the arc of time dt ends."""
    h = 0.5 * omega * dt
    speed = v * chord_factor(h)
    return speed * math.cos(heading + h), speed * math.sin(heading + h)


@compiled
def arcs(pose: FloatArray, command: FloatArray, t: float) -> FloatArray:
    """Poses (N, 3) after time t [s] of robots at poses (N, 3) with commands (N, 2) (v, omega)."""
    out = np.empty_like(pose)
    for i in range(len(pose)):
        out[i] = arc(pose[i], command[i, 0], command[i, 1], t)
    return out


@compiled
def chord_velocities(pose: FloatArray, command: FloatArray, dt: float, out: FloatArray) -> None:
    """Write the chord velocity of each robot, and its omega, into ``out`` (N, 3).

    ``pose`` is (N, 3), ``command`` (N, 2): v [m/s] and omega [rad/s].
    """
    for i in range(len(pose)):
        vx, vy = chord_velocity(pose[i, 2], command[i, 0], command[i, 1], dt)
        out[i, 0] = vx
        out[i, 1] = vy
        out[i, 2] = command[i, 1]
