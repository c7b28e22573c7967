"""Where all robots are at one sample: frames, discs about their shapes, distances of pairs."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.separation import body_gap, point_gap
from physim.geometry.shapes import FloatArray, IntArray, Shapes

MARGIN = 1e-9
"""[m] Bounds must win by this, so that their rounding cannot matter."""


class BoundingDiscs(NamedTuple):
    """A point of each robot's shape, in its frame, with discs about it inside and around."""

    x: FloatArray
    y: FloatArray
    inner: FloatArray
    outer: FloatArray


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
def extent(
    vertices: FloatArray, first: int, last: int, c: float, s: float, ux: float, uy: float
) -> float:
    """How far vertices ``first`` to ``last - 1`` reach along a direction of the world [m].

    Counted from the origin of their frame, which is turned by (c, s).
    """
    bx = c * ux + s * uy
    by = c * uy - s * ux
    most = -np.inf
    for k in range(first, last):
        most = max(most, bx * vertices[k, 0] + by * vertices[k, 1])
    return most


@compiled
def least_gap(
    vertices: FloatArray,
    part_start: IntArray,
    body_start: IntArray,
    i: int,
    j: int,
    frame: FloatArray,
) -> float:
    """Lower bound [m] of `pair_distance`: the gap along the line of the discs' middles.

    The same whichever robot comes first, bit for bit.
    """
    if j < i:
        i, j = j, i
    ux = frame[j, 4] - frame[i, 4]
    uy = frame[j, 5] - frame[i, 5]
    length = math.sqrt(ux * ux + uy * uy)
    if length == 0.0:
        return -np.inf
    ux /= length
    uy /= length
    apart = ux * (frame[j, 0] - frame[i, 0]) + uy * (frame[j, 1] - frame[i, 1])
    i0, i1 = part_start[body_start[i]], part_start[body_start[i + 1]]
    j0, j1 = part_start[body_start[j]], part_start[body_start[j + 1]]
    near = extent(vertices, i0, i1, frame[i, 2], frame[i, 3], ux, uy)
    far = extent(vertices, j0, j1, frame[j, 2], frame[j, 3], -ux, -uy)
    return float(apart - near - far - MARGIN)


@compiled
def largest_of(values: FloatArray) -> float:
    """Return the largest value; -inf without any."""
    most = -np.inf
    for value in values:
        most = max(most, value)
    return most
