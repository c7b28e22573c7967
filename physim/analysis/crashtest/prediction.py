"""Contacts of the cases of a batch as analysis predicts them, by kernels without the engine."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.analysis.crashtest.case import STEPS
from physim.analysis.crashtest.drawing import Batch
from physim.compiled import compiled, is_cached
from physim.geometry.collision import collision_time_pair, collision_time_walls
from physim.geometry.motion import arc
from physim.geometry.separation import body_separation, wall_separation
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.geometry.swept import swept_pair, swept_walls
from physim.tolerances import CONTACT, ROUNDING

MOST_RENEWED = 2000
"""How often a search for a collision time that reached its cap is taken up again."""


class Prediction(NamedTuple):
    """Analysis of M cases; every motion is the exact arc from the start."""

    time: FloatArray
    """(M,) collision time xi [s] within the case, inf when there is none"""
    renewed: IntArray
    """(M,) how often the search reached its cap and went on from the lower bound it gave"""
    distance: FloatArray
    """(M, STEPS + 1) [m] signed distance at each sample"""


class Approach(NamedTuple):
    """How the shapes of M cases come to touch, about given times."""

    gap: FloatArray
    """(M,) [m] signed distance then; NaN where there is no time"""
    closing: FloatArray
    """(M,) [m/s] least closing speed at that time and at the swept contact; NaN without either"""
    swept: FloatArray
    """(M,) [s] first contact where poses go linearly from sample to sample, as the engine's do,
    looked for in the step of that time and its neighbours; inf when there is none"""
    swept_gap: FloatArray
    """(M,) [m] signed distance on the exact arcs at the swept contact; NaN without one"""


class PackedCase(NamedTuple):
    """One case, for the kernels: robots ``first`` to ``last - 1`` and wall parts."""

    shapes: Shapes
    walls: Shapes
    parts: IntArray
    start: FloatArray
    command: FloatArray
    first: int
    last: int
    dt: float


def predict(batch: Batch) -> Prediction:
    """Collision time and distances of every case."""
    return Prediction(*_predict(*_arrays(batch), batch.dt, STEPS))


def approach(batch: Batch, time: FloatArray) -> Approach:
    """How every case stands at its time [s] (M,); nothing where that is inf."""
    return Approach(*_approach(*_arrays(batch), batch.dt, STEPS, time))


def _arrays(
    batch: Batch,
) -> tuple[Shapes, Shapes, FloatArray, FloatArray, IntArray, IntArray]:
    return (
        batch.shapes, batch.walls, batch.start, batch.command,
        batch.first_robot, batch.first_wall,
    )  # fmt: skip


@compiled
def _case(
    shapes: Shapes,
    walls: Shapes,
    start: FloatArray,
    command: FloatArray,
    first_robot: IntArray,
    first_wall: IntArray,
    dt: float,
    k: int,
) -> PackedCase:
    parts = np.arange(walls.body_start[first_wall[k]], walls.body_start[first_wall[k + 1]])
    return PackedCase(shapes, walls, parts, start, command, first_robot[k], first_robot[k + 1], dt)


@compiled
def poses_at(case: PackedCase, t: float) -> FloatArray:
    """Poses of the robots of a case on their arcs."""
    pose = np.empty((case.last - case.first, 3))
    for i in range(case.first, case.last):
        pose[i - case.first] = arc(case.start[i], case.command[i, 0], case.command[i, 1], t)
    return pose


@compiled
def point_speed(
    pose: FloatArray, command: FloatArray, x: float, y: float, nx: float, ny: float
) -> float:
    """Speed [m/s] along (nx, ny) of the point (x, y) fixed to a robot."""
    v = command[0]
    omega = command[1]
    vx = v * math.cos(pose[2]) - omega * (y - pose[1])
    vy = v * math.sin(pose[2]) + omega * (x - pose[0])
    return float(vx * nx + vy * ny)


@compiled
def state_at(case: PackedCase, t: float) -> tuple[float, float]:
    """Signed distance [m] of a case, and closing speed [m/s] of its closest points."""
    shapes, command, first = case.shapes, case.command, case.first
    pose = poses_at(case, t)
    best = np.inf
    closing = 0.0
    for i in range(first, case.last):
        one = pose[i - first]
        if len(case.parts):
            d, nx, ny, ax, ay, _, _ = wall_separation(shapes, i, one, case.walls, case.parts)
            if d < best:
                best = d
                closing = point_speed(one, command[i], ax, ay, nx, ny)
        for j in range(i + 1, case.last):
            two = pose[j - first]
            d, nx, ny, ax, ay, bx, by = body_separation(shapes, i, one, shapes, j, two)
            if d < best:
                best = d
                closing = point_speed(one, command[i], ax, ay, nx, ny)
                closing -= point_speed(two, command[j], bx, by, nx, ny)
    return best, closing


@compiled
def time_from(case: PackedCase, since: float, horizon: float) -> float:
    """Collision time [s] counted from ``since``, up to the horizon."""
    shapes, command, first = case.shapes, case.command, case.first
    pose = poses_at(case, since)
    found = np.inf
    for i in range(first, case.last):
        one = pose[i - first]
        twist = (command[i, 0], command[i, 1])
        if len(case.parts):
            xi = collision_time_walls(shapes, i, one, twist, case.walls, case.parts, horizon)
            found = min(found, xi)
        for j in range(i + 1, case.last):
            two = pose[j - first]
            other = (command[j, 0], command[j, 1])
            xi = collision_time_pair(shapes, i, one, twist, j, two, other, horizon)
            found = min(found, xi)
    return found


@compiled
def collision_time_of(case: PackedCase, horizon: float) -> tuple[float, int]:
    """Collision time [s] of a case, and how often the search went on from a lower bound.

    A search that reaches its cap gives a lower bound, at which the shapes are still apart.
    """
    time = 0.0
    for renewed in range(MOST_RENEWED):
        time += time_from(case, time, horizon - time)
        if time == np.inf or state_at(case, time)[0] <= CONTACT + ROUNDING:
            return time, renewed
    return time, MOST_RENEWED


@compiled
def swept_step(case: PackedCase, step: int) -> float:
    """Time of the first contact in a step [s after its first sample], inf when there is none."""
    first = case.first
    before = poses_at(case, step * case.dt)
    after = poses_at(case, (step + 1) * case.dt)
    found = np.inf
    for i in range(first, case.last):
        a, b = before[i - first], after[i - first]
        if len(case.parts):
            t, _ = swept_walls(case.shapes, i, a, b, case.walls, case.parts, case.dt)
            found = min(found, t)
        for j in range(i + 1, case.last):
            c, d = before[j - first], after[j - first]
            found = min(found, swept_pair(case.shapes, i, a, b, j, c, d, case.dt))
    return found


@compiled
def _predict(
    shapes: Shapes,
    walls: Shapes,
    start: FloatArray,
    command: FloatArray,
    first_robot: IntArray,
    first_wall: IntArray,
    dt: float,
    steps: int,
) -> tuple[FloatArray, IntArray, FloatArray]:
    """Arrays of a `Prediction`."""
    cases = len(first_robot) - 1
    time = np.empty(cases)
    renewed = np.empty(cases, np.int64)
    distance = np.empty((cases, steps + 1))
    for k in range(cases):
        case = _case(shapes, walls, start, command, first_robot, first_wall, dt, k)
        time[k], renewed[k] = collision_time_of(case, steps * dt)
        for n in range(steps + 1):
            distance[k, n] = state_at(case, n * dt)[0]
    return time, renewed, distance


@compiled
def _approach(
    shapes: Shapes,
    walls: Shapes,
    start: FloatArray,
    command: FloatArray,
    first_robot: IntArray,
    first_wall: IntArray,
    dt: float,
    steps: int,
    time: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Arrays of an `Approach`."""
    cases = len(time)
    gap = np.full(cases, np.nan)
    closing = np.full(cases, np.nan)
    swept = np.full(cases, np.inf)
    swept_gap = np.full(cases, np.nan)
    for k in range(cases):
        if not time[k] < np.inf:
            continue
        case = _case(shapes, walls, start, command, first_robot, first_wall, dt, k)
        gap[k], speed = state_at(case, time[k])
        near = int(time[k] / dt)
        for n in range(max(0, near - 1), min(near + 2, steps)):
            t = swept_step(case, n)
            if t < np.inf:
                swept[k] = n * dt + t
                swept_gap[k], later = state_at(case, swept[k])
                closing[k] = min(speed, later)
                break
    return gap, closing, swept, swept_gap


def is_warm() -> bool:
    """Whether the kernels of a crash test lie compiled on disk; `approach` comes last."""
    return is_cached(_approach)
