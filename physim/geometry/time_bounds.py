"""Bounds of the collision time (11) of two bodies: from below by discs, from above by an overlap.

They say which of many pairs may decide before any collision time is worked out. Both keep far
from rounding: the discs must come within BOUND_MARGIN of each other, which is ten times what
counts as touching, and an overlap must be DEEP_ENOUGH, which no collision time steps over.
"""

from __future__ import annotations

import math

import numpy as np

from physim.compiled import compiled
from physim.geometry.collision import BOUND_MARGIN
from physim.geometry.convex import part_gap
from physim.geometry.gap_bounds import lasting
from physim.geometry.motion import Course, along_course
from physim.geometry.shapes import Shapes

CLOSE = 5e-2
"""[m] Discs this near to each other are not followed any further."""

MOST_ADVANCES = 60
"""Advances after which discs are not followed any further."""

DEEP_ENOUGH = 1e-6
"""[m] Bodies this deep within each other overlap whatever the rounding."""

LOOKS = 5
"""How many times are looked at for an overlap."""

STRIDE = 0.2
"""[-] From one such time to the next the bodies move by this share of both radii together."""

LEAST_SPEED = 0.1
"""[-] Share of both speeds that bodies side by side are taken to move past each other with."""


@compiled
def discs_lasting(room: float, along: float, pull: float) -> float:
    """Time [s] for which discs with ``room`` > 0 [m] between them cannot meet.

    They close at ``along`` [m/s] on the line of their middles, and their accelerations are at most
    ``pull`` [m/s^2] together.
    """
    return lasting(room, -along, pull)


@compiled
def discs_meet(a: Course, b: Course, start: float, horizon: float) -> float:
    """Time [s] up to which the discs of two bodies are apart; inf when they are up to the horizon.

    They are known to be apart up to ``start``. No collision time is smaller.
    """
    pull = a.speed * abs(a.turn) + b.speed * abs(b.turn)
    t = start
    for _ in range(MOST_ADVANCES):
        ax, ay, _, _, avx, avy = along_course(a, t)
        bx, by, _, _, bvx, bvy = along_course(b, t)
        x = bx - ax
        y = by - ay
        apart = math.sqrt(x * x + y * y)
        room = apart - a.radius - b.radius - BOUND_MARGIN
        if room <= CLOSE:
            return t
        along = ((avx - bvx) * x + (avy - bvy) * y) / apart
        t += discs_lasting(room, along, pull)
        if t > horizon:
            return np.inf
    return t


@compiled
def overlap_at(
    shapes_a: Shapes, i: int, a: Course, shapes_b: Shapes, j: int, b: Course, t: float
) -> bool:
    """Whether body i on course a and body j on course b are DEEP_ENOUGH in each other at time t."""
    ax, ay, ac, az, _, _ = along_course(a, t)
    bx, by, bc, bz, _, _ = along_course(b, t)
    c = ac * bc + az * bz
    s = ac * bz - az * bc
    tx = ac * (bx - ax) + az * (by - ay)
    ty = ac * (by - ay) - az * (bx - ax)
    P, p_start = shapes_a.vertices, shapes_a.part_start
    Q, q_start = shapes_b.vertices, shapes_b.part_start
    q_first, q_last = shapes_b.body_start[j], shapes_b.body_start[j + 1]
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        p0, p1 = p_start[p], p_start[p + 1]
        for q in range(q_first, q_last):
            gap = part_gap(
                P, p0, p1, Q, q_start[q], q_start[q + 1], c, s, tx, ty, 0.0, 0.0, -DEEP_ENOUGH
            )
            if gap < -DEEP_ENOUGH:
                return True
    return False


@compiled
def overlap_time(
    shapes_a: Shapes,
    i: int,
    a: Course,
    shapes_b: Shapes,
    j: int,
    b: Course,
    start: float,
    limit: float,
) -> float:
    """Return a time [s] from ``start`` on and below ``limit`` at which two bodies surely overlap.

    No collision time is larger. inf where no such time was found, though there may be one.
    """
    _, _, _, _, avx, avy = along_course(a, start)
    _, _, _, _, bvx, bvy = along_course(b, start)
    x = avx - bvx
    y = avy - bvy
    speed = max(math.sqrt(x * x + y * y), LEAST_SPEED * (a.speed + b.speed))
    if speed == 0.0:
        return np.inf
    stride = STRIDE * (a.radius + b.radius) / speed
    t = start
    for _ in range(LOOKS):
        t += stride
        if t >= limit:
            break
        if overlap_at(shapes_a, i, a, shapes_b, j, b, t):
            return t
    return np.inf
