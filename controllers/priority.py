"""Collision priority: the robots that a decision may look at, and which of them it must consider.

A robot further along the reference path has priority: Robot i considers Robot j only when
l_ij > 0, that is when j is ahead, and within the range (10 m in the paper). Movers and obstacles
that can be pushed, which the paper does not have, are ahead of every robot wherever they are: their
station is inf here, and they are no formation neighbours.

Departures from the paper: equal stations, on which it is silent, are settled by the robot index
(the lower one has priority); the range holds both along the path and straight.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.motion import ended_twists, facings, twists
from physim.geometry.neighbours import put_in_order
from physim.geometry.shapes import FloatArray, IntArray, Rows2, Rows3, Shapes

if TYPE_CHECKING:
    from physim.simulation.observation import View


class Bodies(NamedTuple):
    """Rows of robots as the deciding one senses them: all of them, or those within range."""

    shapes: Shapes
    number: IntArray
    """(n,) robot indices, by which ``shapes`` has their bodies"""
    pose: Rows3
    """(n, 3)"""
    twist: Rows3
    """(n, 3) v [m/s], omega [rad/s], lateral [m/s] that each is taken to keep"""
    station: FloatArray
    """(n,) [m] along the reference path; inf of what is no robot"""
    facing: Rows2
    """(n, 2) cosine and sine of the headings, `physim.geometry.motion.facings`"""
    size: int
    """n"""

    @staticmethod
    def of(view: View, shapes: Shapes) -> Bodies:
        """All rows that are sensed; what is no robot tells neither command nor station."""
        sensed, scene = view.sensed, view.scene
        station, twist = sensed.reference_station, twists(sensed.command)
        if scene.moving > scene.robots:
            other = sensed.robot >= scene.robots
            station = np.where(other, np.inf, station)
            twist[other] = ended_twists(sensed.pose[other], sensed.velocity[other], scene.dt)
        facing = facings(sensed.pose)
        return Bodies(shapes, sensed.robot, sensed.pose, twist, station, facing, len(sensed.robot))


@compiled
def row_of(number: IntArray, rows: int, i: int) -> int:
    """Row of Robot i among so many ``rows`` of robots ``number`` (n,); -1 where it has none."""
    if i < rows and number[i] == i:
        return i  # everybody, in their order
    for row in range(rows):
        if number[row] == i:
            return row
    return -1


@compiled
def has_priority(station_i: float, index_i: int, station_j: float, index_j: int) -> bool:
    """Whether Robot j has priority over Robot i: l_ij > 0, ties by index."""
    if station_j == station_i:
        return index_j < index_i
    return station_j > station_i


class Ranking(NamedTuple):
    """Rows in the order of their stations, so that only those within a range are looked at.

    It holds for one moment; `rank` brings it to the next.
    """

    order: IntArray
    """(n,) rows, by increasing station; of equal ones the lower index last: priority rises"""
    place: IntArray
    """(n,) where each row stands in ``order``"""
    rows: IntArray
    """(n,) the last answer"""
    size: int
    """n"""


def ranking_of(rows: int) -> Ranking:
    """Ranking of ``rows`` rows, not ranked yet."""
    return Ranking(np.arange(rows), np.arange(rows), np.arange(rows), rows)


@compiled
def rank(ranking: Ranking, station: FloatArray, index: IntArray) -> None:
    """Sort the rows by stations (n,) and robot indices (n,).

    By insertion: little has changed since the moment before.
    """
    order = ranking.order
    for p in range(1, ranking.size):
        row, q = order[p], p
        while q > 0 and has_priority(
            station[row], index[row], station[order[q - 1]], index[order[q - 1]]
        ):
            order[q] = order[q - 1]
            q -= 1
        order[q] = row
    for p in range(ranking.size):
        ranking.place[order[p]] = p


@compiled
def pick(ranking: Ranking, first: int, end: int) -> int:
    """Put the rows at places ``first`` to ``end - 1``, increasing, into ``ranking.rows``: how many.

    Robots that are near each other often have numbers that are: then all rows between the lowest
    and the highest are looked at.
    """
    order, place, rows, count = ranking.order, ranking.place, ranking.rows, 0
    low, high = ranking.size, -1
    for p in range(first, end):
        low, high = min(low, order[p]), max(high, order[p])
    if high - low > 8 * (end - first):
        for p in range(first, end):
            rows[p - first] = order[p]
        put_in_order(rows, end - first)
        return end - first
    for row in range(low, high + 1):
        rows[count] = row  # no branch, which would often be guessed wrongly
        count += first <= place[row] < end
    return count


@compiled
def considered_by_rank(
    me: int, ranking: Ranking, pose: Rows3, station: FloatArray, reach: float
) -> int:
    """Put the rows that row ``me`` must consider into ``ranking.rows``: how many.

    Those of the smallest station first: most often the nearest. What is no robot comes last.
    """
    order, rows, p, count = ranking.order, ranking.rows, ranking.place[me] + 1, 0
    first = ranking.size
    while first > p and station[order[first - 1]] == np.inf:
        first -= 1
    while p < ranking.size:
        if p < first and station[order[p]] - station[me] > reach:
            p = first
            continue
        j = order[p]
        dx, dy = pose[j, 0] - pose[me, 0], pose[j, 1] - pose[me, 1]
        rows[count] = j
        count += dx * dx + dy * dy <= reach * reach
        p += 1
    return count


@compiled
def within_by_rank(me: int, ranking: Ranking, station: FloatArray, reach: float) -> int:
    """Put the rows within ``reach`` [m] of row ``me`` along s* into ``ranking.rows``: how many.

    Increasing; ``me`` is none of them.
    """
    order, rows, first, count = ranking.order, ranking.rows, ranking.place[me], 0
    end = first + 1
    while first > 0 and station[me] - station[order[first - 1]] <= reach:
        first -= 1
    while end < ranking.size and station[order[end]] - station[me] <= reach:
        if station[order[end]] == np.inf:
            break
        end += 1
    for k in range(pick(ranking, first, end)):
        rows[count] = rows[k]
        count += rows[count] != me
    return count
