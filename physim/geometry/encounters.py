"""Collision times with certified bounds, and all contacts within a horizon. No run uses them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from physim.compiled import compiled
from physim.errors import PhysimError
from physim.geometry.advancement import MOST_STEPS, Look, advancement_time, fall_time, look_at
from physim.geometry.collision import never_meet, part_time
from physim.geometry.gap_bounds import faces_last, turned
from physim.geometry.motion import Course, moves_straight, relative_motion
from physim.geometry.queries import ShapeLike, bodies_of, horizon_of
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


@dataclass(frozen=True)
class CertifiedTime:
    """A collision time with bounds of the exact one, all in [s].

    The exact time is the first instant at which the closed shapes have a point in common, inf if
    there is none up to the horizon: lower <= exact <= upper.
    """

    time: float
    """as `collision_time` gives it; inf: none up to the horizon"""
    lower: float
    """at every earlier instant the shapes are apart; finite while ``time`` is inf where they pass
    each other within 1e-9 m"""
    upper: float
    """here they overlap for sure, by more than 1e-11 m; inf where no overlap was found: no
    contact, a graze, or shapes without an inside"""
    capped: bool
    """the advances reached their cap: ``time`` is a lower bound only"""


def collision_time_certified(
    footprint_a: ShapeLike,
    pose_a: ArrayLike,
    twist_a: ArrayLike,
    footprint_b: ShapeLike,
    pose_b: ArrayLike,
    twist_b: ArrayLike,
    horizon: float = 10.0,
) -> CertifiedTime:
    """Return `collision_time` with a lower and an upper bound [s], and whether the cap was hit.

    Arguments, units and errors are those of `collision_time`: footprints (n, 2) [m], or several
    together (a boundary: ``polyline(points)`` with pose (0, 0, 0) and twist (0, 0)), poses (3,),
    twists (v, omega) in the body frame or (vx, vy, omega) in the world frame. Raises `PhysimError`
    for anything else.

    ``time`` errs early by at most what it takes to close 1e-9 m, never late. Where the shapes
    close at 1e-3 m/s or more and overlap, the bounds are within 2e-6 s of each other.
    """
    until = horizon_of(horizon)
    a, course_a, b, course_b = bodies_of(footprint_a, pose_a, twist_a, footprint_b, pose_b, twist_b)
    if never_meet(course_a, course_b, until):
        return CertifiedTime(math.inf, math.inf, math.inf, False)
    pair = (a, 0, course_a, b, 0, course_b)
    time, lower, capped = certified_start(*pair, until)
    upper = math.inf if math.isinf(time) else overlap_after(*pair, time, until)
    return CertifiedTime(time, min(lower, time), upper, capped)


def contact_intervals(
    footprint_a: ShapeLike,
    pose_a: ArrayLike,
    twist_a: ArrayLike,
    footprint_b: ShapeLike,
    pose_b: ArrayLike,
    twist_b: ArrayLike,
    horizon: float = 10.0,
) -> FloatArray:
    """All contacts of two shapes within [0, horizon]: (K, 2) entry and exit times [s], in order.

    Arguments and units are those of `collision_time`; a finite horizon is needed. The first entry
    is the collision time; 0: they touch now. An exit at the horizon means that they still touch
    then. In between they touch all the time; a graze is an interval with (nearly) no length. Two
    contacts between which the shapes part by no more than 1e-9 m are one.

    Outside the intervals the shapes are apart. Entries err early and exits late, by at most the
    time it takes to close or to part by 1e-9 m; a pass within 1e-9 m may count either way.
    Raises `PhysimError` for bad input, and where one contact cannot be settled within the cap of
    advances, rather than leaving out what may come later.
    """
    until = horizon_of(horizon)
    if math.isinf(until):
        raise PhysimError("horizon: inf given; all contacts up to a finite time can be listed")
    a, course_a, b, course_b = bodies_of(footprint_a, pose_a, twist_a, footprint_b, pose_b, twist_b)
    if never_meet(course_a, course_b, until):
        return np.zeros((0, 2))
    found: list[tuple[float, float]] = []
    for p in range(len(a.part_start) - 1):
        for q in range(len(b.part_start) - 1):
            found += _part_intervals(a, p, course_a, b, q, course_b, until)
    speed = sum(c.speed + abs(c.spin) * c.radius for c in (course_a, course_b))
    return _joined(sorted(found), 2.0 * CONTACT / speed if speed > 0.0 else 0.0)


def _part_intervals(
    a: Shapes, p: int, course_a: Course, b: Shapes, q: int, course_b: Course, horizon: float
) -> list[tuple[float, float]]:
    part_a = (a.vertices, int(a.part_start[p]), int(a.part_start[p + 1]))
    part_b = (b.vertices, int(b.part_start[q]), int(b.part_start[q + 1]))
    found: list[tuple[float, float]] = []
    at = 0.0
    while at < horizon or not found:
        entry, leave, steps = next_encounter(*part_a, course_a, *part_b, course_b, at, horizon)
        if steps >= MOST_STEPS:
            raise PhysimError(
                f"contact_intervals: not settled after {MOST_STEPS} advances at {leave:.6g} s; "
                "choose a shorter horizon"
            )
        if math.isinf(entry):
            break
        found.append((entry, leave))
        # A graze at 0 must not be taken for the start.
        at = max(leave, 5e-324)
    return found


def _joined(found: list[tuple[float, float]], pause: float) -> FloatArray:
    """Sorted intervals as (K, 2), those joined that are no more than ``pause`` apart."""
    rows: list[list[float]] = []
    for entry, leave in found:
        if rows and entry <= rows[-1][1] + pause:
            rows[-1][1] = max(rows[-1][1], leave)
        else:
            rows.append([entry, leave])
    return np.array(rows, dtype=np.float64).reshape(-1, 2)
