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
from physim.geometry.separation import body_gap, point_gap
from physim.geometry.shapes import FloatArray, IntArray, Shapes, part_bodies
from physim.geometry.wall_grid import WallGrid, WallLists, empty_lists, nearest_part

MARGIN = 1e-9
"""[m] Bounds must win by this, so that their rounding cannot matter."""


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


class BoundingDiscs(NamedTuple):
    """A point of each robot's shape, in its frame, with discs about it inside and around."""

    x: FloatArray
    y: FloatArray
    inner: FloatArray
    outer: FloatArray


def clearances(poses: FloatArray, shapes: Shapes, walls: Shapes, wall_grid: WallGrid) -> Clearances:
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
    lists = empty_lists(robots)
    fill(np.ascontiguousarray(poses), shapes, walls, wall_grid, part_bodies(walls), lists, out)
    return out


@compiled
def fill(
    poses: FloatArray,
    shapes: Shapes,
    walls: Shapes,
    wall_grid: WallGrid,
    part_body: IntArray,
    lists: WallLists,
    out: Clearances,
) -> None:
    """Write `clearances` into ``out``; ``part_body`` (P,) names the body of each wall part.

    ``lists`` are empty ones.
    """
    robots = poses.shape[1]
    discs = bounding_discs(shapes)
    order = np.empty(robots, dtype=np.int64)
    for i in range(robots):
        order[i] = i
    frame = np.empty((robots, 6))
    limit = np.empty(robots)
    for b in range(len(poses)):
        pose = poses[b]
        set_frames(pose, discs, frame)
        nearest_others(shapes, discs, frame, order, limit, out.clearance[b], out.other[b])
        out.farthest[b], out.farthest_a[b], out.farthest_b[b] = farthest_pair(shapes, discs, frame)
        for i in range(robots):
            gap, part = nearest_part(shapes, i, pose[i], frame[i], walls, wall_grid, lists)
            out.boundary_clearance[b, i] = gap
            out.boundary_other[b, i] = robots + part_body[part] if part >= 0 else -1


@compiled
def bounding_discs(shapes: Shapes) -> BoundingDiscs:
    """Middle of the first part of each robot, and discs about it inside and around the shape."""
    robots = len(shapes.body_start) - 1
    discs = BoundingDiscs(np.empty(robots), np.empty(robots), np.empty(robots), np.empty(robots))
    V = shapes.vertices
    for i in range(robots):
        part = shapes.body_start[i]
        p0 = shapes.part_start[part]
        p1 = shapes.part_start[part + 1]
        x, y = 0.0, 0.0
        for k in range(p0, p1):
            x += V[k, 0]
            y += V[k, 1]
        x /= p1 - p0
        y /= p1 - p0
        discs.x[i], discs.y[i] = x, y
        discs.inner[i], discs.outer[i] = 0.0, 0.0
        if p1 - p0 > 2:
            discs.inner[i] = max(0.0, -point_gap(V, p0, p1, x, y))
        for k in range(p0, shapes.part_start[shapes.body_start[i + 1]]):
            discs.outer[i] = max(discs.outer[i], math.hypot(V[k, 0] - x, V[k, 1] - y))
    return discs


@compiled
def set_frames(pose: FloatArray, discs: BoundingDiscs, frame: FloatArray) -> None:
    """Write x, y, cos, sin of each robot and the middle of its discs, world frame."""
    for i in range(len(pose)):
        c = math.cos(pose[i, 2])
        s = math.sin(pose[i, 2])
        frame[i, 0] = pose[i, 0]
        frame[i, 1] = pose[i, 1]
        frame[i, 2] = c
        frame[i, 3] = s
        frame[i, 4] = pose[i, 0] + (c * discs.x[i] - s * discs.y[i])
        frame[i, 5] = pose[i, 1] + (s * discs.x[i] + c * discs.y[i])


@compiled
def pair_distance(
    vertices: FloatArray,
    part_start: IntArray,
    body_start: IntArray,
    i: int,
    j: int,
    frame: FloatArray,
) -> float:
    """Signed distance [m] of robots i and j; the same whichever comes first."""
    if j < i:
        i, j = j, i
    c = frame[i, 2]
    s = frame[i, 3]
    dx = frame[j, 0] - frame[i, 0]
    dy = frame[j, 1] - frame[i, 1]
    return body_gap(
        vertices, part_start, body_start[i], body_start[i + 1],
        vertices, part_start, body_start[j], body_start[j + 1],
        c * frame[j, 2] + s * frame[j, 3], c * frame[j, 3] - s * frame[j, 2],
        c * dx + s * dy, c * dy - s * dx,
    )  # fmt: skip


@compiled
def sort_by_x(frame: FloatArray, order: IntArray) -> None:
    """Sort robots by the x of their discs; quick when they are nearly sorted already."""
    for a in range(1, len(order)):
        i = order[a]
        k = a
        while k > 0 and frame[order[k - 1], 4] > frame[i, 4]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = i


@compiled
def largest_of(values: FloatArray) -> float:
    """Return the largest value; -inf without any."""
    most = -np.inf
    for value in values:
        most = max(most, value)
    return most


@compiled
def nearest_others(
    shapes: Shapes,
    discs: BoundingDiscs,
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
    V, part_start, body_start = shapes.vertices, shapes.part_start, shapes.body_start
    inner, outer = discs.inner, discs.outer
    gap[:] = np.inf
    other[:] = -1
    limit[:] = np.inf
    sort_by_x(frame, order)
    largest = largest_of(outer)
    for a in range(robots):
        i = order[a]
        for k in range(a + 1, robots):
            j = order[k]
            dx = frame[j, 4] - frame[i, 4]
            if k > a + 1 and dx - largest - outer[i] > limit[i]:
                break
            dy = frame[j, 5] - frame[i, 5]
            most = math.sqrt(dx * dx + dy * dy) - inner[i] - inner[j] + MARGIN
            limit[i] = min(limit[i], most)
            limit[j] = min(limit[j], most)
    widest = largest_of(limit) if robots > 1 else 0.0
    for a in range(robots):
        i = order[a]
        for k in range(a + 1, robots):
            j = order[k]
            dx = frame[j, 4] - frame[i, 4]
            if dx - largest - outer[i] > widest:
                break
            dy = frame[j, 5] - frame[i, 5]
            least = math.sqrt(dx * dx + dy * dy) - outer[i] - outer[j] - MARGIN
            if least <= max(limit[i], limit[j]):
                d = pair_distance(V, part_start, body_start, i, j, frame)
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
def farthest_pair(
    shapes: Shapes, discs: BoundingDiscs, frame: FloatArray
) -> tuple[float, int, int]:
    """Largest distance between the shapes of two robots, and which; (-inf, -1, -1) if none."""
    robots = len(frame)
    V, part_start, body_start = shapes.vertices, shapes.part_start, shapes.body_start
    inner = discs.inner
    best = -np.inf
    first = -1
    second = -1
    # The pair whose discs are farthest apart is a good start: few others can beat it.
    at_a, at_b = farthest_discs(frame)
    if at_b >= 0:
        best = pair_distance(V, part_start, body_start, at_a, at_b, frame)
        first, second = at_a, at_b
    for i in range(robots):
        for j in range(i + 1, robots):
            dx = frame[j, 4] - frame[i, 4]
            dy = frame[j, 5] - frame[i, 5]
            room = best + inner[i] + inner[j] - MARGIN
            if room <= 0.0 or dx * dx + dy * dy >= room * room:
                d = pair_distance(V, part_start, body_start, i, j, frame)
                if d > best or (d == best and (i, j) < (first, second)):
                    best, first, second = d, i, j
    return best, first, second


@compiled
def farthest_discs(frame: FloatArray) -> tuple[int, int]:
    """Return the two robots a < b whose discs are farthest apart; (-1, -1) if there is one."""
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
