"""Near misses: of pairs that never touched, how near they came and how soon they would have met.

Distances are the smallest of each pair over all samples, where it came within the reach of the
analytic contacts. Collision times are the smallest of each pair over all decisions, of the deciding
robot with every other body, under the commands that all hold from then on, computed here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from physim.analysis.metrics import Figures, Moment
from physim.analysis.metrics.distances import near_wall
from physim.analysis.metrics.progress import twists_over
from physim.analysis.validation.analytic_contacts import (
    FULL,
    AnalyticContacts,
    Room,
    least_of_pairs,
    pose_blocks,
)
from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.responsibility import has_priority
from physim.compiled import compiled
from physim.geometry.collision import collision_time_pair
from physim.geometry.shapes import FloatArray, IntArray, IntRows3, Rows3, Shapes, read_only
from physim.record import Record

MOST_LISTED = 10
LOOK = 3.0
"""[s] Collision times beyond this are no near miss."""
SEEN_EVERY = 0.1
"""[s] between moments at which the robots of a log that was judged are looked at"""
DECIDED = np.dtype([("step", "<i8"), ("robot", "<i8")])
"""Who decided when: the same type whatever columns a controller declares, for the kernel."""


@dataclass(frozen=True)
class NearMiss(Moment):
    """A smallest value [m] or [s], when and of which two bodies."""

    behind: int | None = None
    """robot that was behind along s*, and so had to consider the other; None of two that are not
    both robots, and where the controller has no such rule"""
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


def near_misses(record: Record, analytic: AnalyticContacts, table: DecisionTable) -> NearMisses:
    """Find the near misses of a record with the poses of every step."""
    run, near = Figures(record), analytic.nearest
    rows = np.concatenate((analytic.touching, analytic.grazes))
    touched = set(zip(rows["a"].tolist(), rows["b"].tolist(), strict=True))

    def listed(who: IntArray, values: FloatArray) -> tuple[NearMiss, ...]:
        """Those of rows (M, 3) of step, a and b, the smallest first, whose pair never touched."""
        some = ((*place, value) for place, value in zip(who.tolist(), values.tolist(), strict=True))
        mine = (one for one in some if one[1] < record.robots)
        missed = [one for one in mine if one[1:3] not in touched][:MOST_LISTED]
        return tuple(_near_miss(table, *one) for one in missed)

    def smallest(one: Moment | None) -> NearMiss | None:
        if one is None or one.b is None:
            return None
        return NearMiss(**vars(one), along=near_wall(record, one.a, one.b, one.step))

    places = np.column_stack([near[name] for name in ("step", "a", "b")])
    return NearMisses(
        listed(places, near["distance"]), listed(*_times(record, table)), analytic.reach,
        smallest(run.nearest), smallest(run.nearest_wall),
    )  # fmt: skip


def _near_miss(table: DecisionTable, step: int, a: int, b: int, value: float) -> NearMiss:
    """One with who of two robots was behind (equal stations: the higher index), or the wall's
    place."""
    record, behind, along = table.record, None, ""
    if b >= record.moving:
        along = near_wall(record, a, b, step)
    elif b < record.robots:
        stations = [table.reference_station(i, step) for i in (a, b)]
        later = b if stations[0] >= stations[1] else a
        behind = later if has_priority(record, later) else None
    return NearMiss(value, step, step * record.dt, a, b, behind, along)


@compiled
def decision_times(
    step: IntArray,
    robot: IntArray,
    decisions: int,
    poses: Rows3,
    moving: int,
    start: int,
    twist: Rows3,
    shapes: Shapes,
    walls: Shapes,
    boundaries: int,
    horizon: float,
    room: int,
    who: IntRows3,
    values: FloatArray,
) -> int:
    """Write step, bodies a < b (C, 3) and collision time [s] (C,) of every pair that meets.

    Decisions are of a ``robot`` at a ``step`` each, in the order of steps; ``poses`` (S B, 3) are
    those of B bodies ``moving`` from step ``start`` on, ``twist`` (S B, 3) what drives them from
    there on. Returns how many, or FULL.
    """
    still = np.zeros(3)
    count = 0
    for k in range(decisions):
        at, i = moving * (step[k] - start), robot[k]
        pose, held = poses[at:], twist[at:]
        for j in range(moving + boundaries):
            if j == i:
                continue
            if j < moving:
                xi = collision_time_pair(
                    shapes, i, pose[i], held[i], shapes, j, pose[j], held[j], horizon
                )
            else:
                xi = collision_time_pair(
                    walls, j - moving, still, still, shapes, i, pose[i], held[i], horizon
                )
            if xi <= horizon:
                if count == room:
                    return FULL
                who[count, 0] = step[k]
                who[count, 1] = min(i, j)
                who[count, 2] = max(i, j)
                values[count] = xi
                count += 1
    return count


def _times(record: Record, table: DecisionTable) -> tuple[IntArray, FloatArray]:
    """Step, a and b (M, 3) of the smallest collision time of each pair, and that (M,) [s]."""
    if record.judged is None:
        decided = np.zeros(len(record.updates), dtype=DECIDED)
        for name in DECIDED.names or ():
            decided[name] = record.updates[name]
    else:
        steps = np.arange(0, record.steps_run, max(1, round(SEEN_EVERY / record.dt)))
        decided = np.zeros(len(steps) * record.robots, dtype=DECIDED)
        decided["step"] = np.repeat(steps, record.robots)
        decided["robot"] = np.tile(np.arange(record.robots), len(steps))
    found, room = [(np.zeros((0, 3), dtype=np.int64), np.zeros(0))], Room()
    for poses, start in pose_blocks(record):
        end = start + len(poses) - 1
        rows = decided[slice(*np.searchsorted(decided["step"], [start, end]))]
        step, robot = (rows[name].astype(np.int64) for name in ("step", "robot"))
        twist, seen = table.held_over(start, end), twists_over(record, start, end)
        twist[:, : seen.shape[1]] = seen
        scan = partial(
            decision_times, step, robot, len(rows), poses.reshape(-1, 3), record.moving, start,
            read_only(twist.reshape(-1, 3)), record.shapes, record.walls,
            len(record.walls.radius), LOOK,
        )  # fmt: skip
        found.append(room.filled(scan, 1))
    who, values = (np.concatenate(some) for some in zip(*found, strict=True))
    least = least_of_pairs(who[:, 1], who[:, 2], values)
    return who[least], values[least]
