"""Distance to the nearest wall, sample after sample, with a short list of near parts per robot.

A list holds the parts within ``limit`` of a place, each with a distance that it surely has; both
wear off by as much as the robot moves. So most samples need one or two exact distances. Whatever
the lists say, the value and the part are those that a look at all parts would give.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.nearby import Nearby, parts_near
from physim.geometry.separation import point_gap, wall_gap
from physim.geometry.shapes import FloatArray, IntArray, Shapes

MARGIN = 1e-9
"""[m] Bounds must win by this, so that their rounding cannot matter."""

LIST_SLACK = 0.5
"""[m] How far about a robot may go until its list is made anew."""

LEARN = 0.2
"""[m] A part is measured exactly up to this much beyond the nearest."""

LIST_SIZE = 64
"""Parts in a list; where more are near, there is no list."""


class WallLists(NamedTuple):
    """One list per robot."""

    pose: FloatArray
    """(N, 3) at the sample before"""
    travel: FloatArray
    """(N,) [m] no point of the robot went farther since the list was made"""
    limit: FloatArray
    """(N,) [m] parts left out are farther from the robot's place of then; -inf without a list"""
    part: IntArray
    """(N, LIST_SIZE), increasing"""
    least: FloatArray
    """(N, LIST_SIZE) [m] signed distance of a part is at least this less ``travel``"""
    length: IntArray
    """(N,)"""
    nearest: IntArray
    """(N,) part that was nearest at the sample before, -1 at first"""


def empty_lists(robots: int) -> WallLists:
    """No lists yet."""
    return WallLists(
        np.zeros((robots, 3)),
        np.zeros(robots),
        np.full(robots, -np.inf),
        np.zeros((robots, LIST_SIZE), dtype=np.int64),
        np.zeros((robots, LIST_SIZE)),
        np.zeros(robots, dtype=np.int64),
        np.full(robots, -1),
    )


@compiled
def keep_pose(pose: FloatArray, out: FloatArray) -> None:
    """Copy a pose (3,)."""
    out[0], out[1], out[2] = pose[0], pose[1], pose[2]


@compiled
def nearest_part(
    shapes: Shapes,
    i: int,
    pose: FloatArray,
    frame: FloatArray,
    walls: Shapes,
    wall_grid: Nearby,
    lists: WallLists,
) -> tuple[float, int]:
    """Signed distance [m] of robot i from the walls, and the nearest part (the lowest of equals).

    ``frame`` holds x, y, cos, sin of the robot. (inf, -1) when there are no walls.
    """
    radius = shapes.radius[i]
    if lists.limit[i] > 0.0:
        before = lists.pose[i]
        lists.travel[i] += math.hypot(pose[0] - before[0], pose[1] - before[1])
        lists.travel[i] += radius * abs(pose[2] - before[2])
        keep_pose(pose, lists.pose[i])
        gap, part = nearest_listed(shapes, i, frame, walls, lists)
        if gap < lists.limit[i] - lists.travel[i] - radius - MARGIN:
            lists.nearest[i] = part
            return gap, part
    start = lists.nearest[i]
    some = parts_near(wall_grid, pose[0], pose[1])
    within = wall_grid.reach
    gap, part = nearest_of(shapes, i, frame, walls, some, start)
    if len(some) == len(wall_grid.every):
        within = np.inf
    elif not gap < within - radius - MARGIN:
        some = wall_grid.every
        within = np.inf
        gap, part = nearest_of(shapes, i, frame, walls, some, part)
    lists.nearest[i] = part
    if part >= 0:
        limit = min(within, max(gap, 0.0) + radius + LIST_SLACK)
        make_list(i, pose, radius, limit, walls, some, lists)
    return gap, part


@compiled
def nearest_listed(
    shapes: Shapes, i: int, frame: FloatArray, walls: Shapes, lists: WallLists
) -> tuple[float, int]:
    """Nearest part of the list of robot i; keeps what it learns of each part's distance."""
    W, w_start = walls.vertices, walls.part_start
    Q, q_start = shapes.vertices, shapes.part_start
    first, last = shapes.body_start[i], shapes.body_start[i + 1]
    radius = shapes.radius[i]
    listed, least = lists.part, lists.least
    x, y, c, s = frame[0], frame[1], frame[2], frame[3]
    nearest = lists.nearest[i]
    travel = lists.travel[i]
    w0, w1 = w_start[nearest], w_start[nearest + 1]
    best = wall_gap(W, w0, w1, Q, q_start, first, last, radius, c, s, x, y, np.inf)
    for k in range(lists.length[i]):
        part = listed[i, k]
        if least[i, k] - travel - MARGIN > best or part == nearest:
            continue
        w0, w1 = w_start[part], w_start[part + 1]
        # Learn more than is needed now, to be left alone with this part for a while.
        enough = best + LEARN
        gap = wall_gap(W, w0, w1, Q, q_start, first, last, radius, c, s, x, y, enough)
        least[i, k] = gap + travel
        if gap < best or (gap == best and part < nearest):
            best = gap
            nearest = part
    return best, nearest


@compiled
def nearest_of(
    shapes: Shapes, i: int, frame: FloatArray, walls: Shapes, some: IntArray, start: int
) -> tuple[float, int]:
    """Nearest of some wall parts (increasing), tried against part ``start`` first (-1: none)."""
    W, w_start = walls.vertices, walls.part_start
    Q, q_start = shapes.vertices, shapes.part_start
    first, last = shapes.body_start[i], shapes.body_start[i + 1]
    radius = shapes.radius[i]
    x, y, c, s = frame[0], frame[1], frame[2], frame[3]
    best = np.inf
    nearest = -1
    if start >= 0:
        w0, w1 = w_start[start], w_start[start + 1]
        best = wall_gap(W, w0, w1, Q, q_start, first, last, radius, c, s, x, y, np.inf)
        nearest = start
    for part in some:
        w0, w1 = w_start[part], w_start[part + 1]
        # A hair more than the best, so that a part just as near gives its exact distance.
        enough = np.nextafter(best, np.inf)
        gap = wall_gap(W, w0, w1, Q, q_start, first, last, radius, c, s, x, y, enough)
        if gap < best or (gap == best and part < nearest):
            best = gap
            nearest = part
    return best, nearest


@compiled
def make_list(
    i: int,
    pose: FloatArray,
    radius: float,
    limit: float,
    walls: Shapes,
    some: IntArray,
    lists: WallLists,
) -> None:
    """List the parts of ``some`` within ``limit`` of robot i, unless they are too many."""
    lists.limit[i] = -np.inf
    count = 0
    for part in some:
        p0 = walls.part_start[part]
        p1 = walls.part_start[part + 1]
        gap = point_gap(walls.vertices, p0, p1, pose[0], pose[1])
        if gap <= limit:
            if count == LIST_SIZE:
                return
            lists.part[i, count] = part
            lists.least[i, count] = gap - radius
            count += 1
    lists.length[i] = count
    keep_pose(pose, lists.pose[i])
    lists.travel[i] = 0.0
    lists.limit[i] = limit
