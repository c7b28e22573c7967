"""Path following by target chasing, (2) to (6): choose speeds from finite sets.

The target is the point ``look_ahead`` further along the path than the robot's projection (3). A
plan is a short sequence of speed pairs, one for each dwell time tau_1, tau_2, ...; the plan whose
end lies nearest to the target is taken (5).

Departures from the paper: in a formation (5) chooses omega alone, as (7) gives the forward speed.
By default the plan is judged ``judge_ahead`` = 0.5 s ahead with its last command held, which
chatters less than judging it at the period's end, but no further than to the last waypoint; ties
are settled by the smaller heading error at the end, then by the smaller |omega| of the first pair,
then by the order of the sets.
"""

from __future__ import annotations

from math import atan2, cos, hypot, sin
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.motion import arc
from physim.geometry.path import path_length, point_at
from physim.geometry.shapes import FloatArray, Polylines
from physim.tolerances import TIE


class Aim(NamedTuple):
    """Where a plan is to lead."""

    x: float
    """[m] of the target"""
    y: float
    ahead: float
    """[s] how far ahead a plan is judged"""


@compiled
def target_on_path(
    paths: Polylines, k: int, station: float, look_ahead: float
) -> tuple[float, float, float, float]:
    """Target q̄_i on path k and the unit direction of the path there: x, y, tx, ty."""
    return point_at(paths, k, min(station + look_ahead, path_length(paths, k)))  # (2), (3)


def target_energy(position: FloatArray, target: FloatArray) -> float:
    """V_i [m^2] by (4)."""
    return float(0.5 * np.square(position - target).sum())  # (4)


@compiled
def speed_pairs(speeds: FloatArray, nu: float, omegas: FloatArray) -> FloatArray:
    """All pairs (v, omega), (C, 2) [m/s, rad/s], from multiples of nu and the set (6)."""
    pairs = np.empty((len(speeds) * len(omegas), 2))
    put_pairs(speeds, nu, omegas, pairs)
    return pairs


@compiled
def put_pairs(speeds: FloatArray, nu: float, omegas: FloatArray, out: FloatArray) -> int:
    """Write `speed_pairs` into the first rows of ``out``; return how many."""
    count = 0
    for speed in speeds:
        for omega in omegas:
            out[count, 0], out[count, 1] = speed * nu, omega
            count += 1
    return count


@compiled
def single(value: float) -> FloatArray:
    """Array (1,) of one value."""
    array = np.empty(1)
    array[0] = value
    return array


@compiled
def copy_plan(plan: FloatArray, out: FloatArray) -> None:
    """Copy a plan (m, 2) into another."""
    for k in range(len(plan)):
        out[k, 0], out[k, 1] = plan[k, 0], plan[k, 1]


@compiled
def heading_error(x: float, y: float, heading: float, tx: float, ty: float) -> float:
    """Angle [rad], 0 to pi, between a heading and the direction to a target; 0 at the target."""
    if tx == x and ty == y:
        return 0.0
    error = atan2(ty - y, tx - x) - heading
    return abs(atan2(sin(error), cos(error)))


@compiled
def judging_time(judge_ahead: float, left: float, nu: float) -> float:
    """How far ahead [s] a plan is judged with ``left`` [m] of path ahead of the projection.

    No further than to the last waypoint at speed nu: a robot that would overshoot it within
    ``judge_ahead`` would rather stand still short of it.
    """
    return min(judge_ahead, left / nu) if nu > 0.0 else judge_ahead


@compiled
def plan_end(
    pose: FloatArray, plan: FloatArray, dwell: FloatArray, judge_ahead: float
) -> tuple[float, float, float]:
    """Where a plan leads: x, y, heading.

    ``plan`` (m, 2) holds a speed pair for each dwell time; its last one is held until
    ``judge_ahead`` where that is later.
    """
    x, y, heading = pose[0], pose[1], pose[2]
    rest = judge_ahead
    for k in range(len(dwell)):
        last = k == len(dwell) - 1
        duration = max(dwell[k], rest) if last else dwell[k]
        x, y, heading = arc((x, y, heading), plan[k, 0], plan[k, 1], duration)
        rest -= dwell[k]
    return x, y, heading


@compiled
def judge(
    pose: FloatArray, plan: FloatArray, dwell: FloatArray, aim: Aim
) -> tuple[float, float, float]:
    """What (5) and its tie-breaks look at, smaller is better: distance, heading error, |omega|."""
    x, y, heading = plan_end(pose, plan, dwell, aim.ahead)
    error = heading_error(x, y, heading, aim.x, aim.y)
    return hypot(aim.x - x, aim.y - y), error, abs(plan[0, 1])


@compiled
def comes_first(a: tuple[float, float, float], b: tuple[float, float, float]) -> bool:
    """Whether judgement a is better than b, in the order of `judge`; equal within TIE is equal."""
    for k in range(3):
        if a[k] < b[k] - TIE:
            return True
        if a[k] > b[k] + TIE:
            return False
    return False


@compiled
def best_plan(pose: FloatArray, pairs: FloatArray, dwell: FloatArray, aim: Aim) -> FloatArray:
    """Plan (m, 2) that ends nearest to the target (5), out of every sequence of ``pairs``."""
    best = np.empty((len(dwell), 2))
    put_best_plan(pose, pairs, dwell, aim, np.empty((len(dwell), 2)), best)
    return best


@compiled
def put_best_plan(
    pose: FloatArray,
    pairs: FloatArray,
    dwell: FloatArray,
    aim: Aim,
    plan: FloatArray,
    best: FloatArray,
) -> None:
    """Write `best_plan` into ``best`` (m, 2); ``plan`` (m, 2) is room for the others."""
    tx, ty = aim.x, aim.y
    count, length = len(pairs), len(dwell)
    best_end, best_gap = (0.0, 0.0, 0.0), np.inf
    for code in range(count**length):
        digits = code
        for k in range(length - 1, -1, -1):
            pair = digits % count
            plan[k, 0], plan[k, 1] = pairs[pair, 0], pairs[pair, 1]
            digits //= count
        end = plan_end(pose, plan, dwell, aim.ahead)
        gap = hypot(tx - end[0], ty - end[1])
        if gap > best_gap + TIE:
            continue
        if gap >= best_gap - TIE:  # a tie, the only case that needs the rest of `judge`
            error = heading_error(end[0], end[1], end[2], tx, ty)
            its = heading_error(best_end[0], best_end[1], best_end[2], tx, ty)
            value = (gap, error, abs(plan[0, 1]))
            if not comes_first(value, (best_gap, its, abs(best[0, 1]))):
                continue
        best_end, best_gap = end, gap  # argmin of (5)
        copy_plan(plan, best)
