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

from collections.abc import Mapping, Sequence, Sized
from math import asin, copysign, cos, pi, sin, sqrt
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.errors import Fault, Location
from physim.geometry.motion import Course
from physim.geometry.neighbours import put_in_order
from physim.geometry.path import path_length, point_at
from physim.geometry.shapes import FloatArray, IntArray, Polylines, Rows2, Rows6, Shapes
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
from physim.parts.drive import clip_pairs
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
from .formation import SpeedRule, forward_speed, put_neighbours
from .path_following import (
    Aim,
    SpeedPairs,
    judging_time,
    put_best_plan,
    put_pairs,
    target_on_path,
)
from .priority import (
    Bodies,
    Ranking,
    considered_by_rank,
    rank,
    ranking_of,
    row_of,
    within_by_rank,
)
from .safe_area import Point, Target, is_outside, safe_target
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

NOWHERE = np.zeros((0, 6))
"""`Reaches.each` where all robots follow at once"""
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


class Sets(NamedTuple):
    """Numbers of each robot: Robot i has ``values[start[i]:start[i + 1]]``."""

    values: FloatArray
    start: IntArray


class Cluster(NamedTuple):
    """What does not change in a run, for every robot."""

    shapes: Shapes
    walls: WallTree
    paths: Polylines
    stop_station: FloatArray
    outside: Rows2
    """(M, 2) stretches of the paths outside the accessible area"""
    outside_start: IntArray
    """Robot i has those from ``outside_start[i]`` on"""
    top_speed: FloatArray
    speeds: Sets
    omegas: Sets
    lead: FloatArray
    adjacency: IntArray
    """(N N,)"""
    listed: int
    """N, or 0 where it is empty"""
    speed_rule: SpeedRule
    forward_only: bool
    """whether safe mode leaves the speed to (7)"""
    formation_range: float
    reach: float


class Memory(NamedTuple):
    """What decisions leave for the next ones, a row for each of the N robots."""

    mode: IntArray
    plan: Rows2
    """(N, m, 2)"""
    dwell: IntArray
    """number of the dwell time of the plan that comes next; 0: a new plan"""


class Reaches(NamedTuple):
    """What each of N robots can come to, where some do not just follow their commands."""

    counts: bool
    """whether there are any such"""
    each: Rows6
    """(N, 6) see `physim.parts.drive.clip_pairs`; (0, 6) where there are none"""
    braking: FloatArray
    """(N,) [m/s²]"""


class Room(NamedTuple):
    """Arrays that decisions write to, made once: they only save time."""

    pairs: Rows2
    """(C, 2) at least as many as the largest sets give"""
    forward: FloatArray
    """(1,) the speed, as a multiple of nu, of a robot that leaves it to (7): 1"""
    ranking: Ranking
    ranked: IntArray
    """(1,) how many rows it last ranked"""
    nearest: NearestWalls
    """(N,) see `physim.geometry.walls.Sight`"""


class Observers(NamedTuple):
    """What each of the N robots has of what is sensed, see `physim.parts.controller.Sensed`."""

    first: IntArray
    end: IntArray
    station: FloatArray


class Answers(NamedTuple):
    """The fields of `Decisions` that are written, a row for each robot that is due."""

    command: Rows2
    hold: FloatArray
    mode: IntArray
    rule: IntArray
    report: Rows6
    considered: IntArray
    """(room,)"""
    considered_start: IntArray
    room: int


@compiled
def own_speed(cluster: Cluster, ranking: Ranking, bodies: Bodies, me: int) -> float:
    """Forward speed of row ``me`` [m/s] by (7)."""
    number, station, reach = bodies.number, bodies.station, cluster.formation_range
    if cluster.listed > 0:
        many = put_neighbours(
            me, number, station, bodies.size, cluster.adjacency, cluster.listed, reach,
            ranking.rows,
        )  # fmt: skip
    else:
        many = within_by_rank(me, ranking, station, reach)
    top_speed = cluster.top_speed[number[me]]
    rule, rows = cluster.speed_rule, ranking.rows
    return forward_speed(rule, top_speed, me, number, rows, many, station, cluster.lead)


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
    reach: Reaches,
    out: Answers,
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
    me, pose = row_of(bodies.number, bodies.size, i), bodies.pose
    nu = own_speed(cluster, ranking, bodies, me)
    if reach.counts:  # it must come to a stop in time, with half of what it brakes by
        nu = min(nu, sqrt(reach.braking[i] * (stop_station - station)))
    sight = Sight(cluster.walls, pose[me, 0], pose[me, 1], cluster.reach, room.nearest)
    length, begin = path_length(paths, i), cluster.outside_start
    beyond = min(station + rules.look_ahead, length)
    outside = is_outside(cluster.outside, begin[i], begin[i + 1], beyond)
    target = safe_target(
        sight, Target(Point(x, y), Point(ax, ay), outside), Point(pose[me, 0], pose[me, 1]),
        rules.look_ahead, rules.safe_distance,
    )  # fmt: skip

    aim = Aim(target.x, target.y, judging_time(rules.judge_ahead, length - station, nu))
    keep = 0.0 if rules.translation_only else 1.0
    others = considered_by_rank(me, ranking, pose, bodies.station, cluster.reach)
    near = NearField(me, ranking.rows, others, sight, keep)
    distance = smallest_distance(bodies, near)
    boundary = seen_distance(bodies.shapes, i, pose[me], sight)
    first, turns = cluster.speeds.start[i], cluster.omegas.start[i + 1] - cluster.omegas.start[i]
    speeds, many = cluster.speeds.values[first:], cluster.speeds.start[i + 1] - first
    omegas = cluster.omegas.values[cluster.omegas.start[i] :]
    dwell, plan = memory.dwell[i], memory.plan[rules.dwells * i :]
    if dwell == 0:
        if cluster.forward_only:
            count = put_pairs(room.forward, 1, nu, omegas, turns, room.pairs)
        else:
            count = put_pairs(speeds, many, nu, omegas, turns, room.pairs)
        if reach.counts:
            clip_pairs(room.pairs, count, reach.each[i])
        choice = SpeedPairs(room.pairs, count)
        put_best_plan(pose[me], choice, rules.dwell, rules.dwells, aim, plan)  # (5)
    pair = plan[dwell]
    xi = smallest_time(bodies, near, pair, rules.horizon, -1.0)
    evaluations = others + 1
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
        count = put_pairs(speeds, many, nu, omegas, turns, room.pairs)
        if reach.counts:
            clip_pairs(room.pairs, count, reach.each[i])
        pairs = SpeedPairs(room.pairs, count)
        if mode == DISTANCE:
            walls_count = boundary < rules.safe_distance
            rule = WIDEST
            best = widest_pair(bodies, near, pairs, walls_count, rules.update_period, aim)
        else:
            rule = LONGEST
            stand, most, is_car = np.inf, np.inf, False
            if reach.counts and reach.each[i, 5] < np.inf:
                stand, most, is_car = rules.time_low, rules.time_high, True
            best, xi = longest_pair(
                bodies, near, pairs, pair, xi, rules.horizon, rules.update_period, aim, stand, most
            )
            if is_car:
                xi = smallest_time(bodies, near, room.pairs[best], rules.horizon, -1.0)
            evaluations += count * (others + 1)
        pair = room.pairs[best]
        if mode == DISTANCE:
            xi = smallest_time(bodies, near, pair, rules.horizon, -1.0)
        evaluations += others + 1
    hold = interval
    if rules.event_triggered:
        hold = update_interval(interval, rules.beta, xi)  # (14)
    if pair[0] > 0.0:
        hold = min(hold, (stop_station - station) / pair[0])
    goes_on = mode == SAFE and hold == interval and dwell + 1 < rules.dwells
    report[0], report[1] = target.x, target.y
    report[2], report[3], report[4] = distance, boundary, xi
    report[5] = evaluations
    memory.mode[i], memory.dwell[i] = mode, dwell + 1 if goes_on else 0
    out.command[k, 0], out.command[k, 1] = pair[0], pair[1]
    out.hold[k], out.mode[k], out.rule[k] = hold, mode, rule
    return others


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
    v, omega = pair[0], pair[1]
    _, _, dx, dy = point_at(cluster.paths, i, station)
    c, s = cos(heading), sin(heading)
    missing = cluster.stop_station[i] - station
    advance = v * (c * dx + s * dy)
    if advance <= 0.0:
        return False
    if omega == 0.0:
        return bool(missing <= advance * time)
    astray = asin(max(-1.0, min(1.0, (s * dx - c * dy) * copysign(1.0, v))))
    across = (0.5 * pi - astray * copysign(1.0, omega)) / abs(omega)  # farther it does not come
    turned = sin(astray + omega * min(time - clear / abs(v), across)) - sin(astray)
    return bool(missing <= abs(v) * turned / omega)


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
