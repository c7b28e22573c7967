"""Equation (1) solved exactly: a constant twist (v, omega, lateral) is motion on a circular arc.

Over a time t the robot turns by ``omega t`` and its reference point moves along the chord of the
arc: ``v t sin(h) / h`` in the direction heading + h, with h = omega t / 2. ``sin(h) / h`` is
accurate to the last bits for every h but 0, so no case distinction by size is needed. The lateral
speed, left positive, is that of omnidirectional robots, and turns the chord: with 0 nothing is
added, so that the bits are those of (v, omega).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, Rows2, Rows3

NO_TURN = 1e-100
"""[rad/s] A body that turns more slowly is taken for one that does not: in no time does it turn by
as much as rounding, and bounds that are divided by rates as small as this would overflow."""


@compiled
def chord_factor(h: float) -> float:
    """Return sin(h) / h, 1 at h = 0: chord of an arc over its length, h = half its angle [rad]."""
    if h == 0.0:
        return 1.0
    return math.sin(h) / h


@compiled
def arc(
    x: float, y: float, heading: float, v: float, omega: float, lateral: float, t: float
) -> tuple[float, float, float]:
    """Return (x, y, heading) [m, m, rad] after time t [s] at a constant twist, equation (1).

    World frame; the heading is not wrapped; t may be negative.
    """
    h = 0.5 * omega * t
    factor = chord_factor(h)
    length = v * t * factor
    direction = heading + h
    c, s = math.cos(direction), math.sin(direction)
    dx, dy = length * c, length * s
    if lateral != 0.0:
        across = lateral * t * factor
        dx -= across * s
        dy += across * c
    return x + dx, y + dy, heading + omega * t


@compiled
def move(
    pose: FloatArray, v: float, omega: float, lateral: float, t: float, out: FloatArray
) -> None:
    """Write the pose (3,) after time t [s] by `arc` into ``out``."""
    out[0], out[1], out[2] = arc(pose[0], pose[1], pose[2], v, omega, lateral, t)


@compiled
def chord_velocity(
    heading: float, v: float, omega: float, lateral: float, dt: float
) -> tuple[float, float]:
    """Return the constant (vx, vy) [m/s], world frame, that ends where the arc of time dt ends."""
    h = 0.5 * omega * dt
    factor = chord_factor(h)
    speed = v * factor
    c, s = math.cos(heading + h), math.sin(heading + h)
    vx, vy = speed * c, speed * s
    if lateral != 0.0:
        vx -= lateral * factor * s
        vy += lateral * factor * c
    return vx, vy


Twist = tuple[float, float, float]
"""v [m/s], omega [rad/s] and lateral [m/s], left positive, in the body's frame"""


def twists(command: FloatArray) -> FloatArray:
    """Twists (N, 3) v [m/s], omega [rad/s], lateral [m/s] of commands (N, 2 or 3)."""
    out = np.zeros((len(command), 3))
    out[:, : command.shape[1]] = command
    return out


def ended_twists(pose: FloatArray, velocity: FloatArray, dt: float) -> FloatArray:
    """Twists (N, 3) at the end of a step of bodies, which moved with velocities (N, 3) in it.

    ``pose`` (N, 3) is that at its end, the velocity that of the chord, vx, vy [m/s], omega [rad/s].
    Exact where the twist was constant in the step.
    """
    half = 0.5 * velocity[:, 2] * dt
    vx, vy = velocity[:, :2].T / np.sinc(half / np.pi)
    c, s = np.cos(half - pose[:, 2]), np.sin(half - pose[:, 2])
    return np.stack((c * vx - s * vy, velocity[:, 2], s * vx + c * vy), axis=1)


def arcs(pose: FloatArray, command: FloatArray, t: float) -> FloatArray:
    """Poses (N, 3) after time t [s] of robots at poses (N, 3) with commands (N, 2 or 3)."""
    out = np.empty((len(pose), 3))
    put_arcs(pose, twists(command), len(pose), t, out)
    return out


@compiled
def put_arcs(pose: Rows3, twist: Rows3, robots: int, t: float, out: Rows3) -> None:
    """Write `arcs` of N ``robots`` with twists (N, 3) into ``out`` (N, 3)."""
    for i in range(robots):
        move(pose[i], twist[i, 0], twist[i, 1], twist[i, 2], t, out[i])


@compiled
def chord_velocities(pose: Rows3, twist: Rows3, robots: int, dt: float, out: Rows3) -> None:
    """Write the chord velocity of each of N ``robots``, and its omega, into ``out`` (N, 3).

    ``pose`` is (N, 3), ``twist`` (N, 3) as `twists` gives it.
    """
    for i in range(robots):
        vx, vy = chord_velocity(pose[i, 2], twist[i, 0], twist[i, 1], twist[i, 2], dt)
        out[i, 0] = vx
        out[i, 1] = vy
        out[i, 2] = twist[i, 1]


class Course(NamedTuple):
    """A body under a constant twist: pose now, velocity now, and how both turn (world frame)."""

    x: float
    y: float
    c: float
    """cosine of the heading"""
    s: float
    """sine of the heading"""
    vx: float
    """[m/s]"""
    vy: float
    turn: float
    """[rad/s] how fast the velocity turns: omega on an arc, 0 on a straight line"""
    spin: float
    """[rad/s] how fast the body turns"""
    speed: float
    """[m/s] length of the velocity, which is constant"""
    radius: float
    """[m] of the disc about the reference point that holds the body"""


@compiled
def arc_course(
    x: float, y: float, heading: float, v: float, omega: float, lateral: float, radius: float
) -> Course:
    """Course of a body with the twist (v, omega, lateral) in its own frame: an arc."""
    return facing_course(x, y, math.cos(heading), math.sin(heading), v, omega, lateral, radius)


@compiled
def facing_course(
    x: float, y: float, c: float, s: float, v: float, omega: float, lateral: float, radius: float
) -> Course:
    """`arc_course` of a body whose heading has the cosine c and the sine s."""
    if abs(omega) < NO_TURN:
        omega = 0.0
    vx, vy, speed = v * c, v * s, abs(v)
    if lateral != 0.0:
        vx -= lateral * s
        vy += lateral * c
        speed = math.sqrt(v * v + lateral * lateral)
    return Course(x, y, c, s, vx, vy, omega, omega, speed, radius)


def facings(pose: FloatArray) -> FloatArray:
    """Cosine and sine (N, 2) of the headings of poses (N, 3)."""
    out = np.empty((len(pose), 2))
    put_facings(pose, len(pose), out)
    return out


@compiled
def put_facings(pose: Rows3, robots: int, out: Rows2) -> None:
    """Write `facings` into ``out`` (N, 2)."""
    for i in range(robots):
        out[i, 0] = math.cos(pose[i, 2])
        out[i, 1] = math.sin(pose[i, 2])


@compiled
def straight_course(
    x: float, y: float, heading: float, vx: float, vy: float, omega: float, radius: float
) -> Course:
    """Course of a body with the twist (vx, vy, omega) in the world frame: a straight line."""
    c, s = math.cos(heading), math.sin(heading)
    speed = math.sqrt(vx * vx + vy * vy)
    if abs(omega) < NO_TURN:
        omega = 0.0
    return Course(x, y, c, s, vx, vy, 0.0, omega, speed, radius)


@compiled
def still_course() -> Course:
    """Course of what never moves and whose vertices are in the world frame: walls."""
    return Course(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled
def is_still(a: Course) -> bool:
    """Whether a body never moves and has its vertices in the world frame, as walls have."""
    return a.speed == 0.0 and a.spin == 0.0 and a.x == 0.0 and a.y == 0.0 and a.c == 1.0


@compiled
def along_course(course: Course, t: float) -> tuple[float, float, float, float, float, float]:
    """Return (x, y, c, s, vx, vy) after time t [s]: place, cos and sin of the heading, velocity."""
    x, y, c, s, vx, vy = course.x, course.y, course.c, course.s, course.vx, course.vy
    turned_c = 1.0
    turned_s = 0.0
    if course.turn == 0.0:
        x += vx * t
        y += vy * t
    else:
        h = 0.5 * course.turn * t
        ch = math.cos(h)
        sh = math.sin(h)
        length = t * (sh / h if h != 0.0 else 1.0)
        x += length * (ch * vx - sh * vy)
        y += length * (sh * vx + ch * vy)
        turned_c = 1.0 - 2.0 * sh * sh
        turned_s = 2.0 * sh * ch
        vx, vy = turned_c * vx - turned_s * vy, turned_s * vx + turned_c * vy
    if course.spin != course.turn:
        turned_c = math.cos(course.spin * t)
        turned_s = math.sin(course.spin * t)
    return x, y, turned_c * c - turned_s * s, turned_s * c + turned_c * s, vx, vy


@compiled
def moves_straight(a: Course, b: Course) -> bool:
    """Whether both bodies keep their headings and directions."""
    return a.turn == 0.0 and b.turn == 0.0 and a.spin == 0.0 and b.spin == 0.0
