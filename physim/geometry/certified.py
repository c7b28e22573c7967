"""Bounds of a collision time, and when an overlap ends, in kernels.

They bound the *exact* collision time, the first instant at which the closed shapes have a point
in common: `certified_start` from below, `overlap_after` from above. Not used in a run.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.advancement import MOST_STEPS, Look, advancement_time, fall_time, look_at
from physim.geometry.collision import part_time
from physim.geometry.face_bound import faces_last, turned
from physim.geometry.motion import Course, moves_straight, relative_motion
from physim.geometry.shapes import FloatArray, Shapes
from physim.geometry.translation import Times, translation_times
from physim.tolerances import CONTACT

DEPTH = 0.01 * CONTACT
"""[m] Shapes overlap for sure where their depth is more than this: above rounding up to 10 km."""

FIRST_STRIDE = 1e-9
"""[s] First look for an overlap after a contact; strides double from there."""

Encounter = tuple[float, float, int]
"""entry [s], exit [s] (inf, inf without contact), advances"""


@compiled
def straight_times(
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    horizon: float,
) -> Times:
    """`translation_times` of parts on their courses."""
    c, s, x, y, vx, vy = relative_motion(a, b)
    return translation_times(P, p0, p1, Q, q0, q1, c, s, x, y, vx, vy, horizon)


@compiled
def certified_start(
    shapes_a: Shapes, i: int, a: Course, shapes_b: Shapes, j: int, b: Course, horizon: float
) -> tuple[float, float, bool]:
    """Return (collision time [s], lower bound of the exact one, was the cap of advances hit?).

    The time is that of `collision.bodies_time`, to the last bit.
    """
    P, p_start = shapes_a.vertices, shapes_a.part_start
    Q, q_start = shapes_b.vertices, shapes_b.part_start
    straight = moves_straight(a, b)
    xi = np.inf
    lower = np.inf
    capped = False
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        p0, p1 = p_start[p], p_start[p + 1]
        for q in range(shapes_b.body_start[j], shapes_b.body_start[j + 1]):
            q0, q1 = q_start[q], q_start[q + 1]
            until = min(xi, horizon)
            if straight:
                time = part_time(P, p0, p1, a, Q, q0, q1, b, until)
                _, _, near, near_last = straight_times(P, p0, p1, a, Q, q0, q1, b, until)
                if near_last >= 0.0 and near <= min(near_last, until):
                    lower = min(lower, max(0.0, near))
                stopped = False
            else:
                time, d, steps = advancement_time(P, p0, p1, a, Q, q0, q1, b, until)
                lower = min(lower, time)
                stopped = steps >= MOST_STEPS and d > CONTACT
            if time < xi:
                xi = time
                capped = stopped
    return xi, lower, capped


@compiled
def depth_at(
    shapes_a: Shapes, i: int, a: Course, shapes_b: Shapes, j: int, b: Course, t: float
) -> float:
    """Depth [m] of two bodies at time t [s]; negative where they are apart."""
    P, p_start = shapes_a.vertices, shapes_a.part_start
    Q, q_start = shapes_b.vertices, shapes_b.part_start
    depth = -np.inf
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        for q in range(shapes_b.body_start[j], shapes_b.body_start[j + 1]):
            look = look_at(
                P, p_start[p], p_start[p + 1], a, Q, q_start[q], q_start[q + 1], b, t
            )  # fmt: skip
            depth = max(depth, -look.distance)
    return depth


@compiled
def overlap_after(
    shapes_a: Shapes,
    i: int,
    a: Course,
    shapes_b: Shapes,
    j: int,
    b: Course,
    start: float,
    horizon: float,
) -> float:
    """Return a time from ``start`` on at which two bodies overlap for sure; inf if none is found.

    As near to the start as can be found: sought in strides that double, then by bisection.
    """
    if depth_at(shapes_a, i, a, shapes_b, j, b, start) > DEPTH:
        return start
    stride = FIRST_STRIDE
    low = start
    while low < horizon:
        high = min(start + stride, horizon)
        if depth_at(shapes_a, i, a, shapes_b, j, b, high) > DEPTH:
            for _ in range(60):
                t = 0.5 * (low + high)
                if depth_at(shapes_a, i, a, shapes_b, j, b, t) > DEPTH:
                    high = t
                else:
                    low = t
            return high
        low = high
        stride *= 2.0
    return np.inf


@compiled
def stay_step(
    look: Look,
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    level: float,
) -> float:
    """Return a time [s] for which two parts surely stay within ``level`` along all normals."""
    one = faces_last(P, p0, p1, Q, q0, q1, look.seen, level)
    two = faces_last(Q, q0, q1, P, p0, p1, turned(look.seen, a.radius), level)
    speed = a.speed + b.speed + abs(a.spin) * a.radius + abs(b.spin) * b.radius
    plain = np.inf if speed == 0.0 else (level - look.distance) / speed
    if p1 - p0 <= 2 and q1 - q0 <= 2:
        # Their normals do not decide.
        return plain
    return max(plain, min(one, two))


@compiled
def leave_time(
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    start: float,
    horizon: float,
) -> tuple[float, int]:
    """Return (time [s] at which two parts that touch at ``start`` come apart, advances).

    Until then they are within 2 CONTACT along all normals; at it they are 0.5 to 2 CONTACT apart,
    or it is the horizon.
    """
    t = start
    inside = False
    for step in range(MOST_STEPS):
        look = look_at(P, p0, p1, a, Q, q0, q1, b, t)
        inside = inside or look.distance <= 0.25 * CONTACT
        apart = 0.5 * CONTACT if inside else CONTACT
        if look.distance > apart:
            return t, step
        t += stay_step(look, P, p0, p1, a, Q, q0, q1, b, 2.0 * apart)
        if not t < horizon:
            return horizon, step + 1
    return t, MOST_STEPS


@compiled
def next_encounter(
    P: FloatArray,
    p0: int,
    p1: int,
    a: Course,
    Q: FloatArray,
    q0: int,
    q1: int,
    b: Course,
    start: float,
    horizon: float,
) -> Encounter:
    """First contact of two parts from ``start`` on and its end; ``start`` 0, or the last exit."""
    if moves_straight(a, b):
        if start > 0.0:
            return np.inf, np.inf, 0
        entry = part_time(P, p0, p1, a, Q, q0, q1, b, horizon)
        if entry == np.inf:
            return np.inf, np.inf, 0
        first, last, _, _ = straight_times(P, p0, p1, a, Q, q0, q1, b, horizon)
        leave = max(entry, last) if first <= last else entry
        return entry, min(leave, horizon), 0
    if start == 0.0:
        entry, d, steps = advancement_time(P, p0, p1, a, Q, q0, q1, b, horizon)
    else:
        entry, d, steps = fall_time(
            P, p0, p1, a, Q, q0, q1, b, 0.0, 0.25 * CONTACT, start, horizon
        )  # fmt: skip
    if entry == np.inf:
        return np.inf, np.inf, steps
    if steps >= MOST_STEPS and d > CONTACT:
        return entry, entry, MOST_STEPS
    leave, more = leave_time(P, p0, p1, a, Q, q0, q1, b, entry, horizon)
    return entry, leave, max(steps, more)
