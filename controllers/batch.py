"""The paper's controller for all robots that are due, in one compiled call.

For every robot it gathers just what the robot may see (`Bodies` within range by `considered`,
wall parts within range, stations of its formation neighbours) and runs the same `decide_one` as
the plain form.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.control import Decisions, Snapshot
from physim.geometry.nearby import Nearby, parts
from physim.geometry.shapes import FloatArray, IntArray, Polylines, Shapes
from physim.geometry.sight import parts_in_range
from physim.scene import Scene

from .formation import formation_speed, formation_sum, is_neighbour
from .mode_switching import Bodies, Memory, Own, decide_one
from .path_following import copy_plan
from .settings import ModeSwitchingSettings, Rules


class Sets(NamedTuple):
    """One set of numbers a robot: robot i has ``values[start[i]:start[i + 1]]``."""

    values: FloatArray
    start: IntArray


class Cluster(NamedTuple):
    """What does not change in a run, for every robot."""

    shapes: Shapes
    number: IntArray
    walls: Shapes
    nearby: Nearby
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
    active: bool
    forward_only: bool
    alpha: float
    nu_0: float
    v_min: float
    v_max: float
    reach: float


class Memories(NamedTuple):
    """`Memory` of every robot."""

    mode: IntArray
    plan: FloatArray
    """(N, m, 2)"""
    dwell: IntArray


@compiled
def forward_speed(i: int, cluster: Cluster, station: FloatArray) -> float:
    """Forward speed of Robot i by (7) [m/s], within its limit."""
    nu = cluster.nu_0
    if cluster.active:
        neighbours = np.empty(len(station), dtype=np.int64)
        count = 0
        for j in range(len(station)):
            if is_neighbour(i, j, station, cluster.adjacency, cluster.reach):
                neighbours[count] = j
                count += 1
        error = formation_sum(i, neighbours[:count], station, cluster.lead)
        nu = formation_speed(cluster.nu_0, cluster.alpha, cluster.v_min, cluster.v_max, error)
    return min(nu, float(cluster.top_speed[i]))


@compiled
def decide_all(
    due: IntArray,
    cluster: Cluster,
    pose: FloatArray,
    command: FloatArray,
    station: FloatArray,
    reference_station: FloatArray,
    rules: Rules,
    memories: Memories,
) -> FloatArray:
    """Decide for every robot of ``due``; rows (M, 11): v, omega, hold, mode, report.

    Writes the robots' memories. All decide from the same state, so their order does not matter.
    """
    rows = np.empty((len(due), 11))
    bodies = Bodies(cluster.shapes, cluster.number, pose, command, reference_station)
    for k in range(len(due)):
        i = due[k]
        near = parts(cluster.nearby, pose[i, 0], pose[i, 1])
        seen = parts_in_range(cluster.walls, near, pose[i, 0], pose[i, 1], cluster.reach)
        own = Own(
            i,
            i,
            station[i],
            cluster.stop_station[i],
            cluster.outside[cluster.outside_start[i] : cluster.outside_start[i + 1]],
            forward_speed(i, cluster, reference_station),
            cluster.forward_only,
            cluster.speeds.values[cluster.speeds.start[i] : cluster.speeds.start[i + 1]],
            cluster.omegas.values[cluster.omegas.start[i] : cluster.omegas.start[i + 1]],
            seen,
            cluster.reach,
        )
        memory = Memory(memories.mode[i], memories.plan[i], memories.dwell[i])
        v, omega, hold, mode, plan, dwell, report = decide_one(
            bodies, own, cluster.paths, cluster.walls, rules, memory
        )
        memories.mode[i] = mode
        copy_plan(plan, memories.plan[i])
        memories.dwell[i] = dwell
        rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3] = v, omega, hold, mode
        for m in range(len(report)):
            rows[k, 4 + m] = report[m]
    return rows


class ModeSwitchingBatch:
    """Batch form of `ModeSwitching` for one run: holds the robots' memories."""

    def __init__(self, settings: ModeSwitchingSettings, scene: Scene) -> None:
        plan = scene.formation
        self.rules = settings.rules()
        stretches = [np.reshape(s, (-1, 2)) for s in scene.outside]
        self.cluster = Cluster(
            shapes=scene.shapes,
            number=np.arange(scene.robots),
            walls=scene.walls,
            nearby=scene.nearby,
            paths=scene.paths,
            stop_station=scene.stop_station,
            outside=np.concatenate(stretches),
            outside_start=_starts(stretches),
            top_speed=np.ascontiguousarray(scene.limits[:, 0]),
            speeds=_sets(scene.speeds, settings.speeds),
            omegas=_sets(scene.omegas, settings.omegas),
            lead=plan.lead,
            adjacency=plan.adjacency,
            active=plan.active,
            forward_only=plan.active and not settings.reverse_in_safe_mode,
            alpha=plan.gain,
            nu_0=plan.speed,
            v_min=plan.v_min,
            v_max=plan.v_max,
            reach=plan.range,
        )
        self.memories = Memories(
            mode=np.zeros(scene.robots, dtype=np.int64),
            plan=np.zeros((scene.robots, len(self.rules.dwell), 2)),
            dwell=np.zeros(scene.robots, dtype=np.int64),
        )

    def decide_due(self, snapshot: Snapshot, due: IntArray) -> Decisions:
        """Decide for robots ``due`` from one snapshot."""
        rows = decide_all(
            due,
            self.cluster,
            snapshot.pose,
            snapshot.command,
            snapshot.station,
            snapshot.reference_station,
            self.rules,
            self.memories,
        )
        return Decisions(due, rows[:, :2], rows[:, 2], rows[:, 3].astype(np.int64), rows[:, 4:])


def _starts(items: Sequence[FloatArray]) -> IntArray:
    return np.concatenate(([0], np.cumsum([len(item) for item in items]))).astype(np.int64)


def _sets(own: Sequence[tuple[float, ...] | None], default: Sequence[float]) -> Sets:
    sets = [np.array(default if given is None else given, dtype=np.float64) for given in own]
    return Sets(np.concatenate(sets), _starts(sets))
