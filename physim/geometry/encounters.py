"""Collision times with their bounds, and all contacts within a horizon, for use from Python."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from physim.errors import PhysimError
from physim.geometry.advancement import MOST_STEPS
from physim.geometry.certified import certified_start, next_encounter, overlap_after
from physim.geometry.collision import never_meet
from physim.geometry.inputs import ShapeLike, bodies_of, horizon_of
from physim.geometry.motion import Course
from physim.geometry.shapes import FloatArray, Shapes
from physim.tolerances import CONTACT


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
