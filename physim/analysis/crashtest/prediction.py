"""Contacts of the cases of a batch as analysis predicts them, by kernels without the engine.

A batch holds many cases of one time step in one space, far apart.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.analysis.crashtest.drafts import STEPS, Case
from physim.compiled import compiled
from physim.geometry.bodies import body_separation
from physim.geometry.collision import collision_time_pair
from physim.geometry.convex import Witness
from physim.geometry.motion import move
from physim.geometry.shapes import FloatArray, IntArray, Rows3, Shapes, pack_parts
from physim.geometry.swept import swept_time
from physim.tolerances import CONTACT, ROUNDING

MOST_RENEWED = 2000
"""How often a search for a collision time that reached its cap is taken up again."""


class Packed(NamedTuple):
    """M cases of one time step with N robots in all, for the kernels."""

    shapes: Shapes
    """of the N robots"""
    walls: Shapes
    """of all cases, world frame"""
    start: Rows3
    """(N, 3)"""
    twist: Rows3
    """(N, 3) v [m/s], omega [rad/s], lateral [m/s]"""
    mass: FloatArray
    """(N,) [kg]"""
    first_robot: IntArray
    """(M + 1,) case k has the robots from first_robot[k] to first_robot[k + 1] - 1"""
    first_wall: IntArray
    """(M + 1,) likewise of the bodies of ``walls``"""
    dt: float
    """[s]"""


def pack(dt: float, cases: tuple[Case, ...]) -> Packed:
    """Pack cases of one time step."""
    layouts = [case.layout for case in cases]
    robots = [robot for one in layouts for robot in one.robots]
    first_robot, first_wall = (
        np.concatenate(([0], np.cumsum([len(one) for one in some]))).astype(np.int64)
        for some in ([one.robots for one in layouts], [case.walls for case in cases])
    )
    return Packed(
        pack_parts([robot.parts for robot in robots]),
        pack_parts([parts for case in cases for parts in case.walls]),
        np.concatenate([one.start for one in layouts]),
        np.concatenate([one.command for one in layouts]),
        np.array([robot.mass for robot in robots]), first_robot, first_wall, dt,
    )  # fmt: skip


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


@compiled
def put_poses(batch: Packed, k: int, t: float, pose: Rows3) -> int:
    """Write the poses of the robots of case k on their arcs into ``pose``; how many they are."""
    first, last, twist = batch.first_robot[k], batch.first_robot[k + 1], batch.twist
    for i in range(first, last):
        move(batch.start[i], twist[i, 0], twist[i, 1], twist[i, 2], t, pose[i - first])
    return int(last - first)


@compiled
def closing_speed(pose: FloatArray, twist: FloatArray, x: float, y: float, found: Witness) -> float:
    """Speed [m/s] along a normal of the point (x, y) fixed to a robot."""
    v, omega, lateral, c, s = twist[0], twist[1], twist[2], math.cos(pose[2]), math.sin(pose[2])
    vx = v * c - lateral * s - omega * (y - pose[1])
    vy = v * s + lateral * c + omega * (x - pose[0])
    return float(vx * found.nx + vy * found.ny)


@compiled
def state_at(batch: Packed, k: int, t: float) -> tuple[float, float]:
    """Signed distance [m] of case k, and closing speed [m/s] of its closest points."""
    shapes, twist, i = batch.shapes, batch.twist, batch.first_robot[k]
    pose = np.empty((2, 3))
    if put_poses(batch, k, t, pose) == 1:
        found = Witness(np.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        for w in range(batch.first_wall[k], batch.first_wall[k + 1]):
            other = body_separation(shapes, i, pose[0], batch.walls, w, np.zeros(3))
            if other.distance < found.distance:
                found = other
        return found.distance, closing_speed(pose[0], twist[i], found.ax, found.ay, found)
    found = body_separation(shapes, i, pose[0], shapes, i + 1, pose[1])
    closing = closing_speed(pose[0], twist[i], found.ax, found.ay, found)
    closing -= closing_speed(pose[1], twist[i + 1], found.bx, found.by, found)
    return found.distance, closing


@compiled
def time_from(batch: Packed, k: int, since: float, horizon: float) -> float:
    """Collision time [s] of case k counted from ``since``, up to the horizon."""
    shapes, twist, i = batch.shapes, batch.twist, batch.first_robot[k]
    pose = np.empty((2, 3))
    if put_poses(batch, k, since, pose) == 1:
        xi, still = np.inf, np.zeros(3)
        for w in range(batch.first_wall[k], batch.first_wall[k + 1]):
            until = min(xi, horizon)
            time = collision_time_pair(
                batch.walls, w, still, still, shapes, i, pose[0], twist[i], until
            )
            xi = min(xi, time)
        return xi
    return collision_time_pair(
        shapes, i, pose[0], twist[i], shapes, i + 1, pose[1], twist[i + 1], horizon
    )


@compiled
def collision_time_of(batch: Packed, k: int, horizon: float) -> tuple[float, int]:
    """Collision time [s] of case k, and how often the search went on from a lower bound.

    A search that reaches its cap gives a lower bound, at which the shapes are still apart.
    """
    time = 0.0
    for renewed in range(MOST_RENEWED):
        time += time_from(batch, k, time, horizon - time)
        if time == np.inf or state_at(batch, k, time)[0] <= CONTACT + ROUNDING:
            return time, renewed
    return time, MOST_RENEWED


@compiled
def swept_step(batch: Packed, k: int, step: int) -> float:
    """Time of the first contact in a step [s after its first sample], inf when there is none."""
    shapes, i = batch.shapes, batch.first_robot[k]
    a, b = np.zeros((2, 3)), np.zeros((2, 3))
    put_poses(batch, k, (step + 1) * batch.dt, b)
    if put_poses(batch, k, step * batch.dt, a) == 1:
        t, still = np.inf, np.zeros(3)
        for w in range(batch.first_wall[k], batch.first_wall[k + 1]):
            t = min(t, swept_time(batch.walls, w, still, still, shapes, i, a[0], b[0], batch.dt))
        return t
    return swept_time(shapes, i, a[0], b[0], shapes, i + 1, a[1], b[1], batch.dt)


def predict(batch: Packed) -> Prediction:
    """Collision time and distances of every case."""
    cases = len(batch.first_robot) - 1
    found = Prediction(np.empty(cases), np.empty(cases, np.int64), np.empty((cases, STEPS + 1)))
    put_prediction(batch, cases, *found[:2], found.distance.reshape(-1))
    return found


@compiled
def put_prediction(
    batch: Packed, cases: int, time: FloatArray, renewed: IntArray, distance: FloatArray
) -> None:
    """Write the arrays of a `Prediction`."""
    for k in range(cases):
        time[k], renewed[k] = collision_time_of(batch, k, STEPS * batch.dt)
        for n in range(STEPS + 1):
            distance[(STEPS + 1) * k + n] = state_at(batch, k, n * batch.dt)[0]


def approach(batch: Packed, time: FloatArray) -> Approach:
    """How every case stands at its time [s] (M,); nothing where that is inf."""
    cases = len(time)
    found = Approach(*(np.full(cases, value) for value in (np.nan, np.nan, np.inf, np.nan)))
    put_approach(batch, cases, time, *found)
    return found


@compiled
def put_approach(
    batch: Packed,
    cases: int,
    time: FloatArray,
    gap: FloatArray,
    closing: FloatArray,
    swept: FloatArray,
    swept_gap: FloatArray,
) -> None:
    """Write the arrays of an `Approach`, where there is something to write."""
    for k in range(cases):
        if not time[k] < np.inf:
            continue
        gap[k], speed = state_at(batch, k, time[k])
        near = int(time[k] / batch.dt)
        for n in range(max(0, near - 1), min(near + 2, STEPS)):
            t = swept_step(batch, k, n)
            if t < np.inf:
                swept[k] = n * batch.dt + t
                swept_gap[k], later = state_at(batch, k, swept[k])
                closing[k] = min(speed, later)
                break
