"""What robots may know, as arrays of fixed sizes: what learners take in.

Row i is of Robot i and holds nothing but what its observation does: rows that it senses of robots
within range, and walls within range. Lengths are [m], times [s], angles [rad]. *Body frame*: origin
at the robot's own reference point as it senses it, x forward, y to the left.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from physim.compiled import compiled
from physim.errors import PhysimError
from physim.geometry.bodies import body_gap, frame_from, outline_distance, wall_gap
from physim.geometry.convex import frame_at
from physim.geometry.path import point_at
from physim.geometry.shapes import (
    Flags,
    FloatArray,
    IntArray,
    Part,
    Polylines,
    Rows2,
    Rows3,
    Rows7,
    Shapes,
)
from physim.geometry.walls import LEAF, WallTree, leaf_after
from physim.parts.controller import Sensed
from physim.world.scene import Scene

OWN = ("vx", "vy", "omega", "held_v", "held_omega", "limit_v", "limit_omega", "left", "deviation")
"""Columns of `Arrays.own` before the points ahead"""
OTHER = ("x", "y", "cos", "sin", "vx", "vy", "gap")
"""Columns of `Arrays.others`"""
WALL = ("x", "y", "gap")
"""Columns of `Arrays.walls`"""
MOST = 1000
"""Rows or points that may be asked for"""


class Arrays(NamedTuple):
    """What each of N robots may know, in fixed sizes; rows that there are not are 0.

    The arrays are the caller's own. All is in the robot's body frame: origin at its reference point
    as it senses it, x forward, y to the left. Angles are counter-clockwise.

    ``own`` (N, 9 + 2 A): what it did over the last step, ``vx``, ``vy`` [m/s] and ``omega``
    [rad/s]; the command that it holds, ``held_v`` [m/s], ``held_omega`` [rad/s]; its limits
    ``limit_v``, ``limit_omega``; way ``left`` along its path to its stop [m], negative past it;
    ``deviation`` [m] from the path, to the left positive; then x, y [m] of the A points ahead on
    its path.

    ``others`` (N, K, 7): the nearest robots and other bodies that move within range, by the
    distance of reference points, the nearest first: ``x``, ``y`` [m] of that point; ``cos``,
    ``sin`` of its heading less the own; ``vx``, ``vy`` [m/s], its velocity less the own; ``gap``
    [m], signed distance of the footprints, negative where they overlap. ``others_mask`` (N, K):
    which rows there are; these are first.

    ``walls`` (N, M, 3): the nearest pieces of walls within range of the reference point, the
    nearest first: ``x``, ``y`` [m] of the point of each that is nearest to the reference point;
    ``gap`` [m], signed distance of the footprint from the piece. ``walls_mask`` (N, M): as above.
    """

    own: NDArray[Any]
    others: NDArray[Any]
    others_mask: NDArray[np.bool_]
    walls: NDArray[Any]
    walls_mask: NDArray[np.bool_]


class Layout(NamedTuple):
    """Sizes that were asked for."""

    others: int
    walls: int
    ahead: FloatArray
    """(A,) [m]"""
    dtype: np.dtype[Any]


def layout_of(others: int, walls: int, ahead: Sequence[float], dtype: DTypeLike) -> Layout:
    """Check what is asked for. Raises PhysimError."""
    for name, value in (("others", others), ("walls", walls)):
        is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
        if not is_whole or not 0 <= value <= MOST:
            raise PhysimError(f"{name} = {value!r}; it must be a whole number from 0 to {MOST}")
    try:
        points = np.array(ahead, dtype=np.float64)
    except (TypeError, ValueError):
        points = np.full(1, np.nan)
    if points.ndim != 1 or len(points) > MOST or not (np.isfinite(points) & (points >= 0.0)).all():
        raise PhysimError(f"ahead = {ahead!r}; it must list distances in m, each at least 0")
    try:
        kind = np.dtype(dtype)
    except TypeError:
        kind = np.dtype(object)
    if kind not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise PhysimError(f"dtype = {dtype!r}; allowed: float32, float64")
    points.setflags(write=False)
    return Layout(int(others), int(walls), points, kind)


class Unchanging(NamedTuple):
    """What the arrays of all steps of a scene are made from."""

    shapes: Shapes
    walls: WallTree
    paths: Polylines
    limits: Rows2
    stop_station: FloatArray
    reach: float


def unchanging(scene: Scene) -> Unchanging:
    """What the kernel is handed at every step of a scene."""
    limits = np.ascontiguousarray(scene.limits[:, :2])
    return Unchanging(
        scene.shapes, scene.wall_tree, scene.paths, limits, scene.stop_station, scene.sensing_range
    )


def arrays_of(scene: Unchanging, sensed: Sensed, layout: Layout) -> Arrays:
    """Arrays of what is sensed; ``scene`` is what `unchanging` gave."""
    robots, (others, walls, ahead, dtype) = len(sensed.station), layout
    own = np.zeros((robots, len(OWN) + 2 * len(ahead)))
    near, met = np.zeros((robots, others, len(OTHER))), np.zeros((robots, walls, len(WALL)))
    near_mask, met_mask = np.zeros((robots, others), np.bool_), np.zeros((robots, walls), np.bool_)
    out = Written(
        own.reshape(-1), own.shape[1], near.reshape(-1, len(OTHER)), near_mask.reshape(-1), others,
        met.reshape(-1, len(WALL)), met_mask.reshape(-1), walls,
    )  # fmt: skip
    command = np.ascontiguousarray(sensed.command[:, :2])  # of omnidirectional robots there is more
    fill_arrays(
        scene, robots, sensed.robot, sensed.pose, command, sensed.velocity, sensed.first,
        sensed.end, sensed.station, ahead, len(ahead), out,
    )  # fmt: skip
    if dtype != own.dtype:
        own, near, met = own.astype(dtype), near.astype(dtype), met.astype(dtype)
    return Arrays(own, near, near_mask, met, met_mask)


class Written(NamedTuple):
    """The fields of `Arrays`, robot by robot, and how many rows or numbers each has."""

    own: FloatArray
    columns: int
    others: Rows7
    others_mask: Flags
    most_others: int
    walls: Rows3
    walls_mask: Flags
    most_walls: int


@compiled
def fill_arrays(
    scene: Unchanging,
    robots: int,
    robot: IntArray,
    pose: Rows3,
    command: Rows2,
    velocity: Rows3,
    first: IntArray,
    end: IntArray,
    station: FloatArray,
    ahead: FloatArray,
    points: int,
    out: Written,
) -> None:
    """Write `Arrays` of all robots from the fields of `Sensed`; so many ``points`` are ahead."""
    most = max(out.most_others, out.most_walls)
    which, far = np.empty(most, np.int64), np.empty(most)
    for i in range(robots):
        me = first[i]
        while robot[me] != i:
            me += 1
        c, s = math.cos(pose[me, 2]), math.sin(pose[me, 2])
        row = out.own[out.columns * i :]
        put_own(scene, i, pose[me], c, s, command[me], velocity[me], station[i], ahead, points, row)
        count, begin = 0, out.most_others * i
        for j in range(first[i], end[i]):
            dx, dy = pose[j, 0] - pose[me, 0], pose[j, 1] - pose[me, 1]
            square = dx * dx + dy * dy
            if j != me and square <= scene.reach * scene.reach:
                count = keep_nearest(j, square, which, far, count, out.most_others)
        for k in range(count):
            j = which[k]
            dx, dy = pose[j, 0] - pose[me, 0], pose[j, 1] - pose[me, 1]
            vx, vy = velocity[j, 0] - velocity[me, 0], velocity[j, 1] - velocity[me, 1]
            f = frame_from(pose[me], c, s, pose[j])
            other = out.others[begin + k]
            other[0], other[1] = c * dx + s * dy, c * dy - s * dx
            other[2], other[3] = f.c, f.s
            other[4], other[5] = c * vx + s * vy, c * vy - s * vx
            other[6] = body_gap(scene.shapes, i, scene.shapes, robot[j], f)
            out.others_mask[begin + k] = True
        if out.most_walls > 0:
            put_walls(scene, i, pose[me], c, s, which, far, out)


@compiled
def put_own(
    scene: Unchanging,
    i: int,
    pose: FloatArray,
    c: float,
    s: float,
    command: FloatArray,
    velocity: FloatArray,
    station: float,
    ahead: FloatArray,
    points: int,
    row: FloatArray,
) -> None:
    """Write the row of `Arrays.own` of Robot i; (c, s) are cosine and sine of its heading."""
    vx, vy = velocity[0], velocity[1]
    row[0], row[1], row[2] = c * vx + s * vy, c * vy - s * vx, velocity[2]
    row[3], row[4] = command[0], command[1]
    row[5], row[6] = scene.limits[i, 0], scene.limits[i, 1]
    row[7] = scene.stop_station[i] - station
    x, y, tx, ty = point_at(scene.paths, i, station)
    row[8] = tx * (pose[1] - y) - ty * (pose[0] - x)
    for k in range(points):
        x, y, _, _ = point_at(scene.paths, i, station + ahead[k])
        dx, dy = x - pose[0], y - pose[1]
        row[9 + 2 * k], row[10 + 2 * k] = c * dx + s * dy, c * dy - s * dx


@compiled
def keep_nearest(
    one: int, far: float, which: IntArray, fars: FloatArray, count: int, most: int
) -> int:
    """Put one among the nearest so far, ``most`` at most, in their order; how many there are then.

    Of equally far ones the lower number is nearer.
    """
    if count == most:
        if (
            count == 0
            or far > fars[count - 1]
            or (far == fars[count - 1] and one > which[count - 1])
        ):
            return count
        count -= 1
    k = count
    while k > 0 and (fars[k - 1] > far or (fars[k - 1] == far and which[k - 1] > one)):
        which[k], fars[k] = which[k - 1], fars[k - 1]
        k -= 1
    which[k], fars[k] = one, far
    return count + 1


@compiled
def put_walls(
    scene: Unchanging,
    i: int,
    pose: FloatArray,
    c: float,
    s: float,
    which: IntArray,
    far: FloatArray,
    out: Written,
) -> None:
    """Write the rows of `Arrays.walls` of Robot i; ``which`` (M,) and ``far`` are room for work."""
    tree, W, start = scene.walls, scene.walls.walls.vertices, scene.walls.walls.part_start
    count, reach = 0, scene.reach
    leaf = leaf_after(tree, 0, pose[0], pose[1], reach)
    while leaf:
        begin = (leaf - tree.leaves) * LEAF
        for k in range(begin, min(begin + LEAF, tree.parts)):
            part = tree.part[k]
            apart = outline_distance(Part(W, start[part], start[part + 1]), pose[0], pose[1])
            if apart <= reach:
                count = keep_nearest(part, apart, which, far, count, out.most_walls)
                if count == out.most_walls:
                    reach = far[count - 1]
        leaf = leaf_after(tree, leaf, pose[0], pose[1], reach)
    f = frame_at(c, s, pose[0], pose[1])
    for k in range(count):
        wall = Part(W, start[which[k]], start[which[k] + 1])
        x, y = nearest_point(wall, pose[0], pose[1])
        at = out.most_walls * i + k
        out.walls[at, 0] = c * (x - pose[0]) + s * (y - pose[1])
        out.walls[at, 1] = c * (y - pose[1]) - s * (x - pose[0])
        out.walls[at, 2] = wall_gap(wall, scene.shapes, i, f, np.inf)
        out.walls_mask[at] = True


@compiled
def nearest_point(wall: Part, x: float, y: float) -> tuple[float, float]:
    """Point of a part's outline nearest to (x, y)."""
    V, best, px, py = wall.vertices, np.inf, x, y
    for k in range(wall.first, wall.end):
        m = k + 1 if k + 1 < wall.end else wall.first
        ex, ey = V[m, 0] - V[k, 0], V[m, 1] - V[k, 1]
        dx, dy = x - V[k, 0], y - V[k, 1]
        size, share = ex * ex + ey * ey, 0.0
        if size > 0.0:
            share = min(1.0, max(0.0, (ex * dx + ey * dy) / size))
        ox, oy = dx - share * ex, dy - share * ey
        if ox * ox + oy * oy < best:
            best, px, py = ox * ox + oy * oy, x - ox, y - oy
    return px, py
