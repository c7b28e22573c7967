"""Clearances of many samples: nearest robot, nearest wall, farthest pair. For monitoring.

Values are exact: discs inside and around the shapes only leave out pairs that cannot win, and the
list of walls near a robot is used only while it provably holds the nearest one. A sample's values
do not depend on the samples before it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.nearby import Nearby, parts
from physim.geometry.separation import body_distance_in, body_part_distance, point_gap
from physim.geometry.shapes import FloatArray, IntArray, Shapes

MARGIN = 1e-9
"""[m] Bounds must win by this, so that their rounding cannot matter."""

LIST_SLACK = 0.5
"""[m] How far a robot may about go until its list of near walls is made anew."""

LIST_SIZE = 64
"""Parts in such a list; where more are near, all that `nearby` names are looked at."""


class Clearances(NamedTuple):
    """Signed distances [m] at B samples of N robots: negative = depth. Bodies by id, -1 = none."""

    clearance: FloatArray
    """(B, N) to the nearest other robot, inf if there is none"""
    other: IntArray
    """(B, N) that robot"""
    boundary_clearance: FloatArray
    """(B, N) to the nearest wall, inf if there is none"""
    boundary_other: IntArray
    """(B, N) body id of that wall: N + its index in ``walls``"""
    farthest: FloatArray
    """(B,) largest distance between the shapes of two robots, -inf if there is one robot only"""
    farthest_a: IntArray
    """(B,) the one robot of that pair, a < b"""
    farthest_b: IntArray
    """(B,)"""


class Cores(NamedTuple):
    """A point inside each robot's shape, its frame, with discs about it inside and around."""

    x: FloatArray
    y: FloatArray
    inner: FloatArray
    outer: FloatArray


class WallLists(NamedTuple):
    """Parts within ``limit`` of a place, per robot: good while the robot is near that place."""

    place: FloatArray
    """(N, 2)"""
    limit: FloatArray
    """(N,) [m], -inf where there is no list"""
    part: IntArray
    """(N, LIST_SIZE), increasing"""
    count: IntArray
    nearest: IntArray
    """(N,) part that was nearest last time, -1 at first"""


def clearances(poses: FloatArray, shapes: Shapes, walls: Shapes, nearby: Nearby) -> Clearances:
    """Work out the clearances of poses (B, N, 3) of the N robots in ``shapes``."""
    samples, robots = poses.shape[:2]
    out = Clearances(
        np.empty((samples, robots)),
        np.empty((samples, robots), dtype=np.int64),
        np.empty((samples, robots)),
        np.empty((samples, robots), dtype=np.int64),
        np.empty(samples),
        np.empty(samples, dtype=np.int64),
        np.empty(samples, dtype=np.int64),
    )
    part_body = np.repeat(
        np.arange(len(walls.body_start) - 1, dtype=np.int64), np.diff(walls.body_start)
    )
    fill(np.ascontiguousarray(poses), shapes, walls, nearby, part_body, out)
    return out


@compiled
def fill(
    poses: FloatArray,
    shapes: Shapes,
    walls: Shapes,
    nearby: Nearby,
    part_body: IntArray,
    out: Clearances,
) -> None:
    """Write `clearances` into ``out``; ``part_body`` (P,) names the body of each wall part."""
    robots = poses.shape[1]
    cores = find_cores(shapes)
    lists = WallLists(
        np.zeros((robots, 2)),
        np.full(robots, -np.inf),
        np.zeros((robots, LIST_SIZE), dtype=np.int64),
        np.zeros(robots, dtype=np.int64),
        np.full(robots, -1),
    )
    order = np.arange(robots)
    frame = np.empty((robots, 6))
    limit = np.empty(robots)
    for b in range(len(poses)):
        pose = poses[b]
        set_frames(pose, cores, frame)
        nearest_others(shapes, cores, frame, order, limit, out.clearance[b], out.other[b])
        out.farthest[b], out.farthest_a[b], out.farthest_b[b] = farthest_pair(shapes, cores, frame)
        for i in range(robots):
            gap, part = nearest_part(shapes, i, frame, walls, nearby, lists)
            out.boundary_clearance[b, i] = gap
            out.boundary_other[b, i] = robots + part_body[part] if part >= 0 else -1


@compiled
def find_cores(shapes: Shapes) -> Cores:
    """Middle of the first part of each robot, and discs about it inside and around the shape."""
    robots = len(shapes.body_start) - 1
    cores = Cores(np.zeros(robots), np.zeros(robots), np.zeros(robots), np.zeros(robots))
    V = shapes.vertices
    for i in range(robots):
        part = shapes.body_start[i]
        p0 = shapes.part_start[part]
        p1 = shapes.part_start[part + 1]
        x = V[p0:p1, 0].mean()
        y = V[p0:p1, 1].mean()
        cores.x[i] = x
        cores.y[i] = y
        if p1 - p0 > 2:
            cores.inner[i] = max(0.0, -point_gap(V, p0, p1, x, y))
        for k in range(p0, shapes.part_start[shapes.body_start[i + 1]]):
            cores.outer[i] = max(cores.outer[i], math.hypot(V[k, 0] - x, V[k, 1] - y))
    return cores


@compiled
def set_frames(pose: FloatArray, cores: Cores, frame: FloatArray) -> None:
    """Write x, y, cos, sin of each robot and the place of its core, world frame."""
    for i in range(len(pose)):
        c = math.cos(pose[i, 2])
        s = math.sin(pose[i, 2])
        frame[i, 0] = pose[i, 0]
        frame[i, 1] = pose[i, 1]
        frame[i, 2] = c
        frame[i, 3] = s
        frame[i, 4] = pose[i, 0] + (c * cores.x[i] - s * cores.y[i])
        frame[i, 5] = pose[i, 1] + (s * cores.x[i] + c * cores.y[i])


@compiled
def pair_distance(shapes: Shapes, i: int, j: int, frame: FloatArray) -> float:
    """Signed distance [m] of robots i and j; the same whichever comes first."""
    if j < i:
        i, j = j, i
    c = frame[i, 2]
    s = frame[i, 3]
    dx = frame[j, 0] - frame[i, 0]
    dy = frame[j, 1] - frame[i, 1]
    return body_distance_in(
        shapes,
        i,
        shapes,
        j,
        c * frame[j, 2] + s * frame[j, 3],
        c * frame[j, 3] - s * frame[j, 2],
        c * dx + s * dy,
        c * dy - s * dx,
    )


@compiled
def sort_by_x(frame: FloatArray, order: IntArray) -> None:
    """Sort robots by the x of their cores; quick when they are nearly sorted already."""
    for a in range(1, len(order)):
        i = order[a]
        k = a
        while k > 0 and frame[order[k - 1], 4] > frame[i, 4]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = i


@compiled
def nearest_others(
    shapes: Shapes,
    cores: Cores,
    frame: FloatArray,
    order: IntArray,
    limit: FloatArray,
    gap: FloatArray,
    other: IntArray,
) -> None:
    """Write the distance to the nearest other robot and its index; of equal ones the lowest.

    ``limit``: a distance that the nearest robot surely does not exceed, from discs inside.
    """
    robots = len(order)
    gap[:] = np.inf
    other[:] = -1
    limit[:] = np.inf
    sort_by_x(frame, order)
    largest = cores.outer.max()
    for a in range(robots):
        i = order[a]
        for k in range(a + 1, robots):
            j = order[k]
            dx = frame[j, 4] - frame[i, 4]
            if k > a + 1 and dx - largest - cores.outer[i] > limit[i]:
                break
            dy = frame[j, 5] - frame[i, 5]
            most = math.sqrt(dx * dx + dy * dy) - cores.inner[i] - cores.inner[j] + MARGIN
            limit[i] = min(limit[i], most)
            limit[j] = min(limit[j], most)
    widest = limit.max() if robots > 1 else 0.0
    for a in range(robots):
        i = order[a]
        for k in range(a + 1, robots):
            j = order[k]
            dx = frame[j, 4] - frame[i, 4]
            if dx - largest - cores.outer[i] > widest:
                break
            dy = frame[j, 5] - frame[i, 5]
            least = math.sqrt(dx * dx + dy * dy) - cores.outer[i] - cores.outer[j] - MARGIN
            if least <= max(limit[i], limit[j]):
                d = pair_distance(shapes, i, j, frame)
                keep_nearest(i, j, d, gap, other, limit)
                keep_nearest(j, i, d, gap, other, limit)


@compiled
def keep_nearest(
    i: int, j: int, d: float, gap: FloatArray, other: IntArray, limit: FloatArray
) -> None:
    """Note that robot j is at distance d from robot i."""
    if d < gap[i] or (d == gap[i] and j < other[i]):
        gap[i] = d
        other[i] = j
        limit[i] = min(limit[i], d)


@compiled
def farthest_pair(shapes: Shapes, cores: Cores, frame: FloatArray) -> tuple[float, int, int]:
    """Largest distance between the shapes of two robots, and which; (-inf, -1, -1) if none."""
    robots = len(frame)
    best = -np.inf
    first = -1
    second = -1
    # The pair whose cores are farthest apart is a good start: few others can beat it.
    at_a, at_b = farthest_cores(frame)
    if at_b >= 0:
        best = pair_distance(shapes, at_a, at_b, frame)
        first, second = at_a, at_b
    for i in range(robots):
        for j in range(i + 1, robots):
            dx = frame[j, 4] - frame[i, 4]
            dy = frame[j, 5] - frame[i, 5]
            room = best + cores.inner[i] + cores.inner[j] - MARGIN
            if room <= 0.0 or dx * dx + dy * dy >= room * room:
                d = pair_distance(shapes, i, j, frame)
                if d > best or (d == best and (i, j) < (first, second)):
                    best, first, second = d, i, j
    return best, first, second


@compiled
def farthest_cores(frame: FloatArray) -> tuple[int, int]:
    """Return the two robots a < b whose cores are farthest apart; (-1, -1) if there is one."""
    most = -1.0
    first = -1
    second = -1
    for i in range(len(frame)):
        for j in range(i + 1, len(frame)):
            dx = frame[j, 4] - frame[i, 4]
            dy = frame[j, 5] - frame[i, 5]
            square = dx * dx + dy * dy
            if square > most:
                most, first, second = square, i, j
    return first, second


@compiled
def nearest_part(
    shapes: Shapes,
    i: int,
    frame: FloatArray,
    walls: Shapes,
    nearby: Nearby,
    lists: WallLists,
) -> tuple[float, int]:
    """Signed distance [m] of robot i from the walls and the nearest part; of equal ones the lowest.

    Looks at the robot's own list first, then at what is near its place, then at all, until the
    parts that were left out are surely farther.
    """
    x = frame[i, 0]
    y = frame[i, 1]
    room = shapes.radius[i] + MARGIN
    start = lists.nearest[i]
    if lists.limit[i] > 0.0:
        moved = math.hypot(x - lists.place[i, 0], y - lists.place[i, 1])
        some = lists.part[i, : lists.count[i]]
        gap, part = nearest_of(shapes, i, frame, walls, some, start)
        if gap < lists.limit[i] - moved - room:
            lists.nearest[i] = part
            return gap, part
    some = parts(nearby, x, y)
    within = nearby.reach
    gap, part = nearest_of(shapes, i, frame, walls, some, start)
    if len(some) == len(nearby.every):
        within = np.inf
    elif not gap < within - room:
        some = nearby.every
        within = np.inf
        gap, part = nearest_of(shapes, i, frame, walls, some, part)
    lists.nearest[i] = part
    limit = min(within, max(gap, 0.0) + room + LIST_SLACK)
    lists.limit[i] = -np.inf
    if part >= 0 and make_list(i, x, y, limit, walls, some, lists):
        lists.limit[i] = limit
    return gap, part


@compiled
def nearest_of(
    shapes: Shapes, i: int, frame: FloatArray, walls: Shapes, some: IntArray, start: int
) -> tuple[float, int]:
    """Nearest of some wall parts (increasing), tried against part ``start`` first (-1: none)."""
    x, y, c, s = frame[i, 0], frame[i, 1], frame[i, 2], frame[i, 3]
    best = np.inf
    nearest = -1
    enough = np.inf
    if start >= 0:
        # Anything up to this value is looked at, so that of equal parts the lowest is found.
        best = body_part_distance(shapes, i, c, s, x, y, walls, start, np.inf)
        nearest = start
        enough = np.nextafter(best, np.inf)
    for part in some:
        gap = body_part_distance(shapes, i, c, s, x, y, walls, part, enough)
        if gap < enough:
            best = gap
            nearest = part
            enough = gap
    return best, nearest


@compiled
def make_list(
    i: int, x: float, y: float, limit: float, walls: Shapes, some: IntArray, lists: WallLists
) -> bool:
    """List the parts of ``some`` within ``limit`` of (x, y); False when they are too many."""
    count = 0
    for part in some:
        p0 = walls.part_start[part]
        p1 = walls.part_start[part + 1]
        if point_gap(walls.vertices, p0, p1, x, y) <= limit:
            if count == LIST_SIZE:
                return False
            lists.part[i, count] = part
            count += 1
    lists.count[i] = count
    lists.place[i, 0] = x
    lists.place[i, 1] = y
    return True
