"""Smallest distances and collision times (11), and choices by (12) and (13), by plain loops.

Every pair is worked out by the functions of `physim.geometry` for one pair, and nothing is left
out: no bound, no order, nothing known from before. The controller must agree bit for bit.
"""

from __future__ import annotations

import math

import numpy as np

from physim.tolerances import TIE
from tests.helpers import inside

comes_first, judge = inside("physim.controllers", "comes_first", "judge")
collision_time_pair = inside("physim.geometry", "collision_time_pair")
collision_time_walls, arc = inside("physim.geometry", "collision_time_walls", "arc")
body_distance, wall_distance = inside("physim.geometry", "body_distance", "wall_distance")


def smallest_distance(bodies, me, pose, rows, poses):
    """Smallest signed distance [m] of row ``me`` at ``pose`` to ``rows`` at ``poses``."""
    shapes, shape = bodies.shapes, bodies.shape
    return min(
        (body_distance(shapes, shape[me], pose, shapes, shape[j], poses[j]) for j in rows),
        default=math.inf,
    )


def boundary_distance(bodies, me, pose, walls, parts):
    """Smallest signed distance [m] of row ``me`` at ``pose`` to wall parts."""
    one = (
        wall_distance(bodies.shapes, bodies.shape[me], pose, walls, np.array([p])) for p in parts
    )
    return min(one, default=math.inf)


def smallest_time(bodies, me, pair, rows, walls, parts, horizon, translation_only):
    """Smallest collision time [s] of row ``me`` under a speed pair with ``rows`` and wall parts."""
    shapes, shape, pose = bodies.shapes, bodies.shape, bodies.pose
    keep = 0.0 if translation_only else 1.0
    mine = (float(pair[0]), keep * float(pair[1]))
    times = [
        collision_time_pair(
            shapes, shape[me], pose[me], mine, shape[j], pose[j],
            (float(bodies.command[j, 0]), keep * float(bodies.command[j, 1])), horizon,
        )
        for j in rows
    ]  # fmt: skip
    for p in parts:
        part = np.array([p])
        times.append(collision_time_walls(shapes, shape[me], pose[me], mine, walls, part, horizon))
    return min(times, default=math.inf)


def first_of_the_best(values, judgements):
    """Index of the largest value, ties settled by (5), looked at one after the other."""
    best, largest, judgement = 0, -math.inf, (math.inf,) * 3
    for c, (value, its) in enumerate(zip(values, judgements, strict=True)):
        if value < largest - TIE:
            continue
        if value > largest + TIE or comes_first(its, judgement):
            best, largest, judgement = c, value, its
    return best


def judgements(pose, pairs, period, judge_ahead, target):
    """What (5) says of each speed pair."""
    return [
        judge(pose, pairs[c : c + 1], np.array([period]), judge_ahead, *target)
        for c in range(len(pairs))
    ]


def moved(pose, command, period):
    """Pose (3,) after ``period`` under a command."""
    return np.array(arc(tuple(pose), float(command[0]), float(command[1]), period))


def widths(bodies, me, pairs, rows, walls, parts, period):
    """Smallest distance [m] after ``period`` under each speed pair."""
    poses = np.array(
        [moved(p, c, period) for p, c in zip(bodies.pose, bodies.command, strict=True)]
    )
    ends = [moved(bodies.pose[me], pair, period) for pair in pairs]
    return [
        min(
            smallest_distance(bodies, me, end, rows, poses),
            boundary_distance(bodies, me, end, walls, parts),
        )
        for end in ends
    ]
