"""Near misses: the smallest distances and collision times that did not end in contact.

Distances are over all samples, one for each episode of a pair, see `_listed`, of approaches: a
stretch of time over which a pair is nearer than the reach of the analytic contacts. Collision times
are those of the deciding robot with every other body at every decision, under the commands that all
hold from then on, computed here; one for each episode of a pair as well.
Approaches that end in contact, at a sample or between two, are left out: they are contacts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from physim.analysis.metrics.walls import farthest_between, near_wall
from physim.analysis.validation.analytic_contacts import (
    FULL,
    AnalyticContacts,
    Room,
    pose_blocks,
    walls_about,
)
from physim.analysis.validation.comparison import SMALLEST
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.responsibility import has_priority
from physim.compiled import compiled
from physim.geometry.collision import collision_time_pair, collision_time_walls
from physim.geometry.shapes import FloatArray, IntArray, Shapes, read_only
from physim.record import Record
from physim.record.writer import Extremes
from physim.tolerances import CONTACT

MOST_LISTED = 10
MOST_LOOKED_AT = 1_000
"""Stretches, the smallest first, among which episodes are told apart."""
LOOK = 3.0
"""[s] Collision times beyond this are no near miss."""
DECIDED = np.dtype([("step", "<i8"), ("robot", "<i8")])
"""Who decided when: the same type whatever columns a controller declares, for the kernel."""
APART = 1.0
"""[s] Decisions of a pair farther apart in time belong to two stretches."""
TOGETHER = 5.0
"""[s] Near misses of a pair closer in time are one: its smallest is listed."""
PARTED = 1.0
"""[m] So are those between which the pair is never farther apart than this."""


@dataclass(frozen=True)
class NearMiss:
    """A smallest value, when and of whom."""

    a: int
    b: int
    step: int
    time: float
    """[s]"""
    value: float
    """[m] or [s]"""
    behind: int | None = None
    """robot that was behind along s*, and so had to consider the other; None for a boundary, and
    where the controller has no such rule"""
    along: str = ""
    """where along a wall it was nearest then; empty between robots"""


@dataclass(frozen=True)
class NearMisses:
    """The smallest first, at most `MOST_LISTED` of each."""

    distances: tuple[NearMiss, ...]
    """[m]"""
    times: tuple[NearMiss, ...]
    """[s]"""
    reach: float
    """[m] distances listed are below this"""
    smallest_robots: NearMiss | None
    """smallest distance of two robots in the whole run, whatever it is"""
    smallest_boundary: NearMiss | None
    """smallest distance of a robot and a boundary or obstacle"""


def near_misses(
    record: Record, analytic: AnalyticContacts, table: DecisionTable, exact: Extremes
) -> NearMisses:
    """Find the near misses of a record with the poses of every step; all by the shapes."""
    dt, rows = record.dt, exact.rows
    distances = [
        NearMiss(near.a, near.b, near.step, near.step * dt, near.distance)
        for near in analytic.approaches
        if near.distance > CONTACT
        and not _touched(analytic.grazes, near.a, near.b, near.first, near.last + 1)
    ]
    smallest = []
    for (value, when, other), _ in SMALLEST:
        who = int(np.argmin(rows[value]))
        body, step = int(rows[other][who]), int(rows[when][who])
        along = near_wall(record, who, body, step)
        least = NearMiss(who, body, step, step * dt, float(rows[value][who]), along=along)
        smallest.append(None if body < 0 else least)
    return NearMisses(
        _listed(table, distances), _listed(table, _times(record)), analytic.reach, *smallest
    )


def _touched(rows: NDArray[np.void], a: int, b: int, first: int, last: int) -> bool:
    """Whether one of the rows, in the order of steps, is of a pair in these steps."""
    some = rows[slice(*np.searchsorted(rows["step"], (first, last + 1)))]
    return bool(((some["a"] == a) & (some["b"] == b)).any())


def _listed(table: DecisionTable, some: Sequence[NearMiss]) -> tuple[NearMiss, ...]:
    """The first `MOST_LISTED` of ``some``, the smallest first: one of each pair and episode.

    Two of a pair are one episode where less than `TOGETHER` lies between them, or where the pair
    is never more than `PARTED` apart between them. Says who of two robots was behind (equal
    stations: the higher index), or where a wall is.
    """
    record, kept = table.record, list[NearMiss]()
    for one in some[:MOST_LOOKED_AT]:
        if len(kept) == MOST_LISTED:
            break
        for other in kept:
            first, last = sorted((one.step, other.step))
            if (other.a, other.b) == (one.a, one.b) and (
                (last - first) * record.dt < TOGETHER
                or farthest_between(record, one.a, one.b, (first, last)) <= PARTED
            ):
                break
        else:
            kept.append(one)
    for k, one in enumerate(kept):
        if one.b >= record.robots:
            kept[k] = replace(one, along=near_wall(record, one.a, one.b, one.step))
        elif has_priority(record):
            a, b = (table.reference_station(i, one.step) for i in (one.a, one.b))
            kept[k] = replace(one, behind=one.b if a >= b else one.a)
    return tuple(kept)


@compiled
def decision_times(
    rows: NDArray[np.void],
    poses: FloatArray,
    start: int,
    command: FloatArray,
    shapes: Shapes,
    walls: Shapes,
    horizon: float,
    who: IntArray,
    values: FloatArray,
) -> int:
    """Write step, bodies a < b (C, 3) and collision time [s] (C, 1) of every pair that meets.

    ``rows`` are those of `DECIDED` in the order of steps, ``poses`` (B, N, 3) those from step
    ``start`` on, ``command`` (B, N, 2) what drives the robots from there on. Returns how many, or
    FULL.
    """
    robots = poses.shape[1]
    count = 0
    for k in range(len(rows)):
        at, i = rows[k]["step"] - start, rows[k]["robot"]
        pose, held = poses[at], command[at]
        mine = (held[i, 0], held[i, 1])
        span = abs(mine[0]) * horizon + 1e-6
        about = walls_about(poses[at : at + 1], i, shapes.radius[i], walls, span)
        for j in range(robots + len(walls.body_start) - 1):
            if j == i:
                continue
            if j < robots:
                theirs = (held[j, 0], held[j, 1])
                xi = collision_time_pair(shapes, i, pose[i], mine, j, pose[j], theirs, horizon)
            else:
                w = j - robots
                parts = about[(about >= walls.body_start[w]) & (about < walls.body_start[w + 1])]
                xi = collision_time_walls(shapes, i, pose[i], mine, walls, parts, horizon)
            if xi <= horizon:
                if count == len(who):
                    return FULL
                who[count, 0] = rows[k]["step"]
                who[count, 1] = min(i, j)
                who[count, 2] = max(i, j)
                values[count, 0] = xi
                count += 1
    return count


def _times(record: Record) -> list[NearMiss]:
    """Smallest value of each stretch of decisions of a pair, but for those that end in contact."""
    decided = np.zeros(len(record.updates), dtype=DECIDED)
    for name in DECIDED.names or ():
        decided[name] = record.updates[name]
    found, room = [(np.zeros((0, 3), dtype=np.int64), np.zeros((0, 1)))], Room()
    for poses, start in pose_blocks(record):
        end = start + len(poses) - 1
        rows = decided[slice(*np.searchsorted(decided["step"], [start, end]))]
        command = read_only(record.commands_over("applied", start, end))
        scan = partial(
            decision_times, rows, poses, start, command, record.shapes, record.walls, LOOK
        )
        found.append(room.filled(scan, 1))
    who, values = (np.concatenate(some) for some in zip(*found, strict=True))
    order = np.lexsort((who[:, 0], who[:, 2], who[:, 1]))
    who, xi = who[order], values[order, 0]
    apart = np.diff(who[:, 0]) * record.dt > APART
    cut = np.flatnonzero(apart | (np.diff(who[:, 1:], axis=0) != 0).any(axis=1)) + 1
    smallest = []
    for run in np.split(np.arange(len(who)), cut) if len(who) else ():
        least = run[int(np.argmin(xi[run]))]
        step, a, b = who[least].tolist()
        last = int(who[run[-1], 0]) + round(APART / record.dt)
        if not _touched(record.contacts, a, b, int(who[run[0], 0]), last + 1):
            smallest.append(NearMiss(a, b, step, step * record.dt, float(xi[least])))
    return sorted(smallest, key=lambda one: (one.value, one.step, one.a, one.b))
