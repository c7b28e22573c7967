"""One decision of one robot by the paper's rules, in the order of Fig. 5.

Written as a kernel, from the rows that the robot may know; `mode_switching` has it made for all
robots that are due, and says which rule is which.
"""

from __future__ import annotations

from math import asin, copysign, cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.motion import Course
from physim.geometry.path import path_length, point_at
from physim.geometry.shapes import FloatArray, IntArray, Polylines, Rows2, Rows6, Shapes
from physim.geometry.walls import (
    NearestWalls,
    Sight,
    WallTree,
    seen_distance,
    seen_time,
)
from physim.parts.declarations import Rule
from physim.parts.drive import clip_pairs

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
from .priority import Bodies, Ranking, considered_by_rank, row_of, within_by_rank
from .safe_area import Point, Target, is_outside, safe_target
from .settings import Rules
from .switching import DISTANCE, SAFE, next_mode, update_interval

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
