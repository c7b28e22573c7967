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

from physim.compiled import compiled, direct
from physim.geometry.motion import facings
from physim.geometry.neighbours import put_in_order
from physim.geometry.shapes import FloatArray, IntArray, Polylines, Shapes
from physim.geometry.walls import NearestWalls, Sight, WallTree, nearest_walls
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


class Memories(NamedTuple):
    """What all N robots remember: the fields of `Memory`, a row for each."""

    mode: IntArray
    plan: FloatArray
    dwell: IntArray


class Decided(NamedTuple):
    """What `decide_all` answers, one row a robot that was due."""

    command: FloatArray
    """(M, 2)"""
    hold: FloatArray
    mode: IntArray
    rule: IntArray
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
def own_speed(cluster: Cluster, ranking: Ranking, bodies: Bodies, me: int) -> float:
    """Forward speed of row ``me`` [m/s] by (7)."""
    number, station, reach = bodies.number, bodies.station, cluster.formation_range
    if cluster.adjacency.shape[0] > 0:
        rows = formation_neighbours(me, number, station, cluster.adjacency, reach)
    else:
        rows = ranking.rows[: within_by_rank(me, ranking, station, reach)]
    top_speed = cluster.top_speed[number[me]]
    return forward_speed(cluster.speed_rule, top_speed, me, number, rows, station, cluster.lead)


@compiled
def decide_row(
    k: int,
    i: int,
    bodies: Bodies,
    own_station: float,
    cluster: Cluster,
    rules: Rules,
    ranking: Ranking,
    nearest: NearestWalls,
    room: Room,
    memories: Memories,
    out: Decided,
) -> int:
    """Decide for Robot i into row k of ``out``.

    Returns how many it considered; their rows of ``bodies`` stand in ``ranking.rows``.
    """
    me, pose, reach = row_of(bodies.number, i), bodies.pose, cluster.reach
    nu = own_speed(cluster, ranking, bodies, me)
    near = ranking.rows[: considered_by_rank(me, ranking, pose, bodies.station, reach)]
    own = EgoState(
        me,
        i,
        own_station,
        cluster.stop_station[i],
        cluster.outside[cluster.outside_start[i] : cluster.outside_start[i + 1]],
        nu,
        cluster.forward_only,
        cluster.speeds.values[cluster.speeds.start[i] : cluster.speeds.start[i + 1]],
        cluster.omegas.values[cluster.omegas.start[i] : cluster.omegas.start[i + 1]],
        Sight(cluster.walls, pose[me, 0], pose[me, 1], reach, nearest),
    )
    memory = Memory(memories.mode[i], memories.plan[i], memories.dwell[i])
    v, omega, hold, mode, rule, dwell, looked_at = decide_one(
        bodies, near, own, cluster.paths, rules, memory, room, out.report[k]
    )
    memories.mode[i], memories.dwell[i] = mode, dwell
    out.command[k, 0], out.command[k, 1] = v, omega
    out.hold[k], out.mode[k], out.rule[k] = hold, mode, rule
    return looked_at


@compiled
def decide_all(
    due: IntArray,
    unchanging: list[tuple[Cluster, Rules, Ranking, NearestWalls, Room]],
    robot: IntArray,
    pose: FloatArray,
    command: FloatArray,
    reference_station: FloatArray,
    first: IntArray,
    end: IntArray,
    own_station: FloatArray,
    mode: IntArray,
    plan: FloatArray,
    dwell: IntArray,
) -> Decided:
    """Decide for every robot of ``due`` from what is sensed, the fields of `Sensed`.

    ``unchanging`` is kept (`physim.kept`); its ranking, nearest walls and room only save time.
    Writes the robots' memories ``mode`` (N,), ``plan`` (N, m, 2), ``dwell`` (N,). All decide from
    the same state, so their order does not matter.
    """
    cluster, rules, ranking, nearest, room = unchanging[0]
    ranked_from, ranked_to = -1, -1
    many = len(due)
    out = Decided(
        np.empty((many, 2)), np.empty(many), np.empty(many, np.int64), np.empty(many, np.int64),
        np.empty((many, 6)), np.empty(8 * many + 8, np.int64), np.zeros(many + 1, np.int64),
    )  # fmt: skip
    start, listed = out.considered_start, out.considered
    facing = facings(pose)
    for k in range(len(due)):
        i = due[k]
        a, b = first[i], end[i]
        number = robot[a:b]
        bodies = Bodies(
            cluster.shapes, number, number, pose[a:b], command[a:b], reference_station[a:b],
            facing[a:b],
        )  # fmt: skip
        if a != ranked_from or b != ranked_to:  # once, where all share their rows
            if b - a != len(ranking.order):
                ranking = ranking_of(b - a)
            rank(ranking, bodies.station, number)
            ranked_from, ranked_to = a, b
        looked_at = decide_row(
            k, i, bodies, own_station[i], cluster, rules, ranking, nearest, room,
            Memories(mode, plan, dwell), out,
        )  # fmt: skip
        start[k + 1] = start[k] + looked_at
        if start[k + 1] > len(listed):
            listed = longer(listed, start[k + 1])
        put_in_order(ranking.rows, looked_at)
        for m in range(looked_at):
            listed[start[k] + m] = number[ranking.rows[m]]
    return Decided(
        out.command, out.hold, out.mode, out.rule, out.report, listed[: start[-1]], start
    )


class ModeSwitchingBatch:
    """Batch form of `ModeSwitching` for one run."""

    def __init__(self, settings: ModeSwitchingSettings, scene: Scene) -> None:
        from physim.kept import kept  # which imports numba: not before a run

        plan = scene.formation
        self.rules = settings.rules()
        stretches = [np.reshape(s, (-1, 2)) for s in scene.outside]
        self.cluster = Cluster(
            shapes=scene.shapes,
            walls=scene.wall_tree,
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
            forward_only=settings.forward_only(plan.active),
            formation_range=plan.range,
            reach=scene.sensing_range,
        )
        nearest = nearest_walls(scene.robots)
        pairs = np.diff(self.cluster.speeds.start) * np.diff(self.cluster.omegas.start)
        room = room_for(int(pairs.max()), len(self.rules.dwell))
        ranking = ranking_of(scene.robots)
        self._decide = direct(decide_all)
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
        s = sensed
        decided = self._decide(
            due, self._kept, s.robot, s.pose, s.command, s.reference_station, s.first, s.end,
            s.station, memory["mode"], memory["plan"], memory["dwell"],
        )  # fmt: skip
        return Decisions(due, *decided)


def _starts(items: Sequence[FloatArray]) -> IntArray:
    return np.concatenate(([0], np.cumsum([len(item) for item in items]))).astype(np.int64)


def _sets(own: Sequence[tuple[float, ...] | None], default: Sequence[float]) -> Sets:
    sets = [np.array(default if given is None else given, dtype=np.float64) for given in own]
    return Sets(np.concatenate(sets), _starts(sets))
