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

from math import atan2, cos, sin
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.motion import arc
from physim.geometry.path import path_length, point_at
from physim.geometry.shapes import FloatArray, Polylines, Rows2
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


class SpeedPairs(NamedTuple):
    """Speed pairs to choose from."""

    each: Rows2
    """(C, 2) v [m/s], omega [rad/s]"""
    size: int


def speed_pairs(speeds: FloatArray, nu: float, omegas: FloatArray) -> SpeedPairs:
    """All pairs (v, omega) from multiples of nu and the set (6)."""
    each = np.empty((len(speeds) * len(omegas), 2))
    return SpeedPairs(each, put_pairs(speeds, len(speeds), nu, omegas, len(omegas), each))


@compiled
def put_pairs(
    speeds: FloatArray, many: int, nu: float, omegas: FloatArray, turns: int, out: Rows2
) -> int:
    """Write `speed_pairs` of so many speeds and rotational speeds into ``out``; return how many."""
    for k in range(many):
        for m in range(turns):
            out[turns * k + m, 0], out[turns * k + m, 1] = speeds[k] * nu, omegas[m]
    return many * turns


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
    pose: FloatArray, plan: Rows2, dwell: FloatArray, dwells: int, judge_ahead: float
) -> tuple[float, float, float]:
    """Where a plan leads: x, y, heading.

    ``plan`` (m, 2) holds a speed pair for each dwell time; its last one is held until
    ``judge_ahead`` where that is later.
    """
    x, y, heading = pose[0], pose[1], pose[2]
    rest = judge_ahead
    for k in range(dwells):
        duration = max(dwell[k], rest) if k == dwells - 1 else dwell[k]
        x, y, heading = arc(x, y, heading, plan[k, 0], plan[k, 1], 0.0, duration)
        rest -= dwell[k]
    return x, y, heading


class Judgement(NamedTuple):
    """What (5) and its tie-breaks look at, smaller is better."""

    gap: float
    """[m] from the end to the target"""
    error: float
    """[rad] of the heading there"""
    turning: float
    """[rad/s] |omega| of the first pair"""


@compiled
def judged(end: tuple[float, float, float], omega: float, aim: Aim) -> Judgement:
    """Judge a plan by its end; ``omega`` is that of its first pair."""
    x, y, heading = end
    error = heading_error(x, y, heading, aim.x, aim.y)
    return Judgement(np.hypot(aim.x - x, aim.y - y), error, abs(omega))


@compiled
def judged_pair(pose: FloatArray, pair: Rows2, period: float, aim: Aim) -> Judgement:
    """Judge a plan of one speed pair (1, 2), held for a period."""
    dwell = np.empty(1)
    dwell[0] = period
    return judged(plan_end(pose, pair, dwell, 1, aim.ahead), pair[0, 1], aim)


@compiled
def comes_first(a: Judgement, b: Judgement) -> bool:
    """Whether a judgement is better than b; what is equal within TIE is equal."""
    if a.gap < b.gap - TIE or a.gap > b.gap + TIE:
        return a.gap < b.gap
    if a.error < b.error - TIE or a.error > b.error + TIE:
        return a.error < b.error
    return a.turning < b.turning - TIE


def best_plan(pose: FloatArray, pairs: SpeedPairs, dwell: FloatArray, aim: Aim) -> FloatArray:
    """Plan (m, 2) that ends nearest to the target (5), out of every sequence of ``pairs``."""
    best = np.empty((len(dwell), 2))
    put_best_plan(pose, pairs, dwell, len(dwell), aim, best)
    return best


@compiled
def put_best_plan(
    pose: FloatArray, pairs: SpeedPairs, dwell: FloatArray, dwells: int, aim: Aim, best: Rows2
) -> None:
    """Write `best_plan` of so many dwell times into ``best`` (m, 2)."""
    sequences, plan = 1, np.empty((dwells, 2))
    for _ in range(dwells):
        sequences *= pairs.size
    best_gap = np.inf
    bx, by, heading = 0.0, 0.0, 0.0  # where the best plan ends
    for code in range(sequences):
        digits = code
        for k in range(dwells - 1, -1, -1):
            pair = digits % pairs.size
            plan[k, 0], plan[k, 1] = pairs.each[pair, 0], pairs.each[pair, 1]
            digits //= pairs.size
        end = plan_end(pose, plan, dwell, dwells, aim.ahead)
        gap = np.hypot(aim.x - end[0], aim.y - end[1])
        if gap > best_gap + TIE:
            continue
        if gap >= best_gap - TIE:  # a tie, the only case that needs the rest of a judgement
            first = judged((bx, by, heading), best[0, 1], aim)
            if not comes_first(judged(end, plan[0, 1], aim), first):
                continue
        best_gap = gap  # argmin of (5)
        bx, by, heading = end
        for k in range(dwells):
            best[k, 0], best[k, 1] = plan[k, 0], plan[k, 1]
