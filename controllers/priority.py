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
    marks: NDArray[np.uint64]
    """a bit for each row, all 0 between two questions"""
    rows: IntArray
    """(n,) room for an answer"""


@compiled
def ranking_of(station: FloatArray) -> Ranking:
    """Ranking of rows at stations (n,), but for equal ones, which are left to `rank`."""
    order = np.argsort(station, kind="mergesort")
    marks = np.zeros(len(station) // 64 + 1, dtype=np.uint64)
    return Ranking(order, np.zeros_like(order), marks, np.zeros_like(order))


@compiled
def rank(ranking: Ranking, station: FloatArray, index: IntArray) -> None:
    """Sort the rows by stations (n,) and robot indices (n,).

    Insertion: little has changed since the moment before.
    """
    order, place = ranking.order, ranking.place
    for p in range(1, len(order)):
        row, q = order[p], p
        while q > 0 and has_priority(
            station[row], index[row], station[order[q - 1]], index[order[q - 1]]
        ):
            order[q] = order[q - 1]
            q -= 1
        order[q] = row
    for p in range(len(order)):
        place[order[p]] = p


BIT = np.uint64(1)
BITS = 64


@compiled
def mark(ranking: Ranking, row: int) -> None:
    """Put a row into the answer."""
    ranking.marks[row >> 6] |= BIT << np.uint64(row & 63)


@compiled
def marked(ranking: Ranking, low: int, high: int) -> IntArray:
    """The rows of the answer, increasing, all within low to high; the next answer is empty.

    They stand in ``ranking.rows`` until the next one.
    """
    count = 0
    for word in range(low >> 6, (high >> 6) + 1):
        bits = ranking.marks[word]
        ranking.marks[word] = 0
        row = word * BITS
        while bits:
            if not bits & np.uint64(0xFFFF):
                bits >>= np.uint64(16)
                row += 16
                continue
            if bits & BIT:
                ranking.rows[count] = row
                count += 1
            bits >>= BIT
            row += 1
    return ranking.rows[:count]


@compiled
def considered_by_rank(
    me: int, ranking: Ranking, pose: FloatArray, station: FloatArray, reach: float
) -> IntArray:
    """`considered`, by a ranking: only rows ahead and within range are looked at."""
    order, low, high = ranking.order, len(ranking.order), -1
    for p in range(ranking.place[me] + 1, len(order)):
        j = order[p]
        if station[j] - station[me] > reach:
            break
        dx, dy = pose[j, 0] - pose[me, 0], pose[j, 1] - pose[me, 1]
        if dx * dx + dy * dy > reach * reach:
            continue
        mark(ranking, j)
        low, high = min(low, j), max(high, j)
    return marked(ranking, low, high)


@compiled
def within_by_rank(me: int, ranking: Ranking, station: FloatArray, reach: float) -> IntArray:
    """Rows but ``me`` with a station within ``reach`` of its own, increasing."""
    order, here = ranking.order, station[me]
    low, high, count = me, me, 1
    for direction in (-1, 1):
        p = ranking.place[me] + direction
        while 0 <= p < len(order) and abs(station[order[p]] - here) <= reach:
            low, high = min(low, order[p]), max(high, order[p])
            count += 1
            p += direction
    if high - low <= 2 * count:  # most rows between the lowest and the highest: look at each
        found = 0
        for j in range(low, high + 1):
            if j != me and abs(station[j] - here) <= reach:
                ranking.rows[found] = j
                found += 1
        return ranking.rows[:found]
    for direction in (-1, 1):
        p = ranking.place[me] + direction
        while 0 <= p < len(order) and abs(station[order[p]] - here) <= reach:
            mark(ranking, order[p])
            p += direction
    return marked(ranking, low, high)
