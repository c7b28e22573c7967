"""The paper's controller: formation, path following and avoidance under mode switching (Fig. 5).

One decision of Robot i, `decision`, with the rules it is made of:

1. forward speed by the formation (7)                         formation
2. the robots ahead and within range                          priority
3. target on the own path (3), moved into the safe area       path_following, safe_area
4. the command that safe mode would take (5)                  path_following
5. distance, boundary distance and collision time (11)        avoidance
6. safe, danger by distance or danger by time (Fig. 5)        switching
7. in danger the command by (12) or (13)                      avoidance
8. the time of the next decision (14)                         switching

All robots that are due decide in one compiled call, each from the rows that it may know.

Departures from the paper: arrival at a stop station is ours (a robot there stands still, so a wall
beyond it is none ahead: see `stops_within`); each rule lists its own. Collision times are counted,
as `evaluations`, by command looked at: one for every considered robot, and one for all walls.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.errors import Fault, Location
from physim.geometry.neighbours import put_in_order
from physim.geometry.shapes import FloatArray, IntArray
from physim.geometry.walls import nearest_walls
from physim.parts.controller import Decisions
from physim.parts.declarations import PAPER_MODES, STANDARD_COLUMNS
from physim.world.scene import Scene

from .decision import RULES, Answers, Cluster, Memory, Reaches, Room, Sets, decide_one
from .formation import SpeedRule
from .priority import Bodies, Ranking, rank, ranking_of
from .settings import ModeSwitchingSettings, Rules
from .world_checks import (
    interval_doubts,
    omega_faults,
    range_doubts,
    safe_area_doubts,
    speed_doubts,
    speed_faults,
    stop_doubts,
)

if TYPE_CHECKING:
    from physim.simulation.observation import View
    from physim.world import Robot, World

NOWHERE = np.zeros((0, 6))
"""`Reaches.each` where all robots follow at once"""


class Observers(NamedTuple):
    """What each of the N robots has of what is sensed, see `physim.parts.controller.Sensed`."""

    first: IntArray
    end: IntArray
    station: FloatArray


@compiled
def decide_due(
    due: IntArray,
    done: int,
    many: int,
    bodies: Bodies,
    seen: Observers,
    cluster: Cluster,
    rules: Rules,
    room: Room,
    memory: Memory,
    reach: Reaches,
    out: Answers,
) -> int:
    """Decide for the robots of ``due`` from number ``done`` to ``many`` from what is sensed.

    ``bodies`` are all rows, and each has those that ``seen`` says. Writes their rows of ``memory``
    and ``out``; returns how many have decided by then: fewer where ``out`` has no room to list all
    that are considered. All decide from the same state, so their order does not matter.
    """
    ranked_from, ranked_to, start = -1, -1, out.considered_start
    for k in range(done, many):
        i = due[k]
        a, b = seen.first[i], seen.end[i]
        if start[k] + b - a > out.room:
            return k
        mine = Bodies(
            bodies.shapes, bodies.number[a:], bodies.pose[a:], bodies.twist[a:],
            bodies.station[a:], bodies.facing[a:], b - a,
        )  # fmt: skip
        order = room.ranking.order
        ranking = Ranking(order, room.ranking.place, room.ranking.rows, b - a)
        if a != ranked_from or b != ranked_to:  # once, where all share their rows
            if room.ranked[0] != b - a:
                for row in range(b - a):
                    order[row] = row
                room.ranked[0] = b - a
            rank(ranking, mine.station, mine.number)
            ranked_from, ranked_to = a, b
        looked_at = decide_one(
            k, i, seen.station[i], mine, cluster, rules, ranking, room, memory, reach,
            out,
        )  # fmt: skip
        start[k + 1] = start[k] + looked_at
        put_in_order(ranking.rows, looked_at)
        for m in range(looked_at):
            out.considered[start[k] + m] = mine.number[ranking.rows[m]]
    return many


class ModeSwitching:
    """Formation, path following and collision avoidance by the paper's rules, all of them."""

    Settings = ModeSwitchingSettings
    modes = PAPER_MODES
    rules = RULES
    columns = STANDARD_COLUMNS
    drives = ("unicycle", "car")
    told = "always"

    def __init__(self, settings: ModeSwitchingSettings | None = None) -> None:
        self.settings = settings or ModeSwitchingSettings()

    def robot_faults(self, robots: Mapping[int, Robot]) -> list[Fault]:
        """Refuse a set of rotational speeds that a robot's limits do not allow."""
        settings = self.settings
        return omega_faults(settings.omegas, "omegas" in settings.model_fields_set, robots)

    def world_faults(self, world: World, where: Location) -> list[Fault]:
        """Refuse a speed of its own beside that of a formation."""
        return speed_faults(self.settings, world, where)

    def world_doubts(self, world: World, where: Location) -> list[Fault]:
        """Doubt speeds out of reach, stops short of arrival, long commands, range, safe area."""
        settings = self.settings
        may_stand = not settings.forward_only(world.formation is not None)
        return [
            *speed_doubts(settings, world, where, by_7=True),
            *stop_doubts(settings, world, may_stand),
            *interval_doubts(settings, world),
            *range_doubts(settings, world),
            *safe_area_doubts(settings, world, where),
        ]

    def kept_from_walls(self) -> tuple[str, float]:
        """Setting by which danger mode keeps off walls, and how near [m]."""
        is_kept = self.settings.avoidance != "none"
        return "boundary_low", self.settings.boundary_low if is_kept else 0.0

    def start(self, scene: Scene) -> dict[str, NDArray[Any]]:
        """`Memory` of every robot before its first decision."""
        robots, dwells = scene.robots, len(self.settings.dwell_times)
        none = np.zeros(robots, dtype=np.int64)
        return Memory(none, np.zeros((robots, dwells, 2)), none.copy())._asdict()

    def decide_all(self, view: View, due: IntArray, memory: dict[str, NDArray[Any]]) -> Decisions:
        """Decide for robots ``due`` from what each of them may know."""
        cluster, rules, room = view.prepared(self._prepared)
        s, many, rows = view.sensed, len(due), len(view.sensed.robot)
        bodies = Bodies.of(view, cluster.shapes)
        known = Memory(memory["mode"], memory["plan"].reshape(-1, 2), memory["dwell"])
        out = Answers(
            np.empty((many, 2)), np.empty(many), np.empty(many, np.int64),
            np.empty(many, np.int64), np.empty((many, 6)), np.empty(8 * many + rows, np.int64),
            np.zeros(many + 1, np.int64), 8 * many + rows,
        )  # fmt: skip
        scene, settings = view.scene, self.settings
        some = bool(scene.drives)
        ahead = max(settings.update_period, settings.judge_ahead)
        reach = Reaches(some, view.reach(ahead) if some else NOWHERE, scene.braking)
        done, seen = 0, Observers(s.first, s.end, s.station)
        while True:
            done = decide_due(
                due, done, many, bodies, seen, cluster, rules, room, known, reach, out
            )
            listed = out.considered[: out.considered_start[done]]
            if done == many:
                return Decisions(due, *out[:5], listed, out.considered_start)
            more = np.concatenate((listed, np.empty(out.room, np.int64)))
            out = out._replace(considered=more, room=len(more))

    def _prepared(self, scene: Scene) -> tuple[Cluster, Rules, Room]:
        """What the kernel is handed at every step of a scene."""
        settings, plan = self.settings, scene.formation
        rules, stretches = settings.rules(), [np.reshape(one, (-1, 2)) for one in scene.outside]
        cluster = Cluster(
            shapes=scene.shapes,
            walls=scene.wall_tree,
            paths=scene.paths,
            stop_station=scene.stop_station,
            outside=np.concatenate(stretches),
            outside_start=_starts(stretches),
            top_speed=np.ascontiguousarray(scene.limits[:, 0]),
            speeds=_sets([settings.speeds if one is None else one for one in scene.speeds]),
            omegas=_sets([settings.omegas if one is None else one for one in scene.omegas]),
            lead=plan.lead,
            adjacency=plan.adjacency.reshape(-1),
            listed=len(plan.adjacency),
            speed_rule=SpeedRule.of(plan, settings.speed),
            forward_only=settings.forward_only(plan.active),
            formation_range=plan.range,
            reach=scene.sensing_range,
        )
        pairs = int((np.diff(cluster.speeds.start) * np.diff(cluster.omegas.start)).max())
        many, ranking, nearest = scene.moving, ranking_of(scene.moving), nearest_walls(scene.robots)
        room = Room(np.empty((pairs, 2)), np.ones(1), ranking, np.array([many]), nearest)
        return cluster, rules, room


def _starts(each: Sequence[Sized]) -> IntArray:
    return np.cumsum([0, *map(len, each)], dtype=np.int64)


def _sets(each: Sequence[Sequence[float]]) -> Sets:
    """Numbers of each robot, one behind the other."""
    return Sets(np.concatenate([np.array(one, dtype=np.float64) for one in each]), _starts(each))
