"""Collision time (11) of bodies under constant twists, in kernels.

The collision time xi [s] is the smallest time at which two shapes, closed sets, intersect if both
keep their twists; 0 while they overlap or touch (within CONTACT = 1e-9 m), inf when there is none
up to the horizon. It is never late: at every earlier instant the shapes are apart, and at xi they
are within 1e-9 m; a graze within 1e-9 m may count either way. Should the advancement of parts that
turn reach its cap (MOST_STEPS), the value is a lower bound.

- Both keep their headings (omega = 0): closed form. As P sees it, part Q moves along a straight
  line. Along each separating axis the gap is linear in time, so it says when the parts overlap on
  that axis; they touch while they overlap on all axes (normals of both; for two segments or points,
  which those do not decide, their directions too).
- Otherwise: certified conservative advancement, `physim.geometry.advancement`.

Early outs only leave out what cannot meet, and never change a value. A twist is (v [m/s],
omega [rad/s]) in the body frame, poses are (3,) in the world frame.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.advancement import advancement_time
from physim.geometry.bodies import point_gap
from physim.geometry.convex import Frame, edge_normal, frame_at, part_gap, support_gap
from physim.geometry.motion import (
    Course,
    arc_course,
    is_still,
    moves_straight,
)
from physim.geometry.shapes import FloatArray, Part, Shapes
from physim.tolerances import CONTACT

BOUND_MARGIN = 1e-8
"""[m] An early out must leave this much: ten times CONTACT, and far above rounding."""

LARGEST_CIRCLE = 1e6
"""[m] Radius of a turning circle up to which discs are trusted: its middle is known to 1e-16 of
that, which must stay far below BOUND_MARGIN."""

PARALLEL = 1e-12
"""[-] Motion along an axis below this share of the speed is rounding: 1e-10 m over 100 m."""

Twist = tuple[float, float]


# Closed form


class Straight(NamedTuple):
    """Part Q as part P sees it now, and its velocity."""

    f: Frame
    vx: float
    """[m/s] in P's frame"""
    vy: float


@compiled
def straight_motion(a: Course, b: Course) -> Straight:
    """Body b as body a sees it."""
    x, y, vx, vy = b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy
    c, s = a.c * b.c + a.s * b.s, a.c * b.s - a.s * b.c
    f = frame_at(c, s, a.c * x + a.s * y, a.c * y - a.s * x)
    return Straight(f, a.c * vx + a.s * vy, a.c * vy - a.s * vx)


class Times(NamedTuple):
    """When two parts overlap on the axes looked at so far [s]."""

    first: float
    last: float
    near_first: float
    """likewise for gaps of at most CONTACT"""
    near_last: float


@compiled
def clip(times: Times, gap: float, rate: float, least: float) -> Times:
    """Cut the times of overlap down to those with ``gap + rate * t <= 0`` (or <= CONTACT)."""
    first, last = times.first, times.last
    near_first, near_last = times.near_first, times.near_last
    if abs(rate) <= least:
        if gap > 0.0:
            last = -np.inf
        if gap > CONTACT:
            near_last = -np.inf
    elif rate < 0.0:
        first = max(first, -gap / rate)
        near_first = max(near_first, (CONTACT - gap) / rate)
    else:
        last = min(last, -gap / rate)
        near_last = min(near_last, (CONTACT - gap) / rate)
    return Times(first, last, near_first, near_last)


@compiled
def clip_normals(times: Times, P: Part, Q: Part, motion: Straight, least: float) -> Times:
    """`clip` over the edge normals of P."""
    V, W, f = P.vertices, Q.vertices, motion.f
    k = P.end - 1
    for m in range(P.first, P.end):
        nx, ny, length = edge_normal(P, k, m)
        if length > 0.0:
            ux = f.c * nx + f.s * ny
            uy = f.c * ny - f.s * nx
            low = np.inf
            for j in range(Q.first, Q.end):
                low = min(low, ux * W[j, 0] + uy * W[j, 1])
            gap = low + (nx * (f.tx - V[k, 0]) + ny * (f.ty - V[k, 1]))
            times = clip(times, gap, nx * motion.vx + ny * motion.vy, least)
            if times.near_last < 0.0:
                return times
        k = m
    return times


@compiled
def clip_directions(times: Times, P: Part, Q: Part, motion: Straight, least: float) -> Times:
    """`clip` over the directions of two segments or points, of the motion, and across it."""
    V, W, f, wx, wy = P.vertices, Q.vertices, motion.f, motion.vx, motion.vy
    px = V[P.end - 1, 0] - V[P.first, 0]
    py = V[P.end - 1, 1] - V[P.first, 1]
    qx = W[Q.end - 1, 0] - W[Q.first, 0]
    qy = W[Q.end - 1, 1] - W[Q.first, 1]
    for axis in range(4):
        ax, ay = px, py
        if axis == 1:
            ax, ay = f.c * qx - f.s * qy, f.s * qx + f.c * qy
        elif axis == 2:
            ax, ay = wx, wy
        elif axis == 3:
            ax, ay = -wy, wx
        size = math.sqrt(ax * ax + ay * ay)
        if size > 0.0:
            for sign in (1.0, -1.0):
                nx = sign * ax / size
                ny = sign * ay / size
                gap = support_gap(P, Q, f, nx, ny)
                times = clip(times, gap, nx * wx + ny * wy, least)
    return times


@compiled
def translation_times(P: Part, a: Course, Q: Part, b: Course, horizon: float) -> Times:
    """When P and Q overlap on all axes, neither of which turns.

    Of times that do not come within [0, horizon] only that is sure: they do not.
    """
    motion = straight_motion(a, b)
    f, vx, vy = motion.f, motion.vx, motion.vy
    least = PARALLEL * math.sqrt(vx * vx + vy * vy)
    times = Times(-np.inf, np.inf, -np.inf, np.inf)
    times = clip_normals(times, P, Q, motion, least)
    if times.near_last < 0.0 or times.near_first > min(times.near_last, horizon):
        return times
    back = frame_at(f.c, -f.s, -(f.c * f.tx + f.s * f.ty), -(f.c * f.ty - f.s * f.tx))
    seen = Straight(back, -(f.c * vx + f.s * vy), -(f.c * vy - f.s * vx))
    times = clip_normals(times, Q, P, seen, least)
    if P.end - P.first <= 2 and Q.end - Q.first <= 2:
        times = clip_directions(times, P, Q, motion, least)
    return times


@compiled
def translation_time(P: Part, a: Course, Q: Part, b: Course, horizon: float) -> float:
    """Collision time [s] of P and Q, neither of which turns; inf if none.

    0 when they are within CONTACT now. Where they graze within CONTACT it may say either.
    """
    times = translation_times(P, a, Q, b, horizon)
    if times.near_last < 0.0 or times.near_first > min(times.near_last, horizon):
        return np.inf
    motion = straight_motion(a, b)
    f, vx, vy = motion.f, motion.vx, motion.vy
    if times.near_first <= 0.0 and part_gap(P, Q, f, np.inf) <= CONTACT:
        return 0.0
    xi = max(times.first, 0.0)
    if xi > horizon:
        return np.inf
    if xi <= times.last:
        return xi
    # A graze: the overlap is shorter than rounding, or a gap within CONTACT.
    there = frame_at(f.c, f.s, f.tx + xi * vx, f.ty + xi * vy)
    return xi if part_gap(P, Q, there, np.inf) <= CONTACT else np.inf


# Early outs


@compiled
def swept_disc(a: Course) -> tuple[float, float, float]:
    """Return (x, y, radius) of the disc that a turning body never leaves, whatever the time."""
    if a.turn == 0.0:
        return a.x, a.y, a.radius
    return a.x - a.vy / a.turn, a.y + a.vx / a.turn, a.radius + a.speed / abs(a.turn)


@compiled
def stays(a: Course) -> bool:
    """Whether a body is confined to its `swept_disc`: it goes round, or stands still."""
    return a.speed == 0.0 or (a.turn != 0.0 and a.speed <= LARGEST_CIRCLE * abs(a.turn))


@compiled
def passes_by(x: float, y: float, vx: float, vy: float, horizon: float, room: float) -> bool:
    """Whether a point that starts at (x, y) and moves with v stays farther from the origin.

    Farther than ``room`` [m] up to the horizon.
    """
    toward, square = -(x * vx + y * vy), vx * vx + vy * vy
    if 0.0 < toward < square * horizon:
        across = x * vy - y * vx
        return across * across > room * room * square
    if toward > 0.0:
        x += horizon * vx
        y += horizon * vy
    return x * x + y * y > room * room


@compiled
def never_meet(a: Course, b: Course, horizon: float) -> bool:
    """Whether discs alone show that two bodies do not meet up to the horizon."""
    x = b.x - a.x
    y = b.y - a.y
    room = a.radius + b.radius + BOUND_MARGIN
    far = room + (a.speed + b.speed) * horizon
    if x * x + y * y > far * far:
        return True
    if a.turn == 0.0 and b.turn == 0.0:
        return passes_by(x, y, b.vx - a.vx, b.vy - a.vy, horizon, room)
    if (a.turn != 0.0 and not stays(a)) or (b.turn != 0.0 and not stays(b)):
        return False  # it turns so slowly that neither a disc nor a straight line bounds its way
    ax, ay, ra = swept_disc(a)
    bx, by, rb = swept_disc(b)
    room = ra + rb + BOUND_MARGIN
    if stays(a):
        if stays(b):
            x = bx - ax
            y = by - ay
            return math.sqrt(x * x + y * y) > room
        return passes_by(b.x - ax, b.y - ay, b.vx, b.vy, horizon, room)
    return passes_by(a.x - bx, a.y - by, a.vx, a.vy, horizon, room)


@compiled
def clear_of_part(a: Course, wall: Part, horizon: float) -> bool:
    """Whether discs alone show that a body does not meet a part that stands still."""
    if stays(a):
        x, y, radius = swept_disc(a)
        return point_gap(wall, x, y) > radius + BOUND_MARGIN
    if a.turn != 0.0:
        return False
    # Straight ahead: all vertices to the left, to the right, behind or beyond.
    ux = a.vx / a.speed
    uy = a.vy / a.speed
    room = a.radius + BOUND_MARGIN
    left = np.inf
    right = np.inf
    behind = np.inf
    beyond = np.inf
    for k in range(wall.first, wall.end):
        x = wall.vertices[k, 0] - a.x
        y = wall.vertices[k, 1] - a.y
        along = ux * x + uy * y
        across = ux * y - uy * x
        left = min(left, across)
        right = min(right, -across)
        behind = min(behind, -along)
        beyond = min(beyond, along - a.speed * horizon)
    return left > room or right > room or behind > room or beyond > room


# Bodies


@compiled
def part_time(P: Part, a: Course, Q: Part, b: Course, horizon: float) -> float:
    """Collision time [s] of two parts on their courses."""
    if moves_straight(a, b):
        return translation_time(P, a, Q, b, horizon)
    return advancement_time(P, a, Q, b, horizon)[0]


@compiled
def wall_time(P: Part, a: Course, shapes: Shapes, j: int, b: Course, horizon: float) -> float:
    """Collision time [s] of one part on course a and body j on course b; inf if none."""
    xi = np.inf
    if is_still(a) and clear_of_part(b, P, horizon):
        return xi
    V, start = shapes.vertices, shapes.part_start
    for q in range(shapes.body_start[j], shapes.body_start[j + 1]):
        Q = Part(V, start[q], start[q + 1])
        xi = min(xi, part_time(P, a, Q, b, min(xi, horizon)))
    return xi


@compiled
def bodies_time(
    shapes_a: Shapes, i: int, a: Course, shapes_b: Shapes, j: int, b: Course, horizon: float
) -> float:
    """Collision time [s] of body i on course a and body j on course b; inf when there is none.

    What is a wall or has many parts comes first: it costs less so.
    """
    xi = np.inf
    if never_meet(a, b, horizon):
        return xi
    until = until_all_repeats(b, horizon) if is_still(a) else horizon
    V, start = shapes_a.vertices, shapes_a.part_start
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        P = Part(V, start[p], start[p + 1])
        xi = min(xi, wall_time(P, a, shapes_b, j, b, min(xi, until)))
    return xi


@compiled
def until_all_repeats(a: Course, horizon: float) -> float:
    """Time [s], up to the horizon, after which a body meets no wall that it did not meet before."""
    if a.spin != 0.0 and (a.turn == a.spin or a.speed == 0.0):
        return min(horizon, 2.0 * math.pi / abs(a.spin) * (1.0 + 1e-6))
    return horizon


@compiled
def collision_time_pair(
    shapes_a: Shapes,
    i: int,
    pose_i: FloatArray,
    twist_i: FloatArray,
    shapes_b: Shapes,
    j: int,
    pose_j: FloatArray,
    twist_j: FloatArray,
    horizon: float,
) -> float:
    """Collision time (11) [s] of bodies i and j, each on the arc of its twist (3,); inf if none.

    A twist is (v, omega, lateral), as `physim.geometry.motion.twists` gives it. A wall is a body
    that stands at the origin; it comes first.
    """
    radius_a, radius_b = shapes_a.radius[i], shapes_b.radius[j]
    a = arc_course(pose_i[0], pose_i[1], pose_i[2], twist_i[0], twist_i[1], twist_i[2], radius_a)
    b = arc_course(pose_j[0], pose_j[1], pose_j[2], twist_j[0], twist_j[1], twist_j[2], radius_b)
    return bodies_time(shapes_a, i, a, shapes_b, j, b, horizon)
