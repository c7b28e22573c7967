"""Collision avoidance: shortest distance and collision time (11), and the rules (12) and (13).

Departures from the paper: (12) uses the signed distance, so that touching robots still have a best
way out; the boundaries count in (12) when the footprint is within L of one, in (13) always; in (11)
they count within the sensing range only, so that a robot on its way into one beyond reports no
collision time; ties, two infinities included, are settled by (5). A collision time beyond
``horizon`` counts as infinite: under a short one (ten_robots: 4.5 s) all commands that are safe
that long are equal in (13), and (5) decides among them.

A smallest value is found by looking at few pairs: bounds say which of them can have it, and what
lies behind all bounds is left out. Of a pair that does count the value is that of
`physim.geometry`, whatever was found before. Candidates that have lost are left as soon as that is
certain. So values and choices are those of plain loops over everything, bit for bit.
"""

from __future__ import annotations

from math import cos, hypot, sin

import numpy as np

from physim.compiled import compiled
from physim.geometry.collision import bodies_time, never_near
from physim.geometry.motion import Course, move
from physim.geometry.separation import BOUND_MARGIN, body_gap, frame_from
from physim.geometry.shapes import FloatArray
from physim.geometry.time_bounds import discs_lasting, discs_meet, overlap_time
from physim.geometry.wall_tree import seen_distance, seen_time
from physim.tolerances import TIE

from .near_field import (
    APART,
    BOUND,
    PASS,
    PULL,
    REFINED,
    ROOM,
    SPEED,
    VX,
    VY,
    NearField,
    X,
    Y,
    course_under,
    held_course,
    leeway,
    note_passes,
)
from .path_following import comes_first, judge, single
from .priority import Bodies

ROUNDING = 1e-9
"""[-] A horizon must lie this far beyond the time that it must not cut off: its share, and [s]."""


@compiled
def distance_to(
    bodies: Bodies, me: int, pose: FloatArray, c: float, s: float, j: int, there: FloatArray,
    enough: float,
) -> float:  # fmt: skip
    """Signed distance (11) [m] of row ``me`` at ``pose`` and row j at ``there``.

    (c, s) are cosine and sine of the heading of ``pose``. Exact where it is below ``enough``;
    otherwise some number from ``enough`` up to it.
    """
    shapes, mine, its = bodies.shapes, bodies.shape[me], bodies.shape[j]
    first, start = shapes.body_start, shapes.part_start
    turned_c, turned_s, x, y = frame_from(pose, c, s, there)
    return body_gap(
        shapes.vertices, start, first[mine], first[mine + 1],
        shapes.vertices, start, first[its], first[its + 1], turned_c, turned_s, x, y, enough,
    )  # fmt: skip


@compiled
def smallest_distance(bodies: Bodies, near: NearField) -> float:
    """Smallest d_ij [m] by (11) to the considered robots, signed; inf without any."""
    me, pose = near.me, bodies.pose
    c, s = bodies.facing[me, 0], bodies.facing[me, 1]
    smallest = np.inf
    if near.nearest >= 0:
        j = near.rows[near.nearest]
        smallest = distance_to(bodies, me, pose[me], c, s, j, pose[j], smallest)  # (11)
    for k in range(len(near.rows)):
        if near.table[k, ROOM] < smallest and k != near.nearest:  # the discs are no farther
            j = near.rows[k]
            d = distance_to(bodies, me, pose[me], c, s, j, pose[j], smallest)  # (11)
            smallest = min(smallest, d)
    return smallest


@compiled
def smallest_time(
    bodies: Bodies, near: NearField, pair: FloatArray, horizon: float, enough: float
) -> float:
    """Smallest xi [s] by (11) under the speed pair ``pair``; inf when none.

    The others keep the commands they hold. As soon as it is certain that the value is below
    ``enough``, some number from the value up to below ``enough`` is returned: the caller has no
    use for it.
    """
    mine = course_under(bodies, near.me, pair[0], near.keep * pair[1])
    smallest = first_robot(bodies, near, mine, horizon, enough)
    if smallest < enough:
        return smallest
    body, until = bodies.shape[near.me], beyond(smallest, horizon)
    return min(smallest, seen_time(bodies.shapes, body, mine, near.sight, until))


@compiled
def beyond(smallest: float, horizon: float) -> float:
    """Horizon [s] up to which there may be a time smaller than ``smallest``, and a little more."""
    return min(horizon, smallest + ROUNDING * (1.0 + smallest))


@compiled
def first_robot(
    bodies: Bodies, near: NearField, mine: Course, horizon: float, enough: float
) -> float:
    """Smallest xi [s] by (11) of the considered robots, the robot being on course ``mine``.

    ``enough`` is that of `smallest_time`.
    """
    shapes, shape, table, listed = bodies.shapes, bodies.shape, near.table, near.listed
    body = shape[near.me]
    left = list_dangers(bodies, near, mine, horizon)
    smallest = np.inf
    while True:
        least, at = smallest, -1
        for m in range(left):
            if table[listed[m], BOUND] < least:
                least, at = table[listed[m], BOUND], m
        if at < 0:
            return smallest
        k = listed[at]
        its = shape[near.rows[k]]
        theirs = held_course(bodies, near, k)
        until = beyond(smallest, horizon)
        if table[k, REFINED] == 0.0:
            table[k, BOUND], table[k, REFINED] = discs_meet(mine, theirs, least, until), 1.0
            continue
        if least < enough:
            sure = min(enough, until)
            xi = overlap_time(shapes, body, mine, shapes, its, theirs, least, sure)
            if xi < enough:
                return xi
        xi = bodies_time(shapes, body, mine, shapes, its, theirs, until)  # (11)
        smallest = min(smallest, xi)
        if smallest < enough:
            return smallest
        left -= 1
        listed[at] = listed[left]


@compiled
def list_dangers(bodies: Bodies, near: NearField, mine: Course, horizon: float) -> int:
    """List in ``near.listed`` which robots may be met up to the horizon, and return how many.

    Each with a time in ``near.table`` before which it is not met.
    """
    table, listed = near.table, near.listed
    pull, reach = mine.speed * abs(mine.turn), leeway(mine)
    count = 0
    for k in range(len(near.rows)):
        if table[k, PASS] > reach:
            continue
        apart, room, pulls = table[k, APART], table[k, ROOM], pull + table[k, PULL]
        closing = table[k, X] * (mine.vx - table[k, VX]) + table[k, Y] * (mine.vy - table[k, VY])
        if pulls == 0.0 and room > 0.0 and room * apart > closing * horizon:
            continue
        if never_near(mine, held_course(bodies, near, k), horizon):
            continue
        bound = discs_lasting(room, closing / apart, pulls) if room > 0.0 else 0.0
        if bound <= horizon:
            table[k, BOUND], table[k, REFINED] = bound, 0.0
            listed[count] = k
            count += 1
    return count


@compiled
def distance_after(
    bodies: Bodies,
    near: NearField,
    walls_count: bool,
    pair: FloatArray,
    period: float,
    poses: FloatArray,
    end: FloatArray,
    enough: float,
) -> float:
    """Smallest distance [m] after ``period`` under the speed pair ``pair``.

    ``poses`` (n, 3) of the considered robots then; those not yet known are NaN, and are filled in.
    ``end`` (3,) receives the robot's own. As soon as the value is below ``enough`` the rest is
    left out.
    """
    me, pose, command, radius = near.me, bodies.pose, bodies.command, bodies.shapes.radius
    move(pose[me], pair[0], pair[1], period, end)
    c, s = cos(end[2]), sin(end[2])
    mine = radius[bodies.shape[me]]
    reach = abs(pair[0]) * period
    smallest = np.inf
    for step in range(-1, len(near.rows)):
        k = near.nearest if step < 0 else step
        if k < 0 or (k == near.nearest and step >= 0):
            continue
        if near.table[k, ROOM] - reach - near.table[k, SPEED] * period >= smallest:
            continue
        j = near.rows[k]
        if np.isnan(poses[k, 0]):
            move(pose[j], command[j, 0], command[j, 1], period, poses[k])
        gap = hypot(poses[k, 0] - end[0], poses[k, 1] - end[1])
        if gap - mine - radius[bodies.shape[j]] - BOUND_MARGIN >= smallest:
            continue
        d = distance_to(bodies, me, end, c, s, j, poses[k], smallest)  # (11)
        smallest = min(smallest, d)
        if smallest < enough:
            return smallest
    if walls_count:
        gap = seen_distance(bodies.shapes, bodies.shape[me], end, near.sight)
        smallest = min(smallest, gap)
    return smallest


@compiled
def widest_pair(
    bodies: Bodies,
    near: NearField,
    pairs: FloatArray,
    walls_count: bool,
    period: float,
    judge_ahead: float,
    tx: float,
    ty: float,
) -> int:
    """Index of the speed pair with the largest smallest distance after ``period`` (12).

    Other robots move on under their held commands. ``walls_count``: whether the boundaries do.
    """
    poses, end = np.full((len(near.rows), 3), np.nan), np.empty(3)
    dwell, pose = single(period), bodies.pose[near.me]
    best, widest, best_value = 0, -np.inf, (np.inf, np.inf, np.inf)
    for c in range(len(pairs)):
        enough = widest - TIE
        width = distance_after(bodies, near, walls_count, pairs[c], period, poses, end, enough)
        if width < enough:
            continue
        value = judge(pose, pairs[c : c + 1], dwell, judge_ahead, tx, ty)
        if width > widest + TIE or comes_first(value, best_value):  # (12)
            best, widest, best_value = c, width, value
    return best


@compiled
def longest_pair(
    bodies: Bodies,
    near: NearField,
    pairs: FloatArray,
    known: FloatArray,
    known_time: float,
    horizon: float,
    period: float,
    judge_ahead: float,
    tx: float,
    ty: float,
) -> tuple[int, float]:
    """Index of the speed pair with the largest smallest collision time (13), and that time.

    ``known_time`` is that of the speed pair ``known``, which may be one of ``pairs``.
    """
    dwell, pose = single(period), bodies.pose[near.me]
    note_passes(bodies, near, horizon)
    # What loses by more than all ties together could move the choice cannot take part in it.
    hopeless = -np.inf
    for c in range(len(pairs)):
        if pairs[c, 0] == known[0] and pairs[c, 1] == known[1]:
            hopeless = known_time - 2.0 * len(pairs) * TIE - ROUNDING
    best, longest, best_value = 0, -np.inf, (np.inf, np.inf, np.inf)
    for c in range(len(pairs)):
        enough = max(longest - TIE, hopeless)
        xi = known_time
        if pairs[c, 0] != known[0] or pairs[c, 1] != known[1]:
            xi = smallest_time(bodies, near, pairs[c], horizon, enough)
        if xi < enough:
            continue
        value = judge(pose, pairs[c : c + 1], dwell, judge_ahead, tx, ty)
        if xi > longest + TIE or comes_first(value, best_value):  # (13)
            best, longest, best_value = c, xi, value
    return best, longest
