"""Swept contacts: bodies that touch between two samples and are apart at both.

From one sample to the next position and angle go linearly, as the physics moves its bodies. Only
robots near enough to something to reach it within the step are looked at.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

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
from physim.geometry.shapes import (
    Flags,
    FloatArray,
    IntArray,
    IntRows2,
    Rows3,
    Rows5,
    Shapes,
)
from physim.geometry.swept import least_gap, swept_time
from physim.geometry.walls import (
    NearestWalls,
    Parts,
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


class KnownRoom(NamedTuple):
    """Lower bounds of how far each of N robots is from others, and what a search knows of them."""

    apart: FloatArray
    """(N,) [m] distance from other robots; 0 or less: not known"""
    from_walls: FloatArray
    """(N,) likewise from walls"""
    reach: FloatArray
    """(N,) [m] how much a robot's own part in a step changes its distance from others, at most"""
    wall_reach: FloatArray
    """(N,) likewise from walls"""
    discs: BoundingDiscs
    order: IntArray
    """(N,) robots by the x of the middles of their discs"""
    walls: NearestWalls
    goes_on: Flags
    """(N,) which of them are movers, which meet neither each other nor walls"""
    robots: int


def no_room(shapes: Shapes, goes_on: Flags | None = None) -> KnownRoom:
    """Nothing is known of the bodies of these shapes, of which those that ``goes_on`` are movers.

    What is said of robots here is true of all bodies that move.
    """
    robots = len(shapes.radius)
    apart, from_walls, reach, wall_reach = np.zeros((4, robots))
    movers = np.zeros(robots, np.bool_) if goes_on is None else goes_on
    return KnownRoom(
        apart, from_walls, reach, wall_reach, bounding_discs(shapes), np.arange(robots),
        nearest_walls(robots), movers, robots,
    )  # fmt: skip


@compiled
def wear_off(
    old: Rows3, now: Rows3, dt: float, radius: FloatArray, room: KnownRoom, velocity: Rows3
) -> bool:
    """Take from the bounds of ``room`` what a step may have taken; whether one is used up.

    Poses (N, 3) at both samples, headings unwrapped; ``radius`` (N,) [m] about the reference
    points. ``velocity`` (N, 3) takes that of the step [m/s, rad/s]. What is farther apart at either
    sample than the reach of the two does not touch in between. That of robots among themselves
    counts from how they moved on average: who drives side by side does not meet.
    """
    robots, reach, wall_reach = room.robots, room.reach, room.wall_reach
    mean_x, mean_y, most = 0.0, 0.0, 0.0
    for i in range(robots):
        dx, dy, turn = now[i, 0] - old[i, 0], now[i, 1] - old[i, 1], now[i, 2] - old[i, 2]
        velocity[i, 0], velocity[i, 1], velocity[i, 2] = dx / dt, dy / dt, turn / dt
        mean_x += dx
        mean_y += dy
        reach[i] = radius[i] * abs(turn) + MARGIN
        wall_reach[i] = reach[i] + math.sqrt(dx * dx + dy * dy)
    mean_x, mean_y = mean_x / robots, mean_y / robots
    for i in range(robots):
        dx, dy = now[i, 0] - old[i, 0] - mean_x, now[i, 1] - old[i, 1] - mean_y
        reach[i] += math.sqrt(dx * dx + dy * dy)
        most = max(most, reach[i])
    is_used_up = False
    for i in range(robots):
        room.apart[i] -= reach[i] + most
        room.from_walls[i] -= wall_reach[i]
        if room.apart[i] <= 0.0 or room.from_walls[i] <= 0.0:
            is_used_up = True
    return is_used_up


class SweptRows(NamedTuple):
    """Where rows of contacts are written."""

    who: IntRows2
    """(C, 2) bodies a < b"""
    values: Rows5
    """(C, 5) what `describe_pair` gives"""
    room: int
    """C"""


@compiled
def find_swept_contacts(
    old: Rows3,
    now: Rows3,
    shapes: Shapes,
    wall_tree: WallTree,
    room: KnownRoom,
    dt: float,
    out: SweptRows,
) -> int:
    """Write a row for each pair that is apart at both samples of a step and touches in between.

    Poses (N, 3); robots whose bound in ``room`` is used up are measured anew. Walls are bodies from
    N on. Returns how many, or FULL.
    """
    robots, still, count, m = room.robots, np.zeros(3), 0, 0
    stretch = np.zeros(2, np.int64)
    walls, ends = wall_tree.walls, wall_tree.walls.body_start
    near, at, there = np.zeros(robots, np.bool_), np.zeros(3), np.zeros(3)
    pairs = pairs_in_reach(now, shapes, room)
    put_walls_in_reach(now, shapes, wall_tree, room, near)
    for a in range(robots):
        while m < pairs.size and pairs.number[m] // robots == a:
            b = pairs.number[m] % robots
            most = room.reach[a] + room.reach[b]
            m += 1
            if not grazes(shapes, a, old[a], now[a], shapes, b, old[b], now[b], most, dt):
                continue
            if count == out.room:
                return FULL
            least = least_gap(shapes, a, old[a], now[a], shapes, b, old[b], now[b], dt)
            put_between(old[a], now[a], least.time / dt, at)
            put_between(old[b], now[b], least.time / dt, there)
            out.who[count, 0], out.who[count, 1] = a, b
            describe_pair(shapes, a, at, shapes, b, there, out.values[count])
            count += 1
        if not near[a]:
            continue
        n, w, most = 0, 0, room.wall_reach[a]
        found = parts_near(wall_tree, now[a, 0], now[a, 1], shapes.radius[a] + most, room.walls)
        while n < found.size:  # of one wall after the other what lies about the robot
            while ends[w + 1] <= found.number[n]:
                w += 1
            stretch[0] = found.number[n]
            while n < found.size and found.number[n] < ends[w + 1]:
                stretch[1] = found.number[n] + 1
                n += 1
            some = Shapes(walls.vertices, walls.part_start, stretch, walls.radius[w:])
            if not grazes(some, 0, still, still, shapes, a, old[a], now[a], most, dt):
                continue
            if count == out.room:
                return FULL
            least = least_gap(some, 0, still, still, shapes, a, old[a], now[a], dt)
            put_between(old[a], now[a], least.time / dt, at)
            out.who[count, 0], out.who[count, 1] = a, robots + w
            describe_pair(shapes, a, at, walls, w, still, out.values[count])
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
def pairs_in_reach(now: Rows3, shapes: Shapes, room: KnownRoom) -> Parts:
    """Pairs that may touch within a step, apart at its end: a N + b with a < b, increasing.

    Robots whose bounds are used up are measured against those about them.
    """
    robots, discs, order, bound, reach = room.robots, room.discs, room.order, room.apart, room.reach
    size, count, is_used_up, widest, largest = 16, 0, False, 0.0, 0.0
    pairs, is_due, frame = (
        np.empty(size, np.int64),
        np.zeros(robots, np.bool_),
        np.empty((robots, 6)),
    )
    for i in range(robots):
        widest, largest = max(widest, reach[i]), max(largest, discs.outer[i])
        if bound[i] <= 0.0:
            is_used_up = True
    if not is_used_up:
        return Parts(pairs, 0)
    far = AHEAD * 2.0 * widest
    for i in range(robots):  # and those that would be soon: together it costs less
        is_due[i] = bound[i] <= 0.25 * far
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
            if room.goes_on[i] and room.goes_on[j]:
                continue
            most = reach[i] + reach[j]
            enough = max(most, bound[i] if is_due[i] else 0.0, bound[j] if is_due[j] else 0.0)
            if line_gap(shapes, i, j, frame) >= enough:
                continue
            gap = pair_distance(shapes, i, j, frame)
            if is_due[i]:
                bound[i] = min(bound[i], gap)
            if is_due[j]:
                bound[j] = min(bound[j], gap)
            if is_due[i] and is_due[j] and CONTACT < gap <= most:
                if count == size:
                    size *= 2
                    more = np.empty(size, np.int64)
                    for k in range(count):
                        more[k] = pairs[k]
                    pairs = more
                pairs[count] = min(i, j) * robots + max(i, j)
                count += 1
    put_in_order(pairs, count)
    return Parts(pairs, count)


@compiled
def put_walls_in_reach(
    now: Rows3, shapes: Shapes, wall_tree: WallTree, room: KnownRoom, near: Flags
) -> None:
    """Write into ``near`` (N,) who may touch a wall within a step.

    Who has used up its bound is measured anew.
    """
    bound, reach = room.from_walls, room.wall_reach
    sight = Sight(wall_tree, 0.0, 0.0, np.inf, room.walls)
    for i in range(room.robots):
        if room.goes_on[i]:
            bound[i] = np.inf
        elif bound[i] <= 4.0 * reach[i]:
            f = frame_at(math.cos(now[i, 2]), math.sin(now[i, 2]), now[i, 0], now[i, 1])
            bound[i], _ = nearest_seen(shapes, i, f, sight)
            near[i] = bound[i] <= reach[i]


@compiled
def put_between(start: FloatArray, end: FloatArray, share: float, out: FloatArray) -> None:
    """Write the pose (3,) at a share of the way from one sample to the next."""
    for k in range(3):
        out[k] = start[k] + share * (end[k] - start[k])
