"""Swept contacts: bodies that touch between two samples and are apart at both.

From one sample to the next position and angle go linearly, as the physics moves its bodies. Only
robots near enough to something to reach it within the step are looked at.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.geometry.bodies import body_distance, describe_pair, point_gap, wall_distance
from physim.geometry.shapes import FloatArray, IntArray, Part, Shapes
from physim.geometry.swept import least_gap_pair, least_gap_walls, swept_pair, swept_walls
from physim.tolerances import CONTACT

FULL = -1
"""Count returned when the output has no room for another row."""

MARGIN = 4.0 * CONTACT
"""[m] Bounds must win by this."""


@compiled
def wear_off(
    old: FloatArray, now: FloatArray, radius: FloatArray, reach: FloatArray, room: FloatArray
) -> bool:
    """Take from ``room`` what a step may have taken; whether somebody may touch something in it.

    Poses (N, 3) at both samples, headings unwrapped; ``radius`` (N,) [m] about the reference
    points. ``room`` (2, N) [m] is a lower bound of each robot's distance from other robots, and
    from walls. ``reach`` (2, N) [m] takes how much these distances change at most: what is farther
    apart at either sample does not touch in between.
    """
    most = 0.0
    for i in range(len(old)):
        moved = math.hypot(now[i, 0] - old[i, 0], now[i, 1] - old[i, 1])
        reach[1, i] = moved + radius[i] * abs(now[i, 2] - old[i, 2]) + MARGIN
        most = max(most, reach[1, i])
    is_near = False
    for i in range(len(old)):
        reach[0, i] = reach[1, i] + most
        for k in range(2):
            is_near |= room[k, i] <= reach[k, i]
            room[k, i] -= reach[k, i]
    return is_near


@compiled
def find_swept_contacts(
    old: FloatArray,
    now: FloatArray,
    reach: FloatArray,
    near: NDArray[np.bool_],
    shapes: Shapes,
    walls: Shapes,
    dt: float,
    who: IntArray,
    values: FloatArray,
) -> int:
    """Write a row for each pair that is apart at both samples of a step and touches in between.

    Poses (N, 3); ``reach`` (2, N) of `wear_off`; ``near`` (2, N), who may touch another robot, and
    a wall. ``who`` (C, 2) takes the bodies a < b (walls from N on), ``values`` (C, 5) what
    `describe_pair` gives. Returns how many, or FULL.
    """
    count = 0
    robots = len(old)
    still = np.zeros(3)
    for a in range(robots):
        if near[0, a]:
            for b in range(a + 1, robots):
                room = reach[1, a] + reach[1, b]
                if not near[0, b] or discs_apart(shapes, a, now, b, room):
                    continue
                after = body_distance(shapes, a, now[a], shapes, b, now[b])
                if after <= CONTACT or after > room:
                    continue
                before = body_distance(shapes, a, old[a], shapes, b, old[b])
                if before <= CONTACT or before + after > room:
                    continue
                if swept_pair(shapes, a, old[a], now[a], b, old[b], now[b], dt) == np.inf:
                    continue
                if count == len(who):
                    return FULL
                least = least_gap_pair(shapes, a, old[a], now[a], b, old[b], now[b], dt)
                who[count, 0], who[count, 1] = a, b
                share = least[2] / dt
                describe_pair(
                    shapes, a, between(old[a], now[a], share),
                    shapes, b, between(old[b], now[b], share), values[count],
                )  # fmt: skip
                count += 1
        if near[1, a]:
            room = reach[1, a]
            for w in range(len(walls.body_start) - 1):
                parts = parts_about(walls, w, now[a], shapes.radius[a] + room)
                if not len(parts):
                    continue
                after = wall_distance(shapes, a, now[a], walls, parts)
                if after <= CONTACT or after > room:
                    continue
                before = wall_distance(shapes, a, old[a], walls, parts)
                if before <= CONTACT or before + after > room:
                    continue
                if swept_walls(shapes, a, old[a], now[a], walls, parts, dt)[0] == np.inf:
                    continue
                if count == len(who):
                    return FULL
                found = least_gap_walls(shapes, a, old[a], now[a], walls, parts, dt)
                who[count, 0], who[count, 1] = a, robots + w
                at = between(old[a], now[a], found[2] / dt)
                describe_pair(shapes, a, at, walls, w, still, values[count])
                count += 1
    return count


@compiled
def discs_apart(shapes: Shapes, a: int, pose: FloatArray, b: int, room: float) -> bool:
    """Whether the discs around robots a and b are farther apart than ``room`` [m]."""
    far = room + shapes.radius[a] + shapes.radius[b]
    dx = pose[b, 0] - pose[a, 0]
    dy = pose[b, 1] - pose[a, 1]
    return bool(dx * dx + dy * dy > far * far)


@compiled
def parts_about(walls: Shapes, body: int, pose: FloatArray, room: float) -> IntArray:
    """Parts of one wall that come within ``room`` [m] of the reference point of a pose (3,)."""
    first, last = walls.body_start[body], walls.body_start[body + 1]
    found = np.empty(last - first, dtype=np.int64)
    count = 0
    for p in range(first, last):
        start, end = walls.part_start[p], walls.part_start[p + 1]
        if point_gap(Part(walls.vertices, start, end), pose[0], pose[1]) <= room:
            found[count] = p
            count += 1
    return found[:count]


@compiled
def between(start: FloatArray, end: FloatArray, share: float) -> FloatArray:
    """Pose (3,) at a share of the way from one sample to the next."""
    return start + share * (end - start)
