"""Robots about a robot: the nearest other, the two that are farthest apart, who is within range.

Values and choices are those of a look at all pairs, bit for bit: bounds only leave out pairs that
cannot count.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.bodies import body_gap, point_gap
from physim.geometry.convex import frame_at
from physim.geometry.shapes import FloatArray, IntArray, Part, Rows3, Rows6, Shapes

MARGIN = 1e-9
"""[m] Bounds must win by this, so that their rounding cannot matter; of a window of places it is
also the share of the range."""


@compiled
def put_in_order(values: IntArray, count: int) -> None:
    """Sort the first ``count`` values in place, by ever smaller steps."""
    step = 1
    while step < count // 3:
        step = 3 * step + 1
    while step > 0:
        for k in range(step, count):
            value, at = values[k], k
            while at >= step and values[at - step] > value:
                values[at] = values[at - step]
                at -= step
            values[at] = value
        step //= 3


class BoundingDiscs(NamedTuple):
    """A point of each robot's shape, in its frame, with discs about it inside and around."""

    x: FloatArray
    y: FloatArray
    inner: FloatArray
    outer: FloatArray
    robots: int


def bounding_discs(shapes: Shapes) -> BoundingDiscs:
    """Middle of the first part of each robot, and discs about it inside and around the shape."""
    robots = len(shapes.radius)
    x, y, inner, outer = np.empty((4, robots))
    discs = BoundingDiscs(x, y, inner, outer, robots)
    put_discs(shapes, robots, discs)
    return discs


@compiled
def put_discs(shapes: Shapes, robots: int, discs: BoundingDiscs) -> None:
    """Write `bounding_discs`."""
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
            discs.inner[i] = max(0.0, -point_gap(Part(V, p0, p1), x, y))
        for k in range(p0, shapes.part_start[shapes.body_start[i + 1]]):
            discs.outer[i] = max(discs.outer[i], np.hypot(V[k, 0] - x, V[k, 1] - y))


@compiled
def set_frames(pose: Rows3, discs: BoundingDiscs, frame: Rows6) -> None:
    """Write x, y, cos, sin of each robot and the middle of its discs, world frame."""
    for i in range(discs.robots):
        c = math.cos(pose[i, 2])
        s = math.sin(pose[i, 2])
        frame[i, 0] = pose[i, 0]
        frame[i, 1] = pose[i, 1]
        frame[i, 2] = c
        frame[i, 3] = s
        frame[i, 4] = pose[i, 0] + (c * discs.x[i] - s * discs.y[i])
        frame[i, 5] = pose[i, 1] + (s * discs.x[i] + c * discs.y[i])


@compiled
def pair_distance(shapes: Shapes, i: int, j: int, frame: Rows6) -> float:
    """Signed distance [m] of robots i and j; the same whichever comes first."""
    if j < i:
        i, j = j, i
    c, s = frame[i, 2], frame[i, 3]
    dx, dy = frame[j, 0] - frame[i, 0], frame[j, 1] - frame[i, 1]
    f = frame_at(
        c * frame[j, 2] + s * frame[j, 3],
        c * frame[j, 3] - s * frame[j, 2],
        c * dx + s * dy,
        c * dy - s * dx,
    )
    return body_gap(shapes, i, shapes, j, f)


class Neighbours(NamedTuple):
    """What the search for the nearest robots knows from the sample before; it only saves time."""

    order: IntArray
    """(N,) robots along an axis"""
    last: IntArray
    """(N,) robot that was nearest; another one, whoever it is, at first"""


def neighbours(robots: int) -> Neighbours:
    """What is known before the first sample."""
    return Neighbours(np.arange(robots), (np.arange(robots) + 1) % max(1, robots))


@compiled
def nearest_others(
    shapes: Shapes,
    discs: BoundingDiscs,
    frame: Rows6,
    known: Neighbours,
    gap: FloatArray,
    other: IntArray,
) -> int:
    """Write the distance to the nearest other robot and its index; of equal ones the lowest.

    Each robot is measured against the one that was nearest before, then against those beside it
    along the longer side of where the robots are, as far as one could be as near. Returns how many
    distances were worked out.
    """
    robots = discs.robots
    for i in range(robots):
        gap[i], other[i] = np.inf, -1
    if robots < 2:
        return 0
    order, last, outer = known.order, known.last, discs.outer
    measured = 0
    for i in range(robots):
        j = last[i]
        if last[j] != i or i < j:
            note_distance(shapes, i, j, frame, gap, other)
            measured += 1
    low_x, low_y, high_x, high_y = box_of_middles(frame, robots)
    axis = 4 if high_x - low_x >= high_y - low_y else 5
    for p in range(1, robots):  # by insertion: little has changed
        row, q = order[p], p
        while q > 0 and frame[order[q - 1], axis] > frame[row, axis]:
            order[q] = order[q - 1]
            q -= 1
        order[q] = row
    largest = 0.0
    for i in range(robots):
        largest = max(largest, outer[i])
    for p in range(robots):
        i = order[p]
        for side in range(2):
            way = 2 * side - 1
            q = p + way
            while 0 <= q < robots:
                j = order[q]
                q += way
                dx, dy = frame[j, 4] - frame[i, 4], frame[j, 5] - frame[i, 5]
                along = abs(frame[j, axis] - frame[i, axis])
                if along - outer[i] - largest - MARGIN > gap[i]:
                    break
                limit = gap[i] + outer[i] + outer[j] + MARGIN
                if dx * dx + dy * dy > limit * limit or last[i] == j or last[j] == i:
                    continue
                if line_gap(shapes, i, j, frame) <= gap[i]:
                    note_distance(shapes, i, j, frame, gap, other)
                    measured += 1
    for i in range(robots):
        last[i] = other[i]
    return measured


@compiled
def note_distance(
    shapes: Shapes, i: int, j: int, frame: Rows6, gap: FloatArray, other: IntArray
) -> None:
    """Measure robots i and j, and note it for each that has none as near."""
    d = pair_distance(shapes, i, j, frame)
    if d < gap[i] or (d == gap[i] and j < other[i]):
        gap[i], other[i] = d, j
    if d < gap[j] or (d == gap[j] and i < other[j]):
        gap[j], other[j] = d, i


@compiled
def line_gap(shapes: Shapes, i: int, j: int, frame: Rows6) -> float:
    """Lower bound [m] of `pair_distance`: the gap along the line of the discs' middles."""
    ux = frame[j, 4] - frame[i, 4]
    uy = frame[j, 5] - frame[i, 5]
    length = math.sqrt(ux * ux + uy * uy)
    if length == 0.0:
        return -np.inf
    ux /= length
    uy /= length
    apart = ux * (frame[j, 0] - frame[i, 0]) + uy * (frame[j, 1] - frame[i, 1])
    apart -= extent(shapes, i, frame, ux, uy) + extent(shapes, j, frame, -ux, -uy)
    return float(apart - MARGIN)


@compiled
def extent(shapes: Shapes, i: int, frame: Rows6, ux: float, uy: float) -> float:
    """How far robot i reaches along (ux, uy) from its reference point [m]."""
    V, start, c, s = shapes.vertices, shapes.part_start, frame[i, 2], frame[i, 3]
    bx, by = c * ux + s * uy, c * uy - s * ux
    most = -np.inf
    for k in range(start[shapes.body_start[i]], start[shapes.body_start[i + 1]]):
        most = max(most, bx * V[k, 0] + by * V[k, 1])
    return most


@compiled
def box_of_middles(frame: Rows6, robots: int) -> tuple[float, float, float, float]:
    """Box around the robots' middles: least x, y, greatest x, y."""
    low_x, high_x = frame[0, 4], frame[0, 4]
    low_y, high_y = frame[0, 5], frame[0, 5]
    for i in range(robots):
        low_x, high_x = min(low_x, frame[i, 4]), max(high_x, frame[i, 4])
        low_y, high_y = min(low_y, frame[i, 5]), max(high_y, frame[i, 5])
    return low_x, low_y, high_x, high_y


@compiled
def farthest_pair(
    shapes: Shapes, discs: BoundingDiscs, frame: Rows6, spread: FloatArray, rim: IntArray
) -> tuple[float, int, int]:
    """Largest distance between the shapes of two robots, and which; (-inf, -1, -1) if none.

    No two robots are farther apart than both are from a point between them, so only those at the
    rim can be of the pair. Of equal ones the first pair. ``spread`` (N,) and ``rim`` (N,) are room
    for work.
    """
    robots = discs.robots
    if robots < 2:
        return -np.inf, -1, -1
    inner = discs.inner
    low_x, low_y, high_x, high_y = box_of_middles(frame, robots)
    x, y = 0.5 * (low_x + high_x), 0.5 * (low_y + high_y)
    first = farthest_from(frame, robots, x, y, spread)
    widest = spread[first]
    # The robot at the rim and the one farthest from it are a good start: few pairs can beat it.
    second = farthest_from(frame, robots, frame[first, 4], frame[first, 5], spread)
    if second == first:
        second = 1 if first == 0 else 0
    if second < first:
        first, second = second, first
    best = pair_distance(shapes, first, second, frame)
    farthest_from(frame, robots, x, y, spread)
    smallest, count = np.inf, 0
    for i in range(robots):
        smallest = min(smallest, inner[i])
    for i in range(robots):
        if spread[i] + widest + 2.0 * MARGIN >= best + smallest + inner[i]:
            rim[count] = i
            count += 1
    for m in range(count):
        i = rim[m]
        for n in range(m + 1, count):
            j = rim[n]
            room = best + inner[i] + inner[j] - MARGIN
            if spread[i] + spread[j] + MARGIN < room:
                continue
            dx = frame[j, 4] - frame[i, 4]
            dy = frame[j, 5] - frame[i, 5]
            if room <= 0.0 or dx * dx + dy * dy >= room * room:
                d = pair_distance(shapes, i, j, frame)
                if d > best or (d == best and (i < first or (i == first and j < second))):
                    best, first, second = d, i, j
    return best, first, second


@compiled
def farthest_from(frame: Rows6, robots: int, x: float, y: float, apart: FloatArray) -> int:
    """Write the distance of each robot's middle from a point; which is the farthest."""
    most = 0
    for i in range(robots):
        dx = frame[i, 4] - x
        dy = frame[i, 5] - y
        apart[i] = np.sqrt(dx * dx + dy * dy)
        if apart[i] > apart[most]:
            most = i
    return most
