"""Collision avoidance: shortest distance and collision time (11), and the rules (12) and (13).

Departures from the paper: (12) uses the signed distance, so that touching robots still have a best
way out; the boundaries count in (12) when the footprint is within L of one, in (13) always; in (11)
they count within the sensing range only, so that a robot on its way into one beyond reports no
collision time; ties, two infinities included, are settled by (5). A collision time beyond
``horizon`` counts as infinite: under a short one (ten_robots: 4.5 s) all commands that are safe
that long are equal in (13), and (5) decides among them.

A car that stands cannot turn, so standing, which (13) likes best, might hold it for ever. To it all
commands that are safe for ``time_high`` are equal, and standing is as good as one that is safe for
``time_low``: rather than stand it backs, or goes on, where that is safe.

Pairs whose discs are farther apart than the smallest value found are left out, and so are
candidates that have lost. No choice depends on it.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.bodies import BOUND_MARGIN, body_gap, frame_from
from physim.geometry.collision import bodies_time, never_meet
from physim.geometry.motion import Course, facing_course, move
from physim.geometry.shapes import FloatArray, IntArray, Rows3
from physim.geometry.walls import Sight, seen_distance, seen_time
from physim.tolerances import TIE

from .path_following import Aim, Judgement, SpeedPairs, comes_first, judged_pair
from .priority import Bodies


class NearField(NamedTuple):
    """What one decision of the robot of row ``me`` looks at."""

    me: int
    """its row of `Bodies`"""
    rows: IntArray
    """(n,) rows of `Bodies` that it considers"""
    size: int
    """n"""
    sight: Sight
    """the walls"""
    keep: float
    """1.0; 0.0 where collision times assume that nobody turns"""


@compiled
def course_under(bodies: Bodies, row: int, v: float, omega: float) -> Course:
    """Course of a row of ``bodies`` under the command (v, omega)."""
    pose, facing = bodies.pose, bodies.facing
    radius = bodies.shapes.radius[bodies.number[row]]
    return facing_course(
        pose[row, 0], pose[row, 1], facing[row, 0], facing[row, 1], v, omega, 0.0, radius
    )


@compiled
def discs_apart(pose: FloatArray, there: FloatArray, reach: float) -> float:
    """Lower bound [m] of the distance of two bodies at poses, which reach that far together."""
    dx, dy = there[0] - pose[0], there[1] - pose[1]
    return sqrt(dx * dx + dy * dy) - reach - BOUND_MARGIN


@compiled
def distance_to(
    bodies: Bodies, me: int, pose: FloatArray, c: float, s: float, j: int, there: FloatArray,
    enough: float,
) -> float:  # fmt: skip
    """Signed distance (11) [m] of row ``me`` at ``pose`` and row j at ``there``.

    (c, s) are cosine and sine of the heading of ``pose``. Exact where it is below ``enough``;
    otherwise some number from ``enough`` up to it.
    """
    shapes, number = bodies.shapes, bodies.number
    return body_gap(shapes, number[me], shapes, number[j], frame_from(pose, c, s, there), enough)


@compiled
def smallest_distance(bodies: Bodies, near: NearField) -> float:
    """Smallest d_ij [m] by (11) to the considered robots, signed; inf without any."""
    me, pose, radius, number = near.me, bodies.pose, bodies.shapes.radius, bodies.number
    c, s, mine = bodies.facing[me, 0], bodies.facing[me, 1], radius[number[me]]
    x, y, smallest, least, first = pose[me, 0], pose[me, 1], np.inf, np.inf, -1
    for k in range(near.size):
        dx, dy = pose[near.rows[k], 0] - x, pose[near.rows[k], 1] - y
        if dx * dx + dy * dy < least:
            least, first = dx * dx + dy * dy, near.rows[k]
    if first >= 0:  # of the others few need be measured then
        smallest = distance_to(bodies, me, pose[me], c, s, first, pose[first], smallest)  # (11)
    for k in range(near.size):
        j = near.rows[k]
        dx, dy = pose[j, 0] - x, pose[j, 1] - y
        room = smallest + mine + radius[number[j]] + BOUND_MARGIN
        if j != first and room > 0.0 and dx * dx + dy * dy < room * room:
            d = distance_to(bodies, me, pose[me], c, s, j, pose[j], smallest)  # (11)
            smallest = min(smallest, d)
    return smallest


@compiled
def first_robot(
    bodies: Bodies, near: NearField, mine: Course, horizon: float, enough: float
) -> float:
    """Smallest xi [s] by (11) of the considered robots, the robot being on course ``mine``.

    ``enough`` is that of `smallest_time`.
    """
    shapes, number, twist = bodies.shapes, bodies.number, bodies.twist
    pose, facing, radius = bodies.pose, bodies.facing, shapes.radius
    smallest = np.inf
    for k in range(near.size):
        j = near.rows[k]
        theirs = facing_course(
            pose[j, 0], pose[j, 1], facing[j, 0], facing[j, 1],
            twist[j, 0], near.keep * twist[j, 1], twist[j, 2], radius[number[j]],
        )  # fmt: skip
        until = min(smallest, horizon)
        if never_meet(mine, theirs, until):
            continue
        xi = bodies_time(shapes, number[near.me], mine, shapes, number[j], theirs, until)  # (11)
        smallest = min(smallest, xi)
        if smallest < enough:
            break
    return smallest


@compiled
def smallest_time(
    bodies: Bodies, near: NearField, pair: FloatArray, horizon: float, enough: float
) -> float:
    """Smallest xi [s] by (11) under the speed pair ``pair``; inf when none.

    The others keep their twists. As soon as it is certain that the value is below
    ``enough``, some number from the value up to below ``enough`` is returned: the caller has no
    use for it.
    """
    mine = course_under(bodies, near.me, pair[0], near.keep * pair[1])
    smallest = first_robot(bodies, near, mine, horizon, enough)
    if smallest < enough:
        return smallest
    until = min(smallest, horizon)
    return min(smallest, seen_time(bodies.shapes, bodies.number[near.me], mine, near.sight, until))


@compiled
def distance_after(
    bodies: Bodies,
    near: NearField,
    walls_count: bool,
    pair: FloatArray,
    period: float,
    poses: Rows3,
    enough: float,
) -> float:
    """Smallest distance [m] after ``period`` under the speed pair ``pair``.

    ``poses`` (n + 1, 3) of the considered robots then; those not yet known are NaN, and are filled
    in. The last row is for the robot's own. As soon as the value is below ``enough`` the rest is
    left out.
    """
    me, pose, twist, end = near.me, bodies.pose, bodies.twist, poses[near.size]
    radius, number = bodies.shapes.radius, bodies.number
    move(pose[me], pair[0], pair[1], 0.0, period, end)
    c, s, mine = cos(end[2]), sin(end[2]), radius[number[me]]
    smallest = np.inf
    for k in range(near.size):
        j = near.rows[k]
        if np.isnan(poses[k, 0]):
            move(pose[j], twist[j, 0], twist[j, 1], twist[j, 2], period, poses[k])
        if discs_apart(end, poses[k], mine + radius[number[j]]) < smallest:
            d = distance_to(bodies, me, end, c, s, j, poses[k], smallest)  # (11)
            smallest = min(smallest, d)
            if smallest < enough:
                return smallest
    if walls_count:
        gap = seen_distance(bodies.shapes, bodies.number[me], end, near.sight)
        smallest = min(smallest, gap)
    return smallest


@compiled
def widest_pair(
    bodies: Bodies,
    near: NearField,
    pairs: SpeedPairs,
    walls_count: bool,
    period: float,
    aim: Aim,
) -> int:
    """Index of the speed pair with the largest smallest distance after ``period`` (12).

    Other robots keep their twists. ``walls_count``: whether the boundaries do.
    """
    poses = np.full((near.size + 1, 3), np.nan)
    pose, best, widest = bodies.pose[near.me], 0, -np.inf
    best_value = Judgement(np.inf, np.inf, np.inf)
    for c in range(pairs.size):
        enough = widest - TIE
        width = distance_after(bodies, near, walls_count, pairs.each[c], period, poses, enough)
        if width < enough:
            continue
        value = judged_pair(pose, pairs.each[c:], period, aim)
        if width > widest + TIE or comes_first(value, best_value):  # (12)
            best, widest, best_value = c, width, value
    return best


@compiled
def longest_pair(
    bodies: Bodies,
    near: NearField,
    pairs: SpeedPairs,
    known: FloatArray,
    known_time: float,
    horizon: float,
    period: float,
    aim: Aim,
    stand: float,
    most: float,
) -> tuple[int, float]:
    """Index of the speed pair with the largest smallest collision time (13), and that time.

    ``known_time`` is that of the speed pair ``known``, which may be one of ``pairs``. Times beyond
    ``most`` count as that, and those of standing as no more than ``stand`` [s].
    """
    pose, best, longest = bodies.pose[near.me], 0, -np.inf
    best_value = Judgement(np.inf, np.inf, np.inf)
    for c in range(pairs.size):
        enough = longest - TIE
        xi = known_time
        if pairs.each[c, 0] != known[0] or pairs.each[c, 1] != known[1]:
            xi = smallest_time(bodies, near, pairs.each[c], horizon, enough)
        xi = min(xi, most if pairs.each[c, 0] != 0.0 else stand)
        if xi < enough:
            continue
        value = judged_pair(pose, pairs.each[c:], period, aim)
        if xi > longest + TIE or comes_first(value, best_value):  # (13)
            best, longest, best_value = c, xi, value
    return best, longest
