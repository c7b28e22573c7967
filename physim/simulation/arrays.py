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

from physim.compiled import compiled, direct
from physim.errors import PhysimError
from physim.geometry.bodies import body_gap, frame_from, outline_distance, wall_gap
from physim.geometry.convex import frame_at
from physim.geometry.path import point_at
from physim.geometry.shapes import FloatArray, IntArray, Part, Polylines, Shapes
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

    The arrays are the caller's own.
    """

    own: NDArray[Any]
    """(N, 9 + 2 A): what it did over the last step, ``vx``, ``vy`` [m/s] in its body frame and
    ``omega`` [rad/s]; the command that it holds, ``held_v``, ``held_omega``; its limits
    ``limit_v``, ``limit_omega``; way ``left`` along its path to its stop [m]; ``deviation`` [m]
    from the path, to the left positive; then x, y [m] of the A points ahead on its path"""
    others: NDArray[Any]
    """(N, K, 7): the nearest robots within range, by the distance of reference points: ``x``, ``y``
    [m] of that point; ``cos``, ``sin`` of its heading less the own; ``vx``, ``vy`` [m/s], its
    velocity less the own; ``gap``, signed distance of the footprints [m]. All in the body frame"""
    others_mask: NDArray[np.bool_]
    """(N, K) which rows there are; these are first"""
    walls: NDArray[Any]
    """(N, M, 3): the nearest parts of walls within range: ``x``, ``y`` [m] of the point of each
    that is nearest to the reference point, in the body frame; ``gap``, signed distance of the
    footprint from the part [m]"""
    walls_mask: NDArray[np.bool_]
    """(N, M)"""


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
    limits: FloatArray
    stop_station: FloatArray
    reach: float


def unchanging(scene: Scene) -> tuple[Any, Any]:
    """The kernel, and what it is handed at every step of a scene."""
    from physim.kept import kept  # which imports numba: not before a run

    one = Unchanging(
        scene.shapes, scene.wall_tree, scene.paths, scene.limits, scene.stop_station,
        scene.sensing_range,
    )  # fmt: skip
    return direct(fill), kept(one)


def arrays_of(prepared: tuple[Any, Any], sensed: Sensed, layout: Layout) -> Arrays:
    """Arrays of what is sensed; ``prepared`` is what `unchanging` gave."""
    kernel, scene = prepared
    robots, (others, walls, ahead, dtype) = len(sensed.station), layout
    own = np.zeros((robots, len(OWN) + 2 * len(ahead)))
    near, met = np.zeros((robots, others, len(OTHER))), np.zeros((robots, walls, len(WALL)))
    near_mask, met_mask = np.zeros((robots, others), np.bool_), np.zeros((robots, walls), np.bool_)
    kernel(
        scene, sensed.robot, sensed.pose, sensed.command, sensed.velocity, sensed.first, sensed.end,
        sensed.station, ahead, own, near, near_mask, met, met_mask,
    )  # fmt: skip
    if dtype != own.dtype:
        own, near, met = own.astype(dtype), near.astype(dtype), met.astype(dtype)
    return Arrays(own, near, near_mask, met, met_mask)


@compiled
def fill(
    kept: list[Unchanging],
    robot: IntArray,
    pose: FloatArray,
    command: FloatArray,
    velocity: FloatArray,
    first: IntArray,
    end: IntArray,
    station: FloatArray,
    ahead: FloatArray,
    own: FloatArray,
    others: FloatArray,
    others_mask: NDArray[np.bool_],
    walls: FloatArray,
    walls_mask: NDArray[np.bool_],
) -> None:
    """Write `Arrays` of all robots from the fields of `Sensed`."""
    scene = kept[0]
    most = max(others.shape[1], walls.shape[1])
    which, far = np.empty(most, dtype=np.int64), np.empty(most)
    for i in range(len(station)):
        me = first[i]
        while robot[me] != i:
            me += 1
        c, s = math.cos(pose[me, 2]), math.sin(pose[me, 2])
        put_own(scene, i, pose[me], c, s, command[me], velocity[me], station[i], ahead, own[i])
        count = 0
        for j in range(first[i], end[i]):
            dx, dy = pose[j, 0] - pose[me, 0], pose[j, 1] - pose[me, 1]
            square = dx * dx + dy * dy
            if j != me and square <= scene.reach * scene.reach:
                count = keep_nearest(j, square, which[: others.shape[1]], far, count)
        for k in range(count):
            j, row = which[k], others[i, k]
            dx, dy = pose[j, 0] - pose[me, 0], pose[j, 1] - pose[me, 1]
            vx, vy = velocity[j, 0] - velocity[me, 0], velocity[j, 1] - velocity[me, 1]
            f = frame_from(pose[me], c, s, pose[j])
            row[0], row[1] = c * dx + s * dy, c * dy - s * dx
            row[2], row[3] = f.c, f.s
            row[4], row[5] = c * vx + s * vy, c * vy - s * vx
            row[6] = body_gap(scene.shapes, i, scene.shapes, robot[j], f)
            others_mask[i, k] = True
        if walls.shape[1]:
            put_walls(
                scene, i, pose[me], c, s, which[: walls.shape[1]], far, walls[i], walls_mask[i]
            )


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
    for k in range(len(ahead)):
        x, y, _, _ = point_at(scene.paths, i, station + ahead[k])
        dx, dy = x - pose[0], y - pose[1]
        row[9 + 2 * k], row[10 + 2 * k] = c * dx + s * dy, c * dy - s * dx


@compiled
def keep_nearest(one: int, far: float, which: IntArray, fars: FloatArray, count: int) -> int:
    """Put one among the nearest so far, in their order; how many there are then.

    Of equally far ones the lower number is nearer.
    """
    if count == len(which):
        if (
            not count
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
    rows: FloatArray,
    mask: NDArray[np.bool_],
) -> None:
    """Write the rows of `Arrays.walls` of Robot i; ``which`` (M,) and ``far`` are room for work."""
    tree, W, start = scene.walls, scene.walls.walls.vertices, scene.walls.walls.part_start
    count, reach = 0, scene.reach
    leaf = leaf_after(tree, 0, pose[0], pose[1], reach)
    while leaf:
        begin = (leaf - tree.leaves) * LEAF
        for k in range(begin, min(begin + LEAF, len(tree.part))):
            part = tree.part[k]
            apart = outline_distance(Part(W, start[part], start[part + 1]), pose[0], pose[1])
            if apart <= reach:
                count = keep_nearest(part, apart, which, far, count)
                if count == len(which):
                    reach = far[count - 1]
        leaf = leaf_after(tree, leaf, pose[0], pose[1], reach)
    f = frame_at(c, s, pose[0], pose[1])
    for k in range(count):
        wall = Part(W, start[which[k]], start[which[k] + 1])
        x, y = nearest_point(wall, pose[0], pose[1])
        rows[k, 0] = c * (x - pose[0]) + s * (y - pose[1])
        rows[k, 1] = c * (y - pose[1]) - s * (x - pose[0])
        rows[k, 2] = wall_gap(wall, scene.shapes, i, f, np.inf)
        mask[k] = True


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
