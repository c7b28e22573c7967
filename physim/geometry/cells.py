"""Cells of a grid without an edge, to find the robots about a robot."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, IntArray


class Cells(NamedTuple):
    """Robots sorted by the cell of their middle; each cell is in one of M buckets."""

    side: FloatArray
    """(1,) [m]"""
    column: IntArray
    """(N,)"""
    row: IntArray
    """(N,)"""
    start: IntArray
    """(M + 1,) robots of bucket b are ``robot[start[b]:start[b + 1]]``; M is a power of two"""
    robot: IntArray
    """(N,)"""


@compiled
def no_cells(robots: int) -> Cells:
    """Room for the cells of N robots."""
    buckets = 1
    while buckets < 2 * robots:
        buckets *= 2
    return Cells(
        np.ones(1),
        np.empty(robots, dtype=np.int64),
        np.empty(robots, dtype=np.int64),
        np.empty(buckets + 1, dtype=np.int64),
        np.empty(robots, dtype=np.int64),
    )


@compiled
def bucket(column: int, row: int, buckets: int) -> int:
    """Bucket of a cell; ``buckets`` is a power of two."""
    return (column * 73856093 ^ row * 19349663) & (buckets - 1)


@compiled
def set_cells(frame: FloatArray, side: float, cells: Cells) -> None:
    """Sort robots into cells of a side [m]; their middles are in columns 4 and 5 of ``frame``."""
    column, row, start, robot = cells.column, cells.row, cells.start, cells.robot
    buckets = len(start) - 1
    cells.side[0] = side
    for b in range(buckets + 1):
        start[b] = 0
    for i in range(len(frame)):
        column[i] = math.floor(frame[i, 4] / side)
        row[i] = math.floor(frame[i, 5] / side)
        start[bucket(column[i], row[i], buckets) + 1] += 1
    for b in range(1, buckets + 1):
        start[b] += start[b - 1]
    for i in range(len(frame) - 1, -1, -1):  # each bucket from its end: its start is left there
        b = bucket(column[i], row[i], buckets) + 1
        start[b] -= 1
        robot[start[b]] = i
    for b in range(buckets):
        start[b] = start[b + 1]
    start[buckets] = len(frame)


@compiled
def around(frame: FloatArray, cells: Cells, i: int, reach: float, found: IntArray) -> int:
    """Write into ``found`` the robots whose middle may be within ``reach`` of robot i's; how many.

    All others where so many cells would have to be looked at that this is no more work.
    """
    side, column, row, start = cells.side[0], cells.column, cells.row, cells.start
    x, y = frame[i, 4], frame[i, 5]
    count = 0
    span = 2.0 * reach / side + 2.0
    if span * span >= len(frame):
        for j in range(len(frame)):
            if j != i:
                found[count] = j
                count += 1
        return count
    low, high = math.floor((y - reach) / side), math.floor((y + reach) / side)
    for c in range(math.floor((x - reach) / side), math.floor((x + reach) / side) + 1):
        for r in range(low, high + 1):
            b = bucket(c, r, len(start) - 1)
            for k in range(start[b], start[b + 1]):
                j = cells.robot[k]
                if j != i and column[j] == c and row[j] == r:
                    found[count] = j
                    count += 1
    return count
