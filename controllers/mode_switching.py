"""The paper's controller: formation, path following and avoidance under mode switching (Fig. 5).

One decision of Robot i, with the rules it is made of:

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

from collections.abc import Mapping, Sequence
from math import asin, copysign, cos, pi, sin
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled, direct
from physim.errors import Fault, Location
from physim.geometry.motion import Course, facings
from physim.geometry.neighbours import put_in_order
from physim.geometry.path import path_length, point_at
from physim.geometry.shapes import FloatArray, IntArray, Polylines, Shapes
from physim.geometry.walls import (
    NearestWalls,
    Sight,
    WallTree,
    nearest_walls,
    seen_distance,
    seen_time,
)
from physim.parts.controller import Decisions
from physim.parts.declarations import PAPER_MODES, STANDARD_COLUMNS, Rule
from physim.world.scene import Scene

from .avoidance import (
    NearField,
    course_under,
    first_robot,
    longest_pair,
    smallest_distance,
    smallest_time,
    widest_pair,
)
from .formation import SpeedRule, formation_neighbours, forward_speed
from .path_following import Aim, judging_time, put_best_plan, put_pairs, target_on_path
from .priority import Bodies, Ranking, considered_by_rank, rank, ranking_of, within_by_rank
from .safe_area import is_outside, safe_target
from .settings import ModeSwitchingSettings, Rules
from .switching import DISTANCE, SAFE, next_mode, update_interval
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

ARRIVED = 3
"""Number of the mode in `PAPER_MODES`"""

RULES = (
    Rule("path_following", "path following by (5); speed by (7) in a formation"),
    Rule("plan", "next speed pair of the plan of (5)"),
    Rule("distance", "avoidance by distance, (12)"),
    Rule("time", "avoidance by collision time, (13)"),
    Rule("stop", "stands at its stop station"),
)
FOLLOW, PLAN, WIDEST, LONGEST, STOP = range(5)
"""Numbers of the rules"""


class Rows(NamedTuple):
    """Rows of an array for each robot: Robot i has ``values[start[i]:start[i + 1]]``."""

    values: FloatArray
    start: IntArray


class Cluster(NamedTuple):
    """What does not change in a run, for every robot."""

    shapes: Shapes
    walls: WallTree
    paths: Polylines
    stop_station: FloatArray
    outside: Rows
    """(M, 2) stretches of the paths outside the accessible area"""
    top_speed: FloatArray
    speeds: Rows
    omegas: Rows
    lead: FloatArray
    adjacency: IntArray
    speed_rule: SpeedRule
    forward_only: bool
    """whether safe mode leaves the speed to (7)"""
    formation_range: float
    reach: float


class Memory(NamedTuple):
    """What decisions leave for the next ones, a row for each of the N robots."""

    mode: IntArray
    plan: FloatArray
    """(N, m, 2)"""
    dwell: IntArray
    """number of the dwell time of the plan that comes next; 0: a new plan"""


class Room(NamedTuple):
    """Arrays that decisions write to, made once: they only save time."""

    pairs: FloatArray
    """(C, 2) at least as many as the largest sets give"""
    forward: FloatArray
    """(1,) the speed, as a multiple of nu, of a robot that leaves it to (7): 1"""
    plan: FloatArray
    """(m, 2)"""
    ranking: Ranking
    nearest: NearestWalls
    """(N,) see `physim.geometry.walls.Sight`"""


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
def rows_of(rows: Rows, i: int) -> FloatArray:
    """Those of Robot i."""
    return rows.values[rows.start[i] : rows.start[i + 1]]


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
def decide_one(
    k: int,
    i: int,
    station: float,
    bodies: Bodies,
    cluster: Cluster,
    rules: Rules,
    ranking: Ranking,
    room: Room,
    memory: Memory,
    out: Decisions,
) -> int:
    """Decide for Robot i, at a ``station`` [m] of its path, into row k of ``out``.

    Returns how many it considered; their rows of ``bodies`` stand in ``ranking.rows``. The danger
    branch in a function of its own made free flow a tenth slower.
    """
    paths, stop_station, report = cluster.paths, cluster.stop_station[i], out.report[k]
    x, y, ax, ay = target_on_path(paths, i, station, rules.look_ahead)  # (3)
    if station >= stop_station - rules.arrival_tolerance:
        report[0], report[1], report[5] = x, y, 0.0
        report[2], report[3], report[4] = np.nan, np.nan, np.nan
        memory.mode[i], memory.dwell[i] = ARRIVED, 0
        out.command[k, 0], out.command[k, 1] = 0.0, 0.0
        out.hold[k], out.mode[k], out.rule[k] = rules.longest_interval, ARRIVED, STOP
        return 0
    me, pose = row_of(bodies.number, i), bodies.pose
    nu = own_speed(cluster, ranking, bodies, me)
    sight = Sight(cluster.walls, pose[me, 0], pose[me, 1], cluster.reach, room.nearest)
    length = path_length(paths, i)
    outside = is_outside(rows_of(cluster.outside, i), min(station + rules.look_ahead, length))
    position = (pose[me, 0], pose[me, 1])
    tx, ty = safe_target(
        sight, (x, y), (ax, ay), outside, position, rules.look_ahead, rules.safe_distance
    )  # fmt: skip

    aim = Aim(tx, ty, judging_time(rules.judge_ahead, length - station, nu))
    keep = 0.0 if rules.translation_only else 1.0
    rows = ranking.rows[: considered_by_rank(me, ranking, pose, bodies.station, cluster.reach)]
    near = NearField(me, rows, sight, keep)
    distance = smallest_distance(bodies, near)
    boundary = seen_distance(bodies.shapes, i, pose[me], sight)
    speeds, omegas = rows_of(cluster.speeds, i), rows_of(cluster.omegas, i)
    dwell, plan = memory.dwell[i], memory.plan[i]
    if dwell == 0:
        some = room.forward if cluster.forward_only else speeds
        choice = room.pairs[: put_pairs(some, nu, omegas, room.pairs)]
        put_best_plan(pose[me], choice, rules.dwell, aim, room.plan, plan)  # (5)
    pair = plan[dwell]
    xi = smallest_time(bodies, near, pair, rules.horizon, -1.0)
    evaluations = len(rows) + 1
    mode = next_mode(memory.mode[i], distance, xi, boundary, rules)  # Fig. 5
    if mode != SAFE:
        mine = course_under(bodies, me, pair[0], keep * pair[1])
        if is_wall_later(bodies, me, mine, sight, rules) or stops_within(
            cluster, i, station, pose[me, 2], pair, xi, rules.boundary_low
        ):
            met = first_robot(bodies, near, mine, rules.horizon, -1.0)
            mode = next_mode(memory.mode[i], distance, met, boundary, rules)
    rule = FOLLOW if dwell == 0 else PLAN
    interval = rules.longest_interval
    if mode == SAFE:
        interval *= rules.dwell[dwell] / rules.update_period
    else:
        pairs = room.pairs[: put_pairs(speeds, nu, omegas, room.pairs)]
        if mode == DISTANCE:
            walls_count = boundary < rules.safe_distance
            rule = WIDEST
            best = widest_pair(bodies, near, pairs, walls_count, rules.update_period, aim)
        else:
            rule = LONGEST
            best, xi = longest_pair(
                bodies, near, pairs, pair, xi, rules.horizon, rules.update_period, aim
            )
            evaluations += len(pairs) * (len(rows) + 1)
        pair = pairs[best]
        if mode == DISTANCE:
            xi = smallest_time(bodies, near, pair, rules.horizon, -1.0)
        evaluations += len(rows) + 1
    hold = interval
    if rules.event_triggered:
        hold = update_interval(interval, rules.beta, xi)  # (14)
    if pair[0] > 0.0:
        hold = min(hold, (stop_station - station) / pair[0])
    goes_on = mode == SAFE and hold == interval and dwell + 1 < len(rules.dwell)
    report[0], report[1] = tx, ty
    report[2], report[3], report[4] = distance, boundary, xi
    report[5] = evaluations
    memory.mode[i], memory.dwell[i] = mode, dwell + 1 if goes_on else 0
    out.command[k, 0], out.command[k, 1] = pair[0], pair[1]
    out.hold[k], out.mode[k], out.rule[k] = hold, mode, rule
    return len(rows)


@compiled
def is_wall_later(bodies: Bodies, me: int, mine: Course, sight: Sight, rules: Rules) -> bool:
    """Whether no wall is met on course ``mine`` up to ``boundary_time_high``, below ``time_high``.

    Else a robot that had to stop, and is to turn at a corner only farther on, has the wall behind
    the corner ahead of it for ever: standing is what (13) likes best.
    """
    high = rules.boundary_time_high
    if high >= rules.time_high:
        return False
    return seen_time(bodies.shapes, bodies.number[me], mine, sight, rules.time_high) > high


@compiled
def stops_within(
    cluster: Cluster,
    i: int,
    station: float,
    heading: float,
    pair: FloatArray,
    time: float,
    clear: float,
) -> bool:
    """Whether Robot i under a speed pair comes to its stop, and stands, within ``time``.

    A wall that it would only meet later puts nobody in danger. Otherwise it would depend on when
    the robot decides, and how it is turned, whether it still comes to a stop before an end wall.
    One that turns, so may turn otherwise, must stand ``clear`` [m] of its way before the wall:
    where it came nearer than that to a wall beside its stop, it backed and came back for ever.
    """
    v, omega = float(pair[0]), float(pair[1])
    dx, dy = point_at(cluster.paths, i, station)[2:]
    c, s = cos(heading), sin(heading)
    missing = float(cluster.stop_station[i]) - station
    advance = v * (c * dx + s * dy)
    if advance <= 0.0:
        return False
    if omega == 0.0:
        return missing <= advance * time
    astray = asin(max(-1.0, min(1.0, (s * dx - c * dy) * copysign(1.0, v))))
    across = (0.5 * pi - astray * copysign(1.0, omega)) / abs(omega)  # farther it does not come
    turned = sin(astray + omega * min(time - clear / abs(v), across)) - sin(astray)
    return missing <= abs(v) * turned / omega


@compiled
def decide_due(
    due: IntArray,
    unchanging: list[tuple[Cluster, Rules, Room]],
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
) -> Decisions:
    """Decide for every robot of ``due`` from what is sensed, the fields of `Sensed`.

    ``unchanging`` is kept (`physim.kept`). Writes the robots' memory, the fields of `Memory`. All
    decide from the same state, so their order does not matter.
    """
    cluster, rules, room = unchanging[0]
    ranking, memory = room.ranking, Memory(mode, plan, dwell)
    ranked_from, ranked_to = -1, -1
    many = len(due)
    out = Decisions(
        due, np.empty((many, 2)), np.empty(many), np.empty(many, np.int64),
        np.empty(many, np.int64), np.empty((many, 6)), np.empty(8 * many + 8, np.int64),
        np.zeros(many + 1, np.int64),
    )  # fmt: skip
    start, listed = out.considered_start, out.considered
    facing = facings(pose)
    for k in range(many):
        i = due[k]
        a, b = first[i], end[i]
        bodies = Bodies(
            cluster.shapes, robot[a:b], pose[a:b], command[a:b], reference_station[a:b],
            facing[a:b],
        )  # fmt: skip
        if a != ranked_from or b != ranked_to:  # once, where all share their rows
            if b - a != len(ranking.order):
                ranking = ranking_of(b - a)
            rank(ranking, bodies.station, bodies.number)
            ranked_from, ranked_to = a, b
        looked_at = decide_one(
            k, i, own_station[i], bodies, cluster, rules, ranking, room, memory, out
        )  # fmt: skip
        start[k + 1] = start[k] + looked_at
        if start[k + 1] > len(listed):
            listed = longer(listed, start[k + 1])
        put_in_order(ranking.rows, looked_at)
        for m in range(looked_at):
            listed[start[k] + m] = bodies.number[ranking.rows[m]]
    return Decisions(
        due, out.command, out.hold, out.mode, out.rule, out.report, listed[: start[-1]], start
    )


@compiled
def longer(values: IntArray, length: int) -> IntArray:
    """Array of at least twice the length that begins with ``values``."""
    out = np.empty(max(2 * len(values), length), dtype=np.int64)
    for k in range(len(values)):  # to assign a slice would take long to compile
        out[k] = values[k]
    return out


class ModeSwitching:
    """Formation, path following and collision avoidance by the paper's rules, all of them."""

    Settings = ModeSwitchingSettings
    modes = PAPER_MODES
    rules = RULES
    columns = STANDARD_COLUMNS

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
        kernel, unchanging = view.prepared(self._prepared)
        s = view.sensed
        made: Decisions = kernel(
            due, unchanging, s.robot, s.pose, s.command, s.reference_station, s.first, s.end,
            s.station, memory["mode"], memory["plan"], memory["dwell"],
        )  # fmt: skip
        return made

    def _prepared(self, scene: Scene) -> tuple[Any, Any]:
        """The kernel, and what it is handed at every step of a scene."""
        from physim.kept import kept  # which imports numba: not before a run

        settings, plan = self.settings, scene.formation
        rules = settings.rules()
        cluster = Cluster(
            shapes=scene.shapes,
            walls=scene.wall_tree,
            paths=scene.paths,
            stop_station=scene.stop_station,
            outside=_rows([np.reshape(one, (-1, 2)) for one in scene.outside]),
            top_speed=np.ascontiguousarray(scene.limits[:, 0]),
            speeds=_rows([settings.speeds if one is None else one for one in scene.speeds]),
            omegas=_rows([settings.omegas if one is None else one for one in scene.omegas]),
            lead=plan.lead,
            adjacency=plan.adjacency,
            speed_rule=SpeedRule.of(plan, settings.speed),
            forward_only=settings.forward_only(plan.active),
            formation_range=plan.range,
            reach=scene.sensing_range,
        )
        pairs = int((np.diff(cluster.speeds.start) * np.diff(cluster.omegas.start)).max())
        room = Room(
            np.empty((pairs, 2)), np.ones(1), np.empty((len(rules.dwell), 2)),
            ranking_of(scene.robots), nearest_walls(scene.robots),
        )  # fmt: skip
        return direct(decide_due), kept((cluster, rules, room))


def _rows(each: Sequence[Sequence[float] | FloatArray]) -> Rows:
    """Rows of each robot, one behind the other."""
    values = [np.array(one, dtype=np.float64) for one in each]
    start = np.cumsum([0, *map(len, values)]).astype(np.int64)
    return Rows(np.concatenate(values), start)
