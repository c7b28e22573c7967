"""Collision time (11) of bodies under constant twists, in kernels.

The collision time xi [s] is the smallest time at which two shapes, closed sets, intersect if both
keep their twists; 0 while they overlap or touch (within CONTACT = 1e-9 m), inf when there is none
up to the horizon. It is never late: at every earlier instant the shapes are apart, and at xi they
are within 1e-9 m; a graze within 1e-9 m may count either way. Should the advancement of parts that
turn reach its cap (MOST_STEPS), the value is a lower bound.

- Both keep their headings (omega = 0): closed form, `physim.geometry.translation`.
- Otherwise: certified conservative advancement, `physim.geometry.advancement`.

Early outs only leave out what cannot meet, and never change a value. A twist is (v [m/s],
omega [rad/s]) in the body frame, poses are (3,) in the world frame.
"""

from __future__ import annotations

import math

import numpy as np

from physim.compiled import compiled
from physim.geometry.advancement import advancement_time
from physim.geometry.motion import (
    Course,
    arc_course,
    moves_straight,
    relative_motion,
    still_course,
)
from physim.geometry.separation import point_gap
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.geometry.translation import translation_time

BOUND_MARGIN = 1e-8
"""[m] An early out must leave this much: ten times CONTACT, and far above rounding."""

LARGEST_CIRCLE = 1e6
"""[m] Radius of a turning circle up to which discs are trusted: its middle is known to 1e-16 of
that, which must stay far below BOUND_MARGIN."""

Twist = tuple[float, float]


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
def nearly_straight(a: Course) -> bool:
    """Whether a body turns so slowly that neither a disc nor a straight line bounds its way."""
    return a.turn != 0.0 and not stays(a)


@compiled
def nearest_pass(x: float, y: float, vx: float, vy: float, horizon: float) -> float:
    """Smallest distance from the origin of a point that starts at (x, y) and moves with v."""
    square = vx * vx + vy * vy
    t = 0.0
    if square > 0.0:
        t = min(max(-(x * vx + y * vy) / square, 0.0), horizon)
    x += t * vx
    y += t * vy
    return math.sqrt(x * x + y * y)


@compiled
def never_meet(a: Course, b: Course, horizon: float) -> bool:
    """Whether discs alone show that two bodies do not meet up to the horizon."""
    x = b.x - a.x
    y = b.y - a.y
    room = a.radius + b.radius + BOUND_MARGIN
    if math.sqrt(x * x + y * y) > room + (a.speed + b.speed) * horizon:
        return True
    return never_near(a, b, horizon)


@compiled
def never_near(a: Course, b: Course, horizon: float) -> bool:
    """`never_meet` from where the bodies go, not from how far they can go at all."""
    x = b.x - a.x
    y = b.y - a.y
    room = a.radius + b.radius + BOUND_MARGIN
    if a.turn == 0.0 and b.turn == 0.0:
        return nearest_pass(x, y, b.vx - a.vx, b.vy - a.vy, horizon) > room
    if nearly_straight(a) or nearly_straight(b):
        return False
    ax, ay, ra = swept_disc(a)
    bx, by, rb = swept_disc(b)
    room = ra + rb + BOUND_MARGIN
    if stays(a):
        if stays(b):
            x = bx - ax
            y = by - ay
            return math.sqrt(x * x + y * y) > room
        return nearest_pass(b.x - ax, b.y - ay, b.vx, b.vy, horizon) > room
    return nearest_pass(a.x - bx, a.y - by, a.vx, a.vy, horizon) > room


@compiled
def part_time(
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    horizon: float,
) -> float:
    """Collision time [s] of two parts on their courses."""
    if moves_straight(a, b):
        c, s, x, y, vx, vy = relative_motion(a, b)
        return translation_time(P, p0, p1, Q, q0, q1, c, s, x, y, vx, vy, horizon)
    return advancement_time(P, p0, p1, a, Q, q0, q1, b, horizon)[0]


@compiled
def bodies_time(
    shapes_a: Shapes, i: int, a: Course, shapes_b: Shapes, j: int, b: Course, horizon: float
) -> float:
    """Collision time [s] of body i on course a and body j on course b; inf when there is none."""
    xi = np.inf
    if never_meet(a, b, horizon):
        return xi
    P, p_start = shapes_a.vertices, shapes_a.part_start
    Q, q_start = shapes_b.vertices, shapes_b.part_start
    q_first, q_last = shapes_b.body_start[j], shapes_b.body_start[j + 1]
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        p0, p1 = p_start[p], p_start[p + 1]
        for q in range(q_first, q_last):
            time = part_time(P, p0, p1, a, Q, q_start[q], q_start[q + 1], b, min(xi, horizon))
            xi = min(xi, time)
    return xi


@compiled
def clear_of_part(a: Course, W: FloatArray, p0: int, p1: int, horizon: float) -> bool:
    """Whether discs alone show that a body does not meet a part that stands still."""
    if stays(a):
        x, y, radius = swept_disc(a)
        return point_gap(W, p0, p1, x, y) > radius + BOUND_MARGIN
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
    for k in range(p0, p1):
        x = W[k, 0] - a.x
        y = W[k, 1] - a.y
        along = ux * x + uy * y
        across = ux * y - uy * x
        left = min(left, across)
        right = min(right, -across)
        behind = min(behind, -along)
        beyond = min(beyond, along - a.speed * horizon)
    return left > room or right > room or behind > room or beyond > room


@compiled
def walls_time(
    shapes: Shapes, i: int, a: Course, walls: Shapes, part_ids: IntArray, horizon: float
) -> float:
    """Collision time [s] of body i on course a and the given parts, which stand still."""
    still = still_course()
    xi = np.inf
    if a.spin != 0.0 and (a.turn == a.spin or a.speed == 0.0):
        # After a full turn all repeats.
        horizon = min(horizon, 2.0 * math.pi / abs(a.spin) * (1.0 + 1e-6))
    W, w_start = walls.vertices, walls.part_start
    Q, q_start = shapes.vertices, shapes.part_start
    first, last = shapes.body_start[i], shapes.body_start[i + 1]
    for part in part_ids:
        w0, w1 = w_start[part], w_start[part + 1]
        if clear_of_part(a, W, w0, w1, min(xi, horizon)):
            continue
        for q in range(first, last):
            q0, q1 = q_start[q], q_start[q + 1]
            xi = min(xi, part_time(W, w0, w1, still, Q, q0, q1, a, min(xi, horizon)))
    return xi


@compiled
def collision_time_pair(
    shapes: Shapes,
    i: int,
    pose_i: FloatArray,
    twist_i: Twist,
    j: int,
    pose_j: FloatArray,
    twist_j: Twist,
    horizon: float,
) -> float:
    """Collision time (11) [s] of robots i and j of ``shapes``, each on its arc; inf if none."""
    a = arc_course(pose_i, twist_i[0], twist_i[1], shapes.radius[i])
    b = arc_course(pose_j, twist_j[0], twist_j[1], shapes.radius[j])
    return bodies_time(shapes, i, a, shapes, j, b, horizon)


@compiled
def collision_time_walls(
    shapes: Shapes,
    i: int,
    pose: FloatArray,
    twist: Twist,
    walls: Shapes,
    part_ids: IntArray,
    horizon: float,
) -> float:
    """Collision time (11) [s] of robot i on its arc and the given parts of ``walls``."""
    a = arc_course(pose, twist[0], twist[1], shapes.radius[i])
    return walls_time(shapes, i, a, walls, part_ids, horizon)
