"""The paper's controller for all robots that are due, in one compiled call.

For every robot it gathers just what the robot may see (its rows of what is sensed, of which those
ahead and within range are considered, walls within range, stations of its formation neighbours)
and runs the same `decide_one` as the plain form.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.geometry.motion import facings
from physim.geometry.shapes import FloatArray, IntArray, Polylines, Shapes
from physim.geometry.wall_tree import Sight, WallTree, build_wall_tree
from physim.parts.controller import Decisions, Sensed
from physim.world.scene import Scene

from .formation import SpeedRule, formation_neighbours, forward_speed
from .mode_switching import EgoState, Memory, Room, decide_one, room_for
from .priority import (
    Bodies,
    Ranking,
    considered_by_rank,
    rank,
    ranking_of,
    within_by_rank,
)
from .settings import ModeSwitchingSettings, Rules


class Sets(NamedTuple):
    """One set of numbers a robot: robot i has ``values[start[i]:start[i + 1]]``."""

    values: FloatArray
    start: IntArray


class Cluster(NamedTuple):
    """What does not change in a run, for every robot."""

    shapes: Shapes
    walls: WallTree
    paths: Polylines
    stop_station: FloatArray
    outside: FloatArray
    """(M, 2) stretches outside the area, those of robot i from ``outside_start[i]`` on"""
    outside_start: IntArray
    top_speed: FloatArray
    speeds: Sets
    omegas: Sets
    lead: FloatArray
    adjacency: IntArray
    speed_rule: SpeedRule
    forward_only: bool
    formation_range: float
    reach: float


class Decided(NamedTuple):
    """What `decide_all` answers, one row a robot that was due."""

    rows: FloatArray
    """(M, 5) v, omega, hold, mode, rule"""
    report: FloatArray
    """(M, 6)"""
    considered: IntArray
    """robot indices, one decision after the other"""
    considered_start: IntArray
    """(M + 1,)"""


@compiled
def row_of(number: IntArray, i: int) -> int:
    """Row of Robot i; -1 where it has none."""
    if i < len(number) and number[i] == i:
        return i  # everybody, in their order
    for row in range(len(number)):
        if number[row] == i:
            return row
    return -1


@compiled
def longer(values: IntArray, length: int) -> IntArray:
    """Array of at least twice the length that begins with ``values``."""
    out = np.empty(max(2 * len(values), length), dtype=np.int64)
    for k in range(len(values)):  # to assign a slice would take long to compile
        out[k] = values[k]
    return out


@compiled
def decide_all(
    due: IntArray,
    unchanging: list[tuple[Cluster, Rules, Ranking, IntArray, Room]],
    sensed: Sensed,
    mode: IntArray,
    plan: FloatArray,
    dwell: IntArray,
) -> Decided:
    """Decide for every robot of ``due``.

    ``unchanging`` is kept (`physim.kept`); its ranking, nearest walls and room only save time.
    Writes the robots' memories ``mode`` (N,), ``plan`` (N, m, 2), ``dwell`` (N,). All decide from
    the same state, so their order does not matter.
    """
    cluster, rules, ranking, nearest, room = unchanging[0]
    ranked_from, ranked_to = -1, -1
    rows = np.empty((len(due), 5))
    reports = np.empty((len(due), 6))
    start = np.zeros(len(due) + 1, dtype=np.int64)
    listed = np.empty(8 * len(due) + 8, dtype=np.int64)
    facing = facings(sensed.pose)
    for k in range(len(due)):
        i = due[k]
        a, b = sensed.first[i], sensed.end[i]
        number = sensed.robot[a:b]
        bodies = Bodies(
            cluster.shapes, number, number, sensed.pose[a:b], sensed.command[a:b],
            sensed.reference_station[a:b], facing[a:b],
        )  # fmt: skip
        if a != ranked_from or b != ranked_to:  # once, where all share their rows
            if b - a != len(ranking.order):
                ranking = ranking_of(bodies.station)
            rank(ranking, bodies.station, number)
            ranked_from, ranked_to = a, b
        me = row_of(number, i)
        station = bodies.station
        if cluster.adjacency.shape[0] > 0:
            neighbours = formation_neighbours(
                me, number, station, cluster.adjacency, cluster.formation_range
            )
        else:
            neighbours = within_by_rank(me, ranking, station, cluster.formation_range)
        nu = forward_speed(
            cluster.speed_rule, cluster.top_speed[i], me, number, neighbours, station, cluster.lead
        )
        near = considered_by_rank(me, ranking, bodies.pose, station, cluster.reach)
        own = EgoState(
            me,
            i,
            sensed.station[i],
            cluster.stop_station[i],
            cluster.outside[cluster.outside_start[i] : cluster.outside_start[i + 1]],
            nu,
            cluster.forward_only,
            cluster.speeds.values[cluster.speeds.start[i] : cluster.speeds.start[i + 1]],
            cluster.omegas.values[cluster.omegas.start[i] : cluster.omegas.start[i + 1]],
            Sight(cluster.walls, bodies.pose[me, 0], bodies.pose[me, 1], cluster.reach, nearest),
        )
        memory = Memory(mode[i], plan[i], dwell[i])
        v, omega, hold, new_mode, rule, new_dwell, looked_at = decide_one(
            bodies, near, own, cluster.paths, rules, memory, room, reports[k]
        )
        mode[i], dwell[i] = new_mode, new_dwell
        rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4] = v, omega, hold, new_mode, rule
        start[k + 1] = start[k] + looked_at
        if start[k + 1] > len(listed):
            listed = longer(listed, start[k + 1])
        for m in range(looked_at):
            listed[start[k] + m] = number[near[m]]
    return Decided(rows, reports, listed[: start[-1]], start)


class ModeSwitchingBatch:
    """Batch form of `ModeSwitching` for one run."""

    def __init__(self, settings: ModeSwitchingSettings, scene: Scene) -> None:
        from physim.kept import kept  # which imports numba: not before a run

        plan = scene.formation
        self.rules = settings.rules()
        stretches = [np.reshape(s, (-1, 2)) for s in scene.outside]
        self.cluster = Cluster(
            shapes=scene.shapes,
            walls=build_wall_tree(scene.walls),
            paths=scene.paths,
            stop_station=scene.stop_station,
            outside=np.concatenate(stretches),
            outside_start=_starts(stretches),
            top_speed=np.ascontiguousarray(scene.limits[:, 0]),
            speeds=_sets(scene.speeds, settings.speeds),
            omegas=_sets(scene.omegas, settings.omegas),
            lead=plan.lead,
            adjacency=plan.adjacency,
            speed_rule=SpeedRule.of(plan, settings.speed),
            forward_only=plan.active and not settings.reverse_in_safe_mode,
            formation_range=plan.range,
            reach=scene.sensing_range,
        )
        nearest = np.full(scene.robots, -1)
        pairs = np.diff(self.cluster.speeds.start) * np.diff(self.cluster.omegas.start)
        room = room_for(scene.robots, int(pairs.max()), len(self.rules.dwell))
        ranking = ranking_of(scene.stop_station)
        self._kept = kept((self.cluster, self.rules, ranking, nearest, room))

    def memory(self) -> dict[str, NDArray[Any]]:
        """Mode, plan and next dwell number of every robot, before its first decision."""
        robots = len(self.cluster.stop_station)
        return {
            "mode": np.zeros(robots, dtype=np.int64),
            "plan": np.zeros((robots, len(self.rules.dwell), 2)),
            "dwell": np.zeros(robots, dtype=np.int64),
        }

    def decide_due(
        self, sensed: Sensed, due: IntArray, memory: dict[str, NDArray[Any]]
    ) -> Decisions:
        """Decide for robots ``due`` from what each of them senses."""
        rows, report, considered, start = decide_all(
            due, self._kept, sensed, memory["mode"], memory["plan"], memory["dwell"]
        )
        mode, rule = rows[:, 3].astype(np.int64), rows[:, 4].astype(np.int64)
        return Decisions(due, rows[:, :2], rows[:, 2], mode, rule, report, considered, start)


def _starts(items: Sequence[FloatArray]) -> IntArray:
    return np.concatenate(([0], np.cumsum([len(item) for item in items]))).astype(np.int64)


def _sets(own: Sequence[tuple[float, ...] | None], default: Sequence[float]) -> Sets:
    sets = [np.array(default if given is None else given, dtype=np.float64) for given in own]
    return Sets(np.concatenate(sets), _starts(sets))
