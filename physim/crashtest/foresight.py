"""What the analytic checks say of the cases of a batch, by kernels that never see the engine."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.crashtest.batch import Batch
from physim.crashtest.case import STEPS
from physim.geometry.collision import collision_time_pair, collision_time_walls
from physim.geometry.motion import arc
from physim.geometry.separation import body_separation, wall_separation
from physim.geometry.swept import swept_pair, swept_walls
from physim.geometry.shapes import FloatArray, IntArray, Shapes


class Foresight(NamedTuple):
    """Analysis of M cases; every motion is the exact arc from the start."""

    time: FloatArray
    """(M,) collision time xi [s] within the throw, inf when there is none"""
    gap: FloatArray
    """(M,) [m] signed distance at xi; NaN when there is none"""
    closing: FloatArray
    """(M,) [m/s] how fast the shapes close at xi, negative: part; NaN when there is none"""
    swept: FloatArray
    """(M,) [s] first contact where poses go linearly from sample to sample, as the engine's do,
    looked for in the steps about xi; inf when there is none"""
    distance: FloatArray
    """(M, STEPS + 1) [m] signed distance at each sample"""


def foresee(batch: Batch) -> Foresight:
    """Collision time and distances of every case."""
    still = batch.walls if len(batch.walls.part_start) > 1 else batch.shapes
    time, gap, closing, swept, distance = _foresee(
        batch.shapes, still, batch.start, batch.command,
        batch.first_robot, batch.first_wall, batch.dt, STEPS,
    )  # fmt: skip
    return Foresight(time, gap, closing, swept, distance)


@compiled
def _parts(walls: Shapes, first: int, last: int) -> IntArray:
    """Part numbers of the bodies first..last-1."""
    return np.arange(walls.body_start[first], walls.body_start[last])


@compiled
def point_velocity(
    pose: tuple[float, float, float], v: float, omega: float, x: float, y: float
) -> tuple[float, float]:
    """Velocity [m/s] of the point (x, y) fixed to a robot."""
    c = math.cos(pose[2])
    s = math.sin(pose[2])
    return v * c - omega * (y - pose[1]), v * s + omega * (x - pose[0])


@compiled
def _state(
    shapes: Shapes,
    walls: Shapes,
    parts: IntArray,
    start: FloatArray,
    command: FloatArray,
    first: int,
    last: int,
    t: float,
) -> tuple[float, float]:
    """Signed distance [m] of a case at time t and closing speed [m/s] at its closest points."""
    pose = np.empty((last - first, 3))
    for i in range(first, last):
        pose[i - first] = arc(start[i], command[i, 0], command[i, 1], t)
    best = np.inf
    closing = 0.0
    for i in range(first, last):
        if len(parts):
            d, nx, ny, ax, ay, _, _ = wall_separation(shapes, i, pose[i - first], walls, parts)
            if d < best:
                at = pose[i - first]
                ux, uy = point_velocity(
                    (at[0], at[1], at[2]), command[i, 0], command[i, 1], ax, ay
                )
                best = d
                closing = ux * nx + uy * ny
        for j in range(i + 1, last):
            one = pose[i - first]
            two = pose[j - first]
            d, nx, ny, ax, ay, bx, by = body_separation(shapes, i, one, shapes, j, two)
            if d < best:
                ux, uy = point_velocity(
                    (one[0], one[1], one[2]), command[i, 0], command[i, 1], ax, ay
                )
                wx, wy = point_velocity(
                    (two[0], two[1], two[2]), command[j, 0], command[j, 1], bx, by
                )
                best = d
                closing = (ux - wx) * nx + (uy - wy) * ny
    return best, closing


@compiled
def _swept(
    shapes: Shapes,
    walls: Shapes,
    parts: IntArray,
    start: FloatArray,
    command: FloatArray,
    first: int,
    last: int,
    step: int,
    dt: float,
) -> float:
    """Time of the first contact in a step [s after its first sample], inf when there is none."""
    before = np.empty((last - first, 3))
    after = np.empty((last - first, 3))
    for i in range(first, last):
        before[i - first] = arc(start[i], command[i, 0], command[i, 1], step * dt)
        after[i - first] = arc(start[i], command[i, 0], command[i, 1], (step + 1) * dt)
    found = np.inf
    for i in range(first, last):
        one = i - first
        if len(parts):
            t, _ = swept_walls(shapes, i, before[one], after[one], walls, parts, dt)
            found = min(found, t)
        for j in range(i + 1, last):
            two = j - first
            t = swept_pair(
                shapes, i, before[one], after[one], j, before[two], after[two], dt
            )
            found = min(found, t)
    return found


@compiled
def _foresee(
    shapes: Shapes,
    walls: Shapes,
    start: FloatArray,
    command: FloatArray,
    first_robot: IntArray,
    first_wall: IntArray,
    dt: float,
    steps: int,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Arrays of a `Foresight`."""
    cases = len(first_robot) - 1
    time = np.full(cases, np.inf)
    gap = np.full(cases, np.nan)
    closing = np.full(cases, np.nan)
    swept = np.full(cases, np.inf)
    distance = np.empty((cases, steps + 1))
    for k in range(cases):
        first = first_robot[k]
        last = first_robot[k + 1]
        parts = _parts(walls, first_wall[k], first_wall[k + 1])
        for i in range(first, last):
            twist = (command[i, 0], command[i, 1])
            if len(parts):
                xi = collision_time_walls(shapes, i, start[i], twist, walls, parts, steps * dt)
                time[k] = min(time[k], xi)
            for j in range(i + 1, last):
                other = (command[j, 0], command[j, 1])
                xi = collision_time_pair(
                    shapes, i, start[i], twist, j, start[j], other, steps * dt
                )
                time[k] = min(time[k], xi)
        if time[k] < np.inf:
            gap[k], closing[k] = _state(
                shapes, walls, parts, start, command, first, last, time[k]
            )
            near = int(time[k] / dt)
            for n in range(max(0, near - 1), min(near + 2, steps)):
                t = _swept(shapes, walls, parts, start, command, first, last, n, dt)
                if t < np.inf:
                    swept[k] = n * dt + t
                    break
        for n in range(steps + 1):
            distance[k, n], _ = _state(
                shapes, walls, parts, start, command, first, last, n * dt
            )
    return time, gap, closing, swept, distance
