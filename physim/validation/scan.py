"""Kernels of the analytic contacts: which bodies are near each other, at samples and between them.

Between two samples position and angle go linearly, as the engine moves them. Discs leave out only
what is farther than ``reach``.
"""

from __future__ import annotations

import math

import numpy as np

from physim.compiled import compiled
from physim.geometry.separation import body_distance, point_gap, wall_distance
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.geometry.swept import swept_pair, swept_walls
from physim.tolerances import CONTACT

FULL = -1
"""Count returned when the output has no room for another row."""


@compiled
def travel_bound(start: FloatArray, end: FloatArray, radius: float) -> float:
    """Upper bound [m] on how far any point of a body moves in one step."""
    way = math.hypot(end[0] - start[0], end[1] - start[1])
    return float(way + radius * abs(end[2] - start[2]))


@compiled
def touch_in_step(before: float, now: float, moved: float) -> bool:
    """Whether a step may hold a contact that begins in it: only then it is looked at closely.

    ``before`` and ``now`` [m] are the distances at its two samples, ``moved`` [m] bounds the
    relative travel.
    """
    if before <= CONTACT:
        return False
    return now <= CONTACT or before + now <= moved + 4.0 * CONTACT


@compiled
def scan_robots(
    poses: FloatArray,
    first: int,
    shapes: Shapes,
    reach: float,
    dt: float,
    who: IntArray,
    values: FloatArray,
) -> int:
    """Write a row for each pair of robots nearer than ``reach`` [m]; returns how many, or FULL.

    ``poses`` (B, N, 3), samples from ``first`` (0 or 1) on are looked at. ``who`` (C, 3) takes the
    sample's number in the block and robots a < b, ``values`` (C, 2) the signed distance [m] and
    the time since the sample before [s] at which a contact begins (NaN: none begins).
    """
    count = 0
    robots = poses.shape[1]
    order = np.arange(robots)
    largest = shapes.radius[:robots].max()
    for k in range(first, len(poses)):
        now = poses[k]
        for m in range(1, robots):
            i = order[m]
            place = m
            while place > 0 and now[order[place - 1], 0] > now[i, 0]:
                order[place] = order[place - 1]
                place -= 1
            order[place] = i
        for m in range(robots):
            for n in range(m + 1, robots):
                a, b = min(order[m], order[n]), max(order[m], order[n])
                dx = now[order[n], 0] - now[order[m], 0]
                if dx > reach + shapes.radius[order[m]] + largest:
                    break
                room = reach + shapes.radius[a] + shapes.radius[b]
                dy = now[b, 1] - now[a, 1]
                if dx * dx + dy * dy > room * room:
                    continue
                d = body_distance(shapes, a, now[a], shapes, b, now[b])
                if d > reach:
                    continue
                if count == len(who):
                    return FULL
                who[count, 0], who[count, 1], who[count, 2] = k, a, b
                values[count, 0], values[count, 1] = d, np.nan
                if k > 0:
                    old = poses[k - 1]
                    ra, rb = shapes.radius[a], shapes.radius[b]
                    moved = travel_bound(old[a], now[a], ra) + travel_bound(old[b], now[b], rb)
                    if d <= CONTACT or d <= moved:
                        before = body_distance(shapes, a, old[a], shapes, b, old[b])
                        if touch_in_step(before, d, moved):
                            values[count, 1] = swept_pair(
                                shapes, a, old[a], now[a], b, old[b], now[b], dt
                            )
                count += 1
    return count


@compiled
def walls_about(poses: FloatArray, i: int, radius: float, walls: Shapes, reach: float) -> IntArray:
    """Wall parts that robot i may come nearer than ``reach`` [m] to in a block of poses."""
    low_x, high_x = poses[:, i, 0].min(), poses[:, i, 0].max()
    low_y, high_y = poses[:, i, 1].min(), poses[:, i, 1].max()
    x, y = 0.5 * (low_x + high_x), 0.5 * (low_y + high_y)
    room = math.hypot(high_x - x, high_y - y) + radius + reach + 1e-6
    parts = len(walls.part_start) - 1
    found = np.empty(parts, dtype=np.int64)
    count = 0
    for p in range(parts):
        if point_gap(walls.vertices, walls.part_start[p], walls.part_start[p + 1], x, y) <= room:
            found[count] = p
            count += 1
    return found[:count]


@compiled
def scan_walls(
    poses: FloatArray,
    first: int,
    shapes: Shapes,
    walls: Shapes,
    reach: float,
    dt: float,
    who: IntArray,
    values: FloatArray,
) -> int:
    """`scan_robots` for each robot and each boundary or obstacle, whose id is N + its index."""
    count = 0
    robots = poses.shape[1]
    for i in range(robots):
        radius = shapes.radius[i]
        about = walls_about(poses, i, radius, walls, reach)
        for w in range(len(walls.body_start) - 1):
            parts = about[(about >= walls.body_start[w]) & (about < walls.body_start[w + 1])]
            if not len(parts):
                continue
            for k in range(first, len(poses)):
                d = wall_distance(shapes, i, poses[k, i], walls, parts)
                if d > reach:
                    continue
                if count == len(who):
                    return FULL
                who[count, 0], who[count, 1], who[count, 2] = k, i, robots + w
                values[count, 0], values[count, 1] = d, np.nan
                if k > 0:
                    start, end = poses[k - 1, i], poses[k, i]
                    moved = travel_bound(start, end, radius)
                    if d <= CONTACT or d <= moved:
                        before = wall_distance(shapes, i, start, walls, parts)
                        if touch_in_step(before, d, moved):
                            values[count, 1] = swept_walls(shapes, i, start, end, walls, parts, dt)[
                                0
                            ]
                count += 1
    return count
