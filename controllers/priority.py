"""Collision priority: the robots that a decision may look at, and which of them it must consider.

A robot further along the reference path has priority: Robot i considers Robot j only when
l_ij > 0, that is when j is ahead, and within the range (10 m in the paper).

Departures from the paper: equal stations, on which it is silent, are settled by the robot index
(the lower one has priority); the range holds both along the path and straight.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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


class Ranking(NamedTuple):
    """Rows in the order of their stations, so that only those within a range are looked at.

    It holds for one moment; `rank` brings it to the next. What it finds is what a look at all
    rows would find, in the same order.
    """

    order: IntArray
    """(n,) rows, by increasing station; of equal ones the lower index last: priority rises"""
    place: IntArray
    """(n,) where each row stands in ``order``"""
    along: FloatArray
    """(n,) [m] stations, in ``order``"""
    lowest: IntArray
    """lowest row of each BLOCK of places"""
    highest: IntArray
    marks: NDArray[np.uint64]
    """a bit for each row, all 0 between two questions"""
    rows: IntArray
    """(n,) the last answer"""


BLOCK = 16
"""Places of which the lowest and highest row are known."""

BITS = 64
ONE = np.uint64(1)


@compiled
def ranking_of(rows: int) -> Ranking:
    """Ranking of ``rows`` rows, not ranked yet."""
    order = np.arange(rows)
    blocks = np.zeros(rows // BLOCK + 1, dtype=np.int64)
    marks = np.zeros(rows // BITS + 1, dtype=np.uint64)
    return Ranking(
        order, order.copy(), np.zeros(rows), blocks, blocks.copy(), marks, order.copy()
    )  # fmt: skip


@compiled
def rank(ranking: Ranking, station: FloatArray, index: IntArray) -> None:
    """Sort the rows by stations (n,) and robot indices (n,).

    By insertion: little has changed since the moment before.
    """
    order = ranking.order
    for p in range(1, len(order)):
        row, q = order[p], p
        while q > 0 and has_priority(
            station[row], index[row], station[order[q - 1]], index[order[q - 1]]
        ):
            order[q] = order[q - 1]
            q -= 1
        order[q] = row
    for p in range(len(order)):
        row, block = order[p], p // BLOCK
        ranking.place[row], ranking.along[p] = p, station[row]
        if p % BLOCK == 0:
            ranking.lowest[block], ranking.highest[block] = row, row
        ranking.lowest[block] = min(ranking.lowest[block], row)
        ranking.highest[block] = max(ranking.highest[block], row)


@compiled
def first_within(along: FloatArray, place: int, reach: float) -> int:
    """First place with a station within ``reach`` [m] of that at ``place``."""
    low, high = 0, place
    while low < high:
        middle = (low + high) // 2
        if along[place] - along[middle] <= reach:
            high = middle
        else:
            low = middle + 1
    return low


@compiled
def end_within(along: FloatArray, place: int, reach: float) -> int:
    """One past the last place with a station within ``reach`` [m] of that at ``place``."""
    low, high = place + 1, len(along)
    while low < high:
        middle = (low + high) // 2
        if along[middle] - along[place] <= reach:
            low = middle + 1
        else:
            high = middle
    return low


@compiled
def pick(ranking: Ranking, first: int, end: int) -> int:
    """Put the rows at places ``first`` to ``end - 1``, increasing, into ``ranking.rows``: how many.

    Robots that are near each other often have numbers that are: then all rows between the lowest
    and the highest are looked at. Otherwise each sets its bit, and the bits are read in order.
    """
    place, rows = ranking.place, ranking.rows
    low, high = len(place), -1
    for block in range(first // BLOCK, (end - 1) // BLOCK + 1 if end > first else 0):
        low, high = min(low, ranking.lowest[block]), max(high, ranking.highest[block])
    count = 0
    if high - low <= 4 * (end - first + BLOCK):
        for row in range(low, high + 1):
            if first <= place[row] < end:
                rows[count] = row
                count += 1
        return count
    for p in range(first, end):
        row = ranking.order[p]
        ranking.marks[row // BITS] |= ONE << np.uint64(row % BITS)
    for word in range(low // BITS, high // BITS + 1):
        bits, row = ranking.marks[word], word * BITS
        ranking.marks[word] = 0
        while bits:
            if bits & ONE:
                rows[count] = row
                count += 1
            bits >>= ONE
            row += 1
    return count


@compiled
def considered_by_rank(me: int, ranking: Ranking, pose: FloatArray, reach: float) -> int:
    """Put `considered` into ``ranking.rows``, by looking only ahead and within range: how many."""
    rows, here = ranking.rows, ranking.place[me]
    x, y, count = pose[me, 0], pose[me, 1], 0
    for k in range(pick(ranking, here + 1, end_within(ranking.along, here, reach))):
        j = rows[k]
        dx, dy = pose[j, 0] - x, pose[j, 1] - y
        if dx * dx + dy * dy <= reach * reach:
            rows[count] = j
            count += 1
    return count


@compiled
def within_by_rank(me: int, ranking: Ranking, reach: float) -> int:
    """Put the rows within ``reach`` [m] of row ``me`` along s* into ``ranking.rows``: how many.

    Increasing; ``me`` is none of them.
    """
    rows, here, count = ranking.rows, ranking.place[me], 0
    first = first_within(ranking.along, here, reach)
    for k in range(pick(ranking, first, end_within(ranking.along, here, reach))):
        if rows[k] != me:
            rows[count] = rows[k]
            count += 1
    return count
