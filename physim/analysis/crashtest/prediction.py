"""Contacts of the cases of a batch as analysis predicts them, by kernels without the engine."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.analysis.crashtest.cases import Packed
from physim.analysis.crashtest.drafts import STEPS
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
    """One case, for the kernels: robots ``first`` to ``last - 1``, two, or one and wall parts."""

    shapes: Shapes
    walls: Shapes
    parts: IntArray
    start: FloatArray
    command: FloatArray
    first: int
    last: int
    dt: float


@compiled
def packed_case(batch: Packed, k: int) -> PackedCase:
    """Case k of a batch."""
    bodies = batch.walls.body_start[batch.first_wall[k] : batch.first_wall[k + 1] + 1]
    first, last = batch.first_robot[k], batch.first_robot[k + 1]
    parts = np.arange(bodies[0], bodies[-1])
    return PackedCase(
        batch.shapes, batch.walls, parts, batch.start, batch.command, first, last, batch.dt
    )


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
    shapes, i, j = case.shapes, case.first, case.first + 1
    pose = poses_at(case, t)
    if len(pose) == 1:
        d, nx, ny, ax, ay, _, _ = wall_separation(shapes, i, pose[0], case.walls, case.parts)
        return d, point_speed(pose[0], case.command[i], ax, ay, nx, ny)
    d, nx, ny, ax, ay, bx, by = body_separation(shapes, i, pose[0], shapes, j, pose[1])
    closing = point_speed(pose[0], case.command[i], ax, ay, nx, ny)
    return d, closing - point_speed(pose[1], case.command[j], bx, by, nx, ny)


@compiled
def time_from(case: PackedCase, since: float, horizon: float) -> float:
    """Collision time [s] counted from ``since``, up to the horizon."""
    shapes, i, j = case.shapes, case.first, case.first + 1
    pose = poses_at(case, since)
    twist = (case.command[i, 0], case.command[i, 1])
    if len(pose) == 1:
        return collision_time_walls(shapes, i, pose[0], twist, case.walls, case.parts, horizon)
    other = (case.command[j, 0], case.command[j, 1])
    return collision_time_pair(shapes, i, pose[0], twist, j, pose[1], other, horizon)


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
    shapes, i = case.shapes, case.first
    a = poses_at(case, step * case.dt)
    b = poses_at(case, (step + 1) * case.dt)
    if len(a) == 1:
        return swept_walls(shapes, i, a[0], b[0], case.walls, case.parts, case.dt)[0]
    return swept_pair(shapes, i, a[0], b[0], i + 1, a[1], b[1], case.dt)


@compiled
def predict(batch: Packed) -> Prediction:
    """Collision time and distances of every case."""
    cases = len(batch.first_robot) - 1
    time = np.empty(cases)
    renewed = np.empty(cases, np.int64)
    distance = np.empty((cases, STEPS + 1))
    for k in range(cases):
        case = packed_case(batch, k)
        time[k], renewed[k] = collision_time_of(case, STEPS * batch.dt)
        for n in range(STEPS + 1):
            distance[k, n] = state_at(case, n * batch.dt)[0]
    return Prediction(time, renewed, distance)


@compiled
def approach(batch: Packed, time: FloatArray) -> Approach:
    """How every case stands at its time [s] (M,); nothing where that is inf."""
    cases = len(time)
    gap = np.full(cases, np.nan)
    closing = np.full(cases, np.nan)
    swept = np.full(cases, np.inf)
    swept_gap = np.full(cases, np.nan)
    for k in range(cases):
        if not time[k] < np.inf:
            continue
        case = packed_case(batch, k)
        gap[k], speed = state_at(case, time[k])
        near = int(time[k] / batch.dt)
        for n in range(max(0, near - 1), min(near + 2, STEPS)):
            t = swept_step(case, n)
            if t < np.inf:
                swept[k] = n * batch.dt + t
                swept_gap[k], later = state_at(case, swept[k])
                closing[k] = min(speed, later)
                break
    return Approach(gap, closing, swept, swept_gap)


def is_warm() -> bool:
    """Whether the kernels of a crash test lie compiled on disk; `approach` comes last."""
    return is_cached(approach)
