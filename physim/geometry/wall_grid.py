"""Walls near a robot: a grid of lists, the parts within range, and the distance to the nearest.

The list of a cell of the grid holds every part that comes within ``reach`` of any point of the
cell, in the order of the walls, so one look-up answers for a whole neighbourhood.

Sample after sample, each robot also keeps a short list of near parts. It holds the parts within
``limit`` of a place, each with a distance that it surely has; both wear off by as much as the
robot moves. So most samples need one or two exact distances. Whatever the lists say, the value
and the part are those that a look at all parts would give.
"""

from __future__ import annotations

import math
from math import floor
from typing import NamedTuple

import numpy as np
import shapely

from physim.compiled import compiled
from physim.geometry.safe_point import point_part
from physim.geometry.separation import point_gap, wall_gap
from physim.geometry.shapes import FloatArray, IntArray, Shapes


class WallGrid(NamedTuple):
    """Grid over the walls: cell c = row * columns + column has ``part[start[c]:start[c + 1]]``."""

    origin_x: float
    origin_y: float
    cell: float
    """[m] side of a cell"""
    columns: int
    rows: int
    start: IntArray
    """(columns * rows + 1,)"""
    part: IntArray
    reach: float
    """[m]"""
    every: IntArray
    """every part, for places outside the grid"""


def build_wall_grid(walls: Shapes, reach: float, cell: float) -> WallGrid:
    """Sort the parts of ``walls`` into a grid of cells of side ``cell`` [m].

    Cells grow where the world is large, so that there are at most about a million of them.
    """
    every = np.arange(len(walls.part_start) - 1, dtype=np.int64)
    low, high = walls.vertices.min(axis=0) - cell, walls.vertices.max(axis=0) + cell
    cell = max(cell, float(np.sqrt(np.prod(high - low) / 1e6)))
    columns, rows = (int(n) for n in np.ceil((high - low) / cell))
    x0 = low[0] + cell * np.arange(columns)
    y0 = low[1] + cell * np.arange(rows)
    boxes = shapely.box(
        np.tile(x0, rows),
        np.repeat(y0, columns),
        np.tile(x0 + cell, rows),
        np.repeat(y0 + cell, columns),
    )
    shapes = [_shape(walls, int(part)) for part in every]
    # a hair wider than reach: rounding must not drop a part that just comes within it
    near = shapely.STRtree(shapes).query(boxes, predicate="dwithin", distance=reach * (1.0 + 1e-9))
    order = np.lexsort((near[1], near[0]))
    counts = np.bincount(near[0], minlength=columns * rows)
    start = np.concatenate(([0], np.cumsum(counts))).astype(np.int64)
    part = np.ascontiguousarray(near[1][order], dtype=np.int64)
    return WallGrid(float(low[0]), float(low[1]), cell, columns, rows, start, part, reach, every)


@compiled
def parts_near(wall_grid: WallGrid, x: float, y: float) -> IntArray:
    """Parts that may be within ``reach`` of a place, increasing; all of them outside the grid."""
    column = floor((x - wall_grid.origin_x) / wall_grid.cell)
    row = floor((y - wall_grid.origin_y) / wall_grid.cell)
    if column < 0 or row < 0 or column >= wall_grid.columns or row >= wall_grid.rows:
        return wall_grid.every
    c = row * wall_grid.columns + column
    return wall_grid.part[wall_grid.start[c] : wall_grid.start[c + 1]]


def _shape(walls: Shapes, part: int) -> shapely.Geometry:
    corners: FloatArray = walls.vertices[walls.part_start[part] : walls.part_start[part + 1]]
    return shapely.LineString(corners) if len(corners) == 2 else shapely.Polygon(corners)


@compiled
def parts_in_range(walls: Shapes, parts: IntArray, x: float, y: float, reach: float) -> IntArray:
    """Those of ``parts`` that come within ``reach`` [m] of a point, in the same order."""
    found = np.empty(len(parts), dtype=np.int64)
    count = 0
    for part in parts:
        if point_part(walls, part, x, y) <= reach:
            found[count] = part
            count += 1
    return found[:count]


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
    wall_grid: WallGrid,
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
