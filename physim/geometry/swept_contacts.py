"""Swept contacts: bodies that touch between two samples and are apart at both, over many samples.

From one sample to the next position and angle go linearly, as the physics moves its bodies. Only
robots near enough to something to reach it within a step are looked at; who they are is worked
out beforehand from their clearances, for whole blocks of samples at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.geometry.separation import body_distance, describe_pair, point_gap, wall_distance
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.geometry.swept import least_gap_pair, least_gap_walls, swept_pair, swept_walls
from physim.tolerances import CONTACT

FULL = -1
"""Count returned when the output has no room for another row."""

MARGIN = 4.0 * CONTACT
"""[m] Bounds must win by this."""


def travel_bounds(poses: FloatArray, radius: FloatArray) -> FloatArray:
    """Upper bound (B - 1, N) [m] on how far any point of a robot moves in each step.

    ``poses`` (B, N, 3), headings unwrapped; ``radius`` (N,) [m] about the reference points.
    """
    moved = np.diff(poses, axis=0)
    bound: FloatArray = np.hypot(moved[..., 0], moved[..., 1]) + radius * np.abs(moved[..., 2])
    return bound


def within_reach(
    travel: FloatArray, clearance: FloatArray, boundary_clearance: FloatArray
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which robots may touch another robot, or a wall, between the samples of a step.

    ``travel`` (B - 1, N), clearances (B, N) [m]; each answer (B - 1, N). What is left out here
    is apart for sure: distances change by no more than the two travel, so a contact within a step
    needs the distances at both its samples, added, to be no more than that.
    """
    other = travel.max(axis=1, keepdims=True, initial=0.0)
    robots = clearance[:-1] + clearance[1:] <= travel + other + MARGIN
    walls = boundary_clearance[:-1] + boundary_clearance[1:] <= travel + MARGIN
    return robots, walls


@compiled
def find_swept_contacts(
    poses: FloatArray,
    travel: FloatArray,
    near_robots: NDArray[np.bool_],
    near_walls: NDArray[np.bool_],
    shapes: Shapes,
    walls: Shapes,
    dt: float,
    who: IntArray,
    values: FloatArray,
) -> int:
    """Write a row for each pair that is apart at both samples of a step and touches in between.

    ``poses`` (B, N, 3); ``travel`` and the two masks (B - 1, N) as above. ``who`` (C, 3) takes the
    step's last sample and bodies a < b (walls from N on), ``values`` (C, 5) what `describe_pair`
    gives. Returns how many, in the order of steps, or FULL.
    """
    count = 0
    robots = poses.shape[1]
    still = np.zeros(3)
    for k in range(1, len(poses)):
        old, now = poses[k - 1], poses[k]
        for a in range(robots):
            if near_robots[k - 1, a]:
                for b in range(a + 1, robots):
                    room = travel[k - 1, a] + travel[k - 1, b] + MARGIN
                    if not near_robots[k - 1, b] or discs_apart(shapes, a, now, b, room):
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
                    who[count, 0], who[count, 1], who[count, 2] = k, a, b
                    share = least[2] / dt
                    describe_pair(
                        shapes, a, between(old[a], now[a], share),
                        shapes, b, between(old[b], now[b], share), values[count],
                    )  # fmt: skip
                    count += 1
            if near_walls[k - 1, a]:
                room = travel[k - 1, a] + MARGIN
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
                    who[count, 0], who[count, 1], who[count, 2] = k, a, robots + w
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
        if point_gap(walls.vertices, start, end, pose[0], pose[1]) <= room:
            found[count] = p
            count += 1
    return found[:count]


@compiled
def between(start: FloatArray, end: FloatArray, share: float) -> FloatArray:
    """Pose (3,) at a share of the way from one sample to the next."""
    return start + share * (end - start)
