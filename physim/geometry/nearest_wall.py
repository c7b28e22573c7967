"""The nearest wall part of a robot, sample after sample.

Each robot keeps a short list of near parts. It holds the parts within ``limit`` of a place, each
with a distance that it surely has; both wear off by as much as the robot moves. What is listed is
measured only where no bound says that it is farther than the nearest, so most samples need one or
two exact distances. Whatever the lists say, the value and the part are those that a look at all
parts would give.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.convex import part_gap
from physim.geometry.robot_frames import MARGIN, extent
from physim.geometry.separation import point_gap, wall_gap
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.geometry.wall_grid import WallGrid, parts_near

LIST_SLACK = 1.0
"""[m] How far about a robot may go until its list is made anew."""

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
def nearest_parts(
    shapes: Shapes,
    pose: FloatArray,
    frame: FloatArray,
    walls: Shapes,
    wall_grid: WallGrid,
    lists: WallLists,
    gap: FloatArray,
    nearest: IntArray,
) -> None:
    """Write each robot's signed distance [m] from the walls, and the nearest part.

    Of equally near parts it is the lowest; (inf, -1) when there are no walls. ``pose`` (N, 3);
    ``frame`` (N, 6) begins with x, y, cos, sin of each robot.
    """
    # Arrays one by one: handing tuples of them on costs more than what is done with them.
    W, w_start = walls.vertices, walls.part_start
    Q, q_start, body_start = shapes.vertices, shapes.part_start, shapes.body_start
    before, travel, limit = lists.pose, lists.travel, lists.limit
    for i in range(len(pose)):
        radius = shapes.radius[i]
        if limit[i] > 0.0:
            travel[i] += math.hypot(pose[i, 0] - before[i, 0], pose[i, 1] - before[i, 1])
            travel[i] += radius * abs(pose[i, 2] - before[i, 2])
            before[i, 0], before[i, 1], before[i, 2] = pose[i, 0], pose[i, 1], pose[i, 2]
            gap[i], nearest[i] = nearest_listed(
                W, w_start, Q, q_start, body_start[i], body_start[i + 1], i, frame,
                lists.part, lists.least, lists.length[i], lists.nearest[i], travel[i],
            )  # fmt: skip
        if not (limit[i] > 0.0 and gap[i] < limit[i] - travel[i] - radius - MARGIN):
            gap[i], nearest[i] = search(shapes, i, pose[i], frame, walls, wall_grid, lists)
        lists.nearest[i] = nearest[i]


@compiled
def nearest_listed(
    W: FloatArray,
    w_start: IntArray,
    Q: FloatArray,
    q_start: IntArray,
    first: int,
    last: int,
    i: int,
    frame: FloatArray,
    listed: IntArray,
    least: FloatArray,
    length: int,
    nearest: int,
    travel: float,
) -> tuple[float, int]:
    """Nearest part of the list of robot i; keeps what it learns of each part's distance."""
    x, y, c, s = frame[i, 0], frame[i, 1], frame[i, 2], frame[i, 3]
    best = exact_gap(W, w_start, nearest, Q, q_start, first, last, x, y, c, s, np.inf)
    for k in range(length):
        part = listed[i, k]
        if least[i, k] > best + travel + MARGIN or part == nearest:
            continue
        gap = segment_bound(
            W, w_start[part], w_start[part + 1], Q, q_start[first], q_start[last], c, s, x, y
        )
        if gap <= best:
            # A hair more than the best, so that a part just as near gives its exact distance.
            enough = np.nextafter(best, np.inf)
            gap = exact_gap(W, w_start, part, Q, q_start, first, last, x, y, c, s, enough)
            if gap < best or (gap == best and part < nearest):
                best = gap
                nearest = part
        least[i, k] = gap + travel
    return best, nearest


@compiled
def exact_gap(
    W: FloatArray,
    w_start: IntArray,
    part: int,
    Q: FloatArray,
    q_start: IntArray,
    first: int,
    last: int,
    x: float,
    y: float,
    c: float,
    s: float,
    enough: float,
) -> float:
    """Signed distance [m] of a wall part and a body at (x, y), as `wall_gap` gives it.

    Exact where it is below ``enough``; otherwise some number from ``enough`` up to it.
    """
    best = np.inf
    for q in range(first, last):
        gap = part_gap(
            W, w_start[part], w_start[part + 1], Q, q_start[q], q_start[q + 1],
            c, s, x, y, 0.0, 0.0, min(best, enough),
        )  # fmt: skip
        best = min(best, gap)
    return best


@compiled
def search(
    shapes: Shapes,
    i: int,
    pose: FloatArray,
    frame: FloatArray,
    walls: Shapes,
    wall_grid: WallGrid,
    lists: WallLists,
) -> tuple[float, int]:
    """Nearest of all parts to robot i; makes its list anew."""
    radius = shapes.radius[i]
    start = lists.nearest[i]
    some = parts_near(wall_grid, pose[0], pose[1])
    within = wall_grid.reach
    gap, part = nearest_of(shapes, i, frame[i], walls, some, start)
    if len(some) == len(wall_grid.every):
        within = np.inf
    elif not gap < within - radius - MARGIN:
        some = wall_grid.every
        within = np.inf
        gap, part = nearest_of(shapes, i, frame[i], walls, some, part)
    if part >= 0:
        limit = min(within, max(gap, 0.0) + radius + LIST_SLACK)
        make_list(i, pose, radius, limit, walls, some, lists)
    return gap, part


@compiled
def segment_bound(
    W: FloatArray,
    w0: int,
    w1: int,
    Q: FloatArray,
    v0: int,
    v1: int,
    c: float,
    s: float,
    x: float,
    y: float,
) -> float:
    """Lower bound [m] of the distance of wall ``W[w0:w1]`` from vertices v0 to v1 - 1 at (x, y).

    It is the gap along the line from (x, y) to the nearest point of the wall; -inf where the wall
    is not a segment, or no such line is known.
    """
    if w1 - w0 != 2:
        return -np.inf
    ex = W[w0 + 1, 0] - W[w0, 0]
    ey = W[w0 + 1, 1] - W[w0, 1]
    dx = W[w0, 0] - x
    dy = W[w0, 1] - y
    size = ex * ex + ey * ey
    if size > 0.0:
        share = min(1.0, max(0.0, -(ex * dx + ey * dy) / size))
        dx += share * ex
        dy += share * ey
    length = math.sqrt(dx * dx + dy * dy)
    if length < MARGIN:
        return -np.inf
    return length - extent(Q, v0, v1, c, s, dx / length, dy / length) - MARGIN


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
    lists.pose[i, 0], lists.pose[i, 1], lists.pose[i, 2] = pose[0], pose[1], pose[2]
    lists.travel[i] = 0.0
    lists.limit[i] = limit
