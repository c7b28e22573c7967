"""Collision avoidance: shortest distance and collision time (11), and the rules (12) and (13).

Departures from the paper: (12) uses the signed distance, so that touching robots still have a best
way out; the boundaries count in (12) when the footprint is within L of one, in (13) always; ties,
two infinities included, are settled by (5). A collision time beyond ``horizon`` counts as infinite:
under a short one (ten_robots: 4.5 s) all commands that are safe that long are equal in (13), and
(5) decides among them.
"""

from __future__ import annotations

from math import hypot

import numpy as np

from physim.compiled import compiled
from physim.geometry.collision import collision_time_pair, collision_time_walls
from physim.geometry.motion import move
from physim.geometry.separation import body_distance, wall_distance
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.tolerances import TIE

from .path_following import comes_first, judge, single
from .priority import Bodies


@compiled
def smallest_distance(
    bodies: Bodies, me: int, pose: FloatArray, rows: IntArray, poses: FloatArray
) -> float:
    """Smallest d_ij [m] by (11) of row ``me`` at ``pose`` to rows ``rows`` at ``poses``, signed.

    ``poses`` (n, 3) of all rows of ``bodies``; only ``rows`` are looked at. inf without any.
    """
    shapes, mine = bodies.shapes, bodies.shape[me]
    smallest = np.inf
    for j in rows:
        its = bodies.shape[j]
        gap = hypot(poses[j, 0] - pose[0], poses[j, 1] - pose[1])
        if gap - shapes.radius[mine] - shapes.radius[its] < smallest:  # the discs are no farther
            d = body_distance(shapes, mine, pose, shapes, its, poses[j])  # (11)
            smallest = min(smallest, d)
    return smallest


@compiled
def smallest_time(
    bodies: Bodies,
    me: int,
    pair: FloatArray,
    rows: IntArray,
    walls: Shapes,
    parts: IntArray,
    horizon: float,
    translation_only: bool,
    enough: float,
) -> float:
    """Smallest xi [s] by (11) of row ``me`` under the speed pair ``pair``; inf when none.

    The others keep the commands they hold. As soon as a value is below ``enough`` the rest is left
    out: the caller has no use for anything smaller.
    """
    shapes, pose, command, body = bodies.shapes, bodies.pose, bodies.command, bodies.shape[me]
    keep = 0.0 if translation_only else 1.0
    smallest = np.inf
    mine = (pair[0], keep * pair[1])
    for j in rows:
        theirs = (command[j, 0], keep * command[j, 1])
        gap = hypot(pose[j, 0] - pose[me, 0], pose[j, 1] - pose[me, 1])
        room = gap - shapes.radius[body] - shapes.radius[bodies.shape[j]]
        closing = abs(mine[0]) + abs(theirs[0])
        if room > 0.0 and room > closing * min(smallest, horizon):
            continue  # even head-on the discs meet later
        xi = collision_time_pair(
            shapes, body, pose[me], mine, bodies.shape[j], pose[j], theirs, horizon
        )  # (11)
        smallest = min(smallest, float(xi))
        if smallest < enough:
            return smallest
    xi = collision_time_walls(shapes, body, pose[me], mine, walls, parts, horizon)
    return min(smallest, float(xi))


@compiled
def widest_pair(
    bodies: Bodies,
    me: int,
    pairs: FloatArray,
    rows: IntArray,
    walls: Shapes,
    parts: IntArray,
    period: float,
    judge_ahead: float,
    tx: float,
    ty: float,
) -> int:
    """Index of the speed pair with the largest smallest distance after ``period`` (12).

    Other robots move on under their held commands. ``parts`` are the wall parts that count.
    """
    shapes, pose, command = bodies.shapes, bodies.pose, bodies.command
    poses = np.empty((len(pose), 3))
    for j in rows:
        move(pose[j], command[j, 0], command[j, 1], period, poses[j])
    dwell = single(period)
    end = np.empty(3)
    best, widest, best_value = 0, -np.inf, (np.inf, np.inf, np.inf)
    for c in range(len(pairs)):
        move(pose[me], pairs[c, 0], pairs[c, 1], period, end)
        width = smallest_distance(bodies, me, end, rows, poses)
        width = min(width, wall_distance(shapes, bodies.shape[me], end, walls, parts))
        if width < widest - TIE:
            continue
        value = judge(pose[me], pairs[c : c + 1], dwell, judge_ahead, tx, ty)
        if width > widest + TIE or comes_first(value, best_value):  # (12)
            best, widest, best_value = c, width, value
    return best


@compiled
def longest_pair(
    bodies: Bodies,
    me: int,
    pairs: FloatArray,
    rows: IntArray,
    walls: Shapes,
    parts: IntArray,
    horizon: float,
    translation_only: bool,
    period: float,
    judge_ahead: float,
    tx: float,
    ty: float,
) -> int:
    """Index of the speed pair with the largest smallest collision time (13)."""
    dwell, pose = single(period), bodies.pose[me]
    best, longest, best_value = 0, -np.inf, (np.inf, np.inf, np.inf)
    for c in range(len(pairs)):
        enough = longest - TIE
        xi = smallest_time(
            bodies, me, pairs[c], rows, walls, parts, horizon, translation_only, enough
        )
        if xi < enough:
            continue
        value = judge(pose, pairs[c : c + 1], dwell, judge_ahead, tx, ty)
        if xi > longest + TIE or comes_first(value, best_value):  # (13)
            best, longest, best_value = c, xi, value
    return best
