"""Swept contacts: bodies that touch between two samples and are apart at both.

From one sample to the next position and angle go linearly, as the physics moves its bodies. Only
robots near enough to something to reach it within the step are looked at.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.geometry.bodies import body_gap, describe_pair, relative_frame
from physim.geometry.convex import frame_at
from physim.geometry.neighbours import (
    BoundingDiscs,
    bounding_discs,
    line_gap,
    pair_distance,
    put_in_order,
    set_frames,
)
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.geometry.swept import least_gap, swept_time
from physim.geometry.walls import (
    NearestWalls,
    Sight,
    WallTree,
    nearest_seen,
    nearest_walls,
    parts_near,
)
from physim.tolerances import CONTACT

FULL = -1
"""Count returned when the output has no room for another row."""

MARGIN = 4.0 * CONTACT
"""[m] Bounds must win by this."""


AHEAD = 16.0
"""Steps for which robots are measured ahead, so that most steps need no search."""


class Room(NamedTuple):
    """Lower bounds of how far each of N robots is from others, and what a search knows of them."""

    bound: FloatArray
    """(2, N) [m] distance from other robots, and from walls; 0 or less: not known"""
    reach: FloatArray
    """(2, N) [m] how much a robot's own part in a step changes that distance, at most"""
    discs: BoundingDiscs
    order: IntArray
    """(N,) robots by the x of the middles of their discs"""
    walls: NearestWalls


def no_room(shapes: Shapes) -> Room:
    """Nothing is known of the robots of these shapes."""
    robots = len(shapes.radius)
    bound, reach = np.zeros((2, robots)), np.zeros((2, robots))
    return Room(bound, reach, bounding_discs(shapes), np.arange(robots), nearest_walls(robots))


@compiled
def wear_off(
    old: FloatArray,
    now: FloatArray,
    dt: float,
    radius: FloatArray,
    bound: FloatArray,
    reach: FloatArray,
    velocity: FloatArray,
) -> bool:
    """Take from the bounds of a `Room` what a step may have taken; whether one is used up.

    Poses (N, 3) at both samples, headings unwrapped; ``radius`` (N,) [m] about the reference
    points. ``velocity`` (N, 3) takes that of the step [m/s, rad/s]. What is farther apart at either
    sample than ``reach`` of the two does not touch in between. That of robots among themselves
    counts from how they moved on average: who drives side by side does not meet.
    """
    robots = len(old)
    mean_x, mean_y, most = 0.0, 0.0, 0.0
    for i in range(robots):
        dx, dy, turn = now[i, 0] - old[i, 0], now[i, 1] - old[i, 1], now[i, 2] - old[i, 2]
        velocity[i, 0], velocity[i, 1], velocity[i, 2] = dx / dt, dy / dt, turn / dt
        mean_x += dx
        mean_y += dy
        reach[0, i] = radius[i] * abs(turn) + MARGIN
        reach[1, i] = reach[0, i] + math.sqrt(dx * dx + dy * dy)
    mean_x, mean_y = mean_x / robots, mean_y / robots
    for i in range(robots):
        dx, dy = now[i, 0] - old[i, 0] - mean_x, now[i, 1] - old[i, 1] - mean_y
        reach[0, i] += math.sqrt(dx * dx + dy * dy)
        most = max(most, reach[0, i])
    is_used_up = False
    for i in range(robots):
        bound[0, i] -= reach[0, i] + most
        bound[1, i] -= reach[1, i]
        is_used_up |= bound[0, i] <= 0.0 or bound[1, i] <= 0.0
    return is_used_up


@compiled
def find_swept_contacts(
    old: FloatArray,
    now: FloatArray,
    shapes: Shapes,
    wall_tree: WallTree,
    room: Room,
    dt: float,
    who: IntArray,
    values: FloatArray,
) -> int:
    """Write a row for each pair that is apart at both samples of a step and touches in between.

    Poses (N, 3); robots whose bound in ``room`` is used up are measured anew. ``who`` (C, 2) takes
    the bodies a < b (walls from N on), ``values`` (C, 5) what `describe_pair` gives. Returns how
    many, or FULL.
    """
    robots, reach, still, count, m = len(old), room.reach, np.zeros(3), 0, 0
    walls, ends = wall_tree.walls, wall_tree.walls.body_start
    pairs, near = pairs_in_reach(now, shapes, room), walls_in_reach(now, shapes, wall_tree, room)
    for a in range(robots):
        while m < len(pairs) and pairs[m] // robots == a:
            b, most = pairs[m] % robots, reach[0, a] + reach[0, pairs[m] % robots]
            m += 1
            if not grazes(shapes, a, old[a], now[a], shapes, b, old[b], now[b], most, dt):
                continue
            if count == len(who):
                return FULL
            time = least_gap(shapes, a, old[a], now[a], shapes, b, old[b], now[b], dt).time
            who[count, 0], who[count, 1] = a, b
            describe_pair(
                shapes, a, between(old[a], now[a], time / dt),
                shapes, b, between(old[b], now[b], time / dt), values[count],
            )  # fmt: skip
            count += 1
        if near[a]:
            last, w, most = -1, 0, reach[1, a]
            for part in parts_near(wall_tree, now[a, 0], now[a, 1], shapes.radius[a] + most):
                while ends[w + 1] <= part:
                    w += 1
                if w == last:
                    continue
                last = w
                if not grazes(walls, w, still, still, shapes, a, old[a], now[a], most, dt):
                    continue
                if count == len(who):
                    return FULL
                time = least_gap(walls, w, still, still, shapes, a, old[a], now[a], dt).time
                who[count, 0], who[count, 1] = a, robots + w
                at = between(old[a], now[a], time / dt)
                describe_pair(shapes, a, at, walls, w, still, values[count])
                count += 1
    return count


@compiled
def grazes(
    shapes_a: Shapes,
    i: int,
    start_i: FloatArray,
    end_i: FloatArray,
    shapes_b: Shapes,
    j: int,
    start_j: FloatArray,
    end_j: FloatArray,
    most: float,
    dt: float,
) -> bool:
    """Whether bodies apart at both ends of a step, which moves them by ``most``, touch in it."""
    f = relative_frame(end_i, end_j)
    after = body_gap(shapes_a, i, shapes_b, j, f, most + MARGIN)
    if after <= CONTACT or after > most:
        return False
    before = body_gap(shapes_a, i, shapes_b, j, relative_frame(start_i, start_j), most + MARGIN)
    if before <= CONTACT or before + after > most:
        return False
    return swept_time(shapes_a, i, start_i, end_i, shapes_b, j, start_j, end_j, dt) < np.inf


@compiled
def pairs_in_reach(now: FloatArray, shapes: Shapes, room: Room) -> IntArray:
    """Pairs that may touch within a step, apart at its end: a N + b with a < b, increasing.

    Robots whose bounds are used up are measured against those about them.
    """
    robots, discs, order = len(now), room.discs, room.order
    bound, reach = room.bound[0], room.reach[0]
    pairs, count = np.empty(16, dtype=np.int64), 0
    if not (bound <= 0.0).any():
        return pairs[:0]
    frame, far = np.empty((robots, 6)), AHEAD * 2.0 * reach.max()
    is_due = bound <= 0.25 * far  # and those that would be soon: together it costs less
    set_frames(now, discs, frame)
    for p in range(1, robots):  # by insertion: little has changed
        row, q = order[p], p
        while q > 0 and frame[order[q - 1], 4] > frame[row, 4]:
            order[q] = order[q - 1]
            q -= 1
        order[q] = row
    for i in range(robots):
        if is_due[i]:
            bound[i] = far
    largest = discs.outer.max()
    for p in range(robots):
        i = order[p]
        for q in range(p + 1, robots):
            j = order[q]
            dx, dy = frame[j, 4] - frame[i, 4], frame[j, 5] - frame[i, 5]
            if dx > far + discs.outer[i] + largest:
                break
            limit = far + discs.outer[i] + discs.outer[j]
            if dx * dx + dy * dy > limit * limit or not (is_due[i] or is_due[j]):
                continue
            most = reach[i] + reach[j]
            enough = max(most, bound[i] if is_due[i] else 0.0, bound[j] if is_due[j] else 0.0)
            if line_gap(shapes, i, j, frame) >= enough:
                continue
            gap = pair_distance(shapes, i, j, frame)
            for k in (i, j):
                if is_due[k]:
                    bound[k] = min(bound[k], gap)
            if is_due[i] and is_due[j] and CONTACT < gap <= most:
                if count == len(pairs):
                    pairs = np.concatenate((pairs, pairs))
                pairs[count] = min(i, j) * robots + max(i, j)
                count += 1
    put_in_order(pairs, count)
    return pairs[:count]


@compiled
def walls_in_reach(
    now: FloatArray, shapes: Shapes, wall_tree: WallTree, room: Room
) -> NDArray[np.bool_]:
    """(N,) who may touch a wall within a step; who has used up its bound is measured anew."""
    bound, reach = room.bound[1], room.reach[1]
    near = np.zeros(len(now), dtype=np.bool_)
    sight = Sight(wall_tree, 0.0, 0.0, np.inf, room.walls)
    for i in range(len(now)):
        if bound[i] <= 4.0 * reach[i]:
            f = frame_at(math.cos(now[i, 2]), math.sin(now[i, 2]), now[i, 0], now[i, 1])
            bound[i] = nearest_seen(shapes, i, f, sight)[0]
            near[i] = bound[i] <= reach[i]
    return near


@compiled
def between(start: FloatArray, end: FloatArray, share: float) -> FloatArray:
    """Pose (3,) at a share of the way from one sample to the next."""
    return start + share * (end - start)
