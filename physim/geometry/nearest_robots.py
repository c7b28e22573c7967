"""The nearest other robot of every robot, sample after sample, in time linear in their number.

Each robot is measured against the one that was nearest at the sample before. Who else could be as
near is in a list of pairs, each with a distance that it surely has, which wears off by as much as
the two move; measured are only pairs of which the rest does not say that they are farther apart. A
drift that all robots share wears nothing off. The list is made anew when a pair that is not in it
could matter. Whatever it says, the values are those that a look at all pairs would give.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import shapely

from physim.compiled import compiled
from physim.geometry.cells import around, no_cells, set_cells
from physim.geometry.robot_frames import (
    MARGIN,
    BoundingDiscs,
    largest_of,
    least_gap,
    pair_distance,
)
from physim.geometry.shapes import FloatArray, IntArray, Shapes

SLACK = 1.0
"""How far the list reaches beyond the nearest robot, in radii of the largest robot."""


class Neighbours(NamedTuple):
    """What is known from the samples before."""

    hint: IntArray
    """(N,) robot that was nearest, or is by the reference points: another, whoever it is"""
    pose: FloatArray
    """(N, 3) at the sample before"""
    wear: FloatArray
    """(N,) [m] no point of the robot moved farther, but for the common drift, since the list was
    made"""
    complete: FloatArray
    """(N,) [m] pairs that are not in the list were farther apart when it was made"""


class Pairs(NamedTuple):
    """List of pairs of robots; only the first ``length[0]`` rows count."""

    a: IntArray
    b: IntArray
    least: FloatArray
    """[m] the distance of a pair is at least this less the wear of both"""
    length: IntArray


def neighbours(pose: FloatArray) -> Neighbours:
    """What is known before sample 0, at which robots are at ``pose`` (N, 3)."""
    robots = len(pose)
    hint = (np.arange(robots) + 1) % robots
    places = shapely.points(pose[:, :2])
    tree = shapely.STRtree(places)
    who, nearest = tree.query_nearest(places, exclusive=True, all_matches=False)
    hint[who] = nearest  # nobody's where all are at the same place
    return Neighbours(hint, pose.copy(), np.zeros(robots), np.full(robots, -np.inf))


def no_pairs(room: int) -> Pairs:
    """Room for a list of pairs."""
    return Pairs(
        np.empty(room, dtype=np.int64),
        np.empty(room, dtype=np.int64),
        np.empty(room),
        np.zeros(1, dtype=np.int64),
    )


@compiled
def nearest_others(
    shapes: Shapes,
    discs: BoundingDiscs,
    pose: FloatArray,
    frame: FloatArray,
    known: Neighbours,
    pairs: Pairs,
    gap: FloatArray,
    other: IntArray,
) -> tuple[Pairs, int]:
    """Write the distance to the nearest other robot and its index; of equal ones the lowest.

    ``pose`` (N, 3) and ``frame`` (N, 6) of the sample. Returns the list of pairs for the next
    sample, and how many distances were worked out.
    """
    robots = len(frame)
    for i in range(robots):
        gap[i] = np.inf
        other[i] = -1
    if robots < 2:
        return pairs, 0
    V, part_start, body_start = shapes.vertices, shapes.part_start, shapes.body_start
    hint, wear, complete = known.hint, known.wear, known.complete
    wear_off(pose, discs, known)
    measured = 0
    for i in range(robots):
        j = hint[i]
        if hint[j] != i or i < j:
            d = pair_distance(V, part_start, body_start, i, j, frame)
            measured += 1
            keep_nearest(i, j, d, gap, other)
            keep_nearest(j, i, d, gap, other)
    most = largest_of(wear)
    for i in range(robots):
        if gap[i] + wear[i] + most > complete[i]:
            pairs = near_pairs(discs, frame, gap, known, pairs)
            break
    a, b, least = pairs.a, pairs.b, pairs.least
    for k in range(pairs.length[0]):
        i, j = a[k], b[k]
        limit = max(gap[i], gap[j]) + wear[i] + wear[j]
        if least[k] > limit or hint[i] == j or hint[j] == i:
            continue
        d = least_gap(V, part_start, body_start, i, j, frame) + wear[i] + wear[j]
        if d <= limit:
            d = pair_distance(V, part_start, body_start, i, j, frame)
            measured += 1
            keep_nearest(i, j, d, gap, other)
            keep_nearest(j, i, d, gap, other)
            d += wear[i] + wear[j] - MARGIN
        least[k] = d
    for i in range(robots):
        hint[i] = other[i]
    return pairs, measured


@compiled
def keep_nearest(i: int, j: int, d: float, gap: FloatArray, other: IntArray) -> None:
    """Note that robot j is at distance d from robot i."""
    if d < gap[i] or (d == gap[i] and j < other[i]):
        gap[i] = d
        other[i] = j


@compiled
def wear_off(pose: FloatArray, discs: BoundingDiscs, known: Neighbours) -> None:
    """Let what is known wear off by how far each robot went since the sample before.

    That is how far its disc's middle went, less the drift, and how far it turned.
    """
    before, wear = known.pose, known.wear
    robots = len(pose)
    drift_x, drift_y = 0.0, 0.0
    for i in range(robots):
        drift_x += pose[i, 0] - before[i, 0]
        drift_y += pose[i, 1] - before[i, 1]
    drift_x /= robots
    drift_y /= robots
    for i in range(robots):
        dx = pose[i, 0] - before[i, 0] - drift_x
        dy = pose[i, 1] - before[i, 1] - drift_y
        swing = math.hypot(discs.x[i], discs.y[i]) + discs.outer[i]
        wear[i] += math.sqrt(dx * dx + dy * dy) + swing * abs(pose[i, 2] - before[i, 2])
        before[i, 0], before[i, 1], before[i, 2] = pose[i, 0], pose[i, 1], pose[i, 2]


@compiled
def near_pairs(
    discs: BoundingDiscs, frame: FloatArray, limit: FloatArray, known: Neighbours, pairs: Pairs
) -> Pairs:
    """Make the list anew; ``limit`` (N,) [m]: the nearest robot is no farther.

    It holds the pairs whose discs come nearer than the limit of one of the two, and some way
    beyond; ``pairs`` is written to if it has room.
    """
    robots = len(frame)
    outer, complete = discs.outer, known.complete
    largest = largest_of(outer)
    reach = np.empty(robots)
    total = 0.0
    for i in range(robots):
        known.wear[i] = 0.0
        complete[i] = limit[i] + SLACK * largest
        reach[i] = complete[i] + outer[i] + largest + 2.0 * MARGIN
        total += 1.0 / max(reach[i], MARGIN)
    cells = no_cells(robots)
    set_cells(frame, 0.5 * robots / total, cells)  # a mean that a few lone robots do not change
    found = np.empty(robots, dtype=np.int64)
    count = 0
    for i in range(robots):
        for k in range(around(frame, cells, i, reach[i], found)):
            j = found[k]
            apart = middles_apart(frame, i, j)
            if apart > reach[i] or (j < i and apart <= reach[j]):
                continue  # too far; or listed already, when it was j's turn
            if count == len(pairs.a):
                pairs = with_more_room(pairs)
            pairs.a[count], pairs.b[count] = i, j
            pairs.least[count] = apart - outer[i] - outer[j] - MARGIN
            count += 1
    pairs.length[0] = count
    return pairs


@compiled
def with_more_room(pairs: Pairs) -> Pairs:
    """Copy a list that is full into one of twice the room."""
    size = len(pairs.a)
    larger = Pairs(
        np.empty(2 * size, dtype=np.int64),
        np.empty(2 * size, dtype=np.int64),
        np.empty(2 * size),
        pairs.length,
    )
    for k in range(size):
        larger.a[k], larger.b[k], larger.least[k] = pairs.a[k], pairs.b[k], pairs.least[k]
    return larger


@compiled
def middles_apart(frame: FloatArray, i: int, j: int) -> float:
    """Distance [m] of the middles of two robots' discs."""
    dx = frame[j, 4] - frame[i, 4]
    dy = frame[j, 5] - frame[i, 5]
    return math.sqrt(dx * dx + dy * dy)
