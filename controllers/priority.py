"""Collision priority: the robots that a decision may look at, and which of them it must consider.

A robot further along the reference path has priority: Robot i considers Robot j only when
l_ij > 0, that is when j is ahead, and within the range (10 m in the paper).

Departures from the paper: equal stations, on which it is silent, are settled by the robot index
(the lower one has priority); the range holds both along the path and straight.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, IntArray, Shapes


class Bodies(NamedTuple):
    """Rows of robots as the deciding one senses them: all of them, or those within range."""

    shapes: Shapes
    shape: IntArray
    """(n,) which body of ``shapes`` each row has"""
    number: IntArray
    """(n,) robot indices"""
    pose: FloatArray
    """(n, 3)"""
    command: FloatArray
    """(n, 2) held"""
    station: FloatArray
    """(n,) [m] along the reference path"""
    facing: FloatArray
    """(n, 2) cosine and sine of the headings, `physim.geometry.motion.facings`"""


@compiled
def has_priority(station_i: float, index_i: int, station_j: float, index_j: int) -> bool:
    """Whether Robot j has priority over Robot i: l_ij > 0, ties by index."""
    if station_j == station_i:
        return index_j < index_i
    return station_j > station_i


@compiled
def considered(
    me: int, index: IntArray, pose: FloatArray, station: FloatArray, reach: float
) -> IntArray:
    """Rows j of the robots that row ``me`` must consider, in increasing order.

    ``index`` (n,) robot indices, ``pose`` (n, 3), ``station`` (n,) along s*, ``reach`` [m].
    """
    rows = np.empty(len(index), dtype=np.int64)
    count = 0
    for j in range(len(index)):
        if j == me or station[j] - station[me] > reach:
            continue
        dx, dy = pose[j, 0] - pose[me, 0], pose[j, 1] - pose[me, 1]
        if dx * dx + dy * dy > reach * reach:
            continue
        if has_priority(station[me], index[me], station[j], index[j]):
            rows[count] = j
            count += 1
    return rows[:count]
