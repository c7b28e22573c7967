"""The paper's controller: formation, path following and avoidance under mode switching (Fig. 5).

One decision of Robot i, with the rules it is made of:

1. target on the own path (3), moved into the safe area       path_following, safe_area
2. forward speed by the formation (7)                         formation
3. the robots ahead and within range                          priority
4. the command that safe mode would take (5)                  path_following
5. distance, boundary distance and collision time (11)        avoidance
6. safe, danger by distance or danger by time (Fig. 5)        switching
7. in danger the command by (12) or (13)                      avoidance
8. the time of the next decision (14)                         switching

`decide` works from what the robot sees; `batch` decides for all robots that are due in one
compiled call. Both run `decide_one`, and both must decide alike.

Departures from the paper: arrival at a stop station is ours (a robot there stands still, so a wall
beyond it is none ahead: see `stops_within`); each rule lists its own. Collision times are counted,
as `evaluations`, by command looked at: one for every considered robot, and one for all walls.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import asin, copysign, cos, pi, sin
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.errors import Fault, Location
from physim.geometry.motion import Course, facings
from physim.geometry.path import path_length, point_at
from physim.geometry.shapes import FloatArray, IntArray, Polylines, pack_parts
from physim.geometry.walls import (
    Sight,
    build_wall_tree,
    nearest_walls,
    seen_distance,
    seen_time,
)
from physim.parts.controller import BatchController, Decision, Observation
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
from .formation import SpeedRule, forward_speed
from .path_following import Aim, judging_time, put_best_plan, put_pairs, target_on_path
from .priority import Bodies, considered
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


class EgoState(NamedTuple):
    """What the deciding robot knows of itself and of the walls near it."""

    row: int
    """its row of `Bodies`"""
    path: int
    """its number in ``paths``"""
    station: float
    stop_station: float
    outside: FloatArray
    """(M, 2) stretches of its path outside the accessible area"""
    nu: float
    """[m/s] forward speed by (7)"""
    forward_only: bool
    """whether safe mode leaves the speed to (7)"""
    speeds: FloatArray
    omegas: FloatArray
    sight: Sight
    """the walls within the sensing range"""


class Memory(NamedTuple):
    """What a decision leaves for the next: its mode and the rest of its plan."""

    mode: int
    plan: FloatArray
    """(m, 2); the next decision writes to it"""
    dwell: int
    """number of the dwell time that comes next; 0: a new plan"""


class Room(NamedTuple):
    """Arrays that a decision writes to, made once for many decisions."""

    pairs: FloatArray
    """(C, 2) at least as many as the largest sets give"""
    forward: FloatArray
    """(1,) the speed, as a multiple of nu, of a robot that leaves it to (7): 1"""
    plan: FloatArray
    """(m, 2)"""


def room_for(pairs: int, dwells: int) -> Room:
    """Room for so many speed pairs, and plans of ``dwells`` pairs."""
    return Room(np.empty((pairs, 2)), np.ones(1), np.empty((dwells, 2)))


@compiled
def decide_one(
    bodies: Bodies,
    rows: IntArray,
    own: EgoState,
    paths: Polylines,
    rules: Rules,
    memory: Memory,
    room: Room,
    report: FloatArray,
) -> tuple[float, float, float, int, int, int, int]:
    """Decide for one robot: v, omega, hold, mode, rule, next dwell number, how many considered.

    ``rows`` of ``bodies`` may be considered; all of them were, or none. Writes the plan in
    ``memory``, and `STANDARD_COLUMNS` into ``report`` (6,). The danger branch in a function of its
    own made free flow a tenth slower.
    """
    me, pose = own.row, bodies.pose
    x, y, ax, ay = target_on_path(paths, own.path, own.station, rules.look_ahead)  # (3)
    if own.station >= own.stop_station - rules.arrival_tolerance:
        report[0], report[1], report[5] = x, y, 0.0
        report[2], report[3], report[4] = np.nan, np.nan, np.nan
        return 0.0, 0.0, rules.longest_interval, ARRIVED, STOP, 0, 0
    length = path_length(paths, own.path)
    outside = is_outside(own.outside, min(own.station + rules.look_ahead, length))
    position = (pose[me, 0], pose[me, 1])
    tx, ty = safe_target(
        own.sight, (x, y), (ax, ay), outside, position, rules.look_ahead, rules.safe_distance
    )  # fmt: skip

    aim = Aim(tx, ty, judging_time(rules.judge_ahead, length - own.station, own.nu))
    keep = 0.0 if rules.translation_only else 1.0
    near = NearField(me, rows, own.sight, keep)
    distance = smallest_distance(bodies, near)
    boundary = seen_distance(bodies.shapes, bodies.shape[me], pose[me], own.sight)
    dwell, plan = memory.dwell, memory.plan
    if dwell == 0:
        speeds = room.forward if own.forward_only else own.speeds
        choice = room.pairs[: put_pairs(speeds, own.nu, own.omegas, room.pairs)]
        put_best_plan(pose[me], choice, rules.dwell, aim, room.plan, plan)  # (5)
    pair = plan[dwell]
    xi = smallest_time(bodies, near, pair, rules.horizon, -1.0)
    evaluations = len(rows) + 1
    mode = next_mode(memory.mode, distance, xi, boundary, rules)  # Fig. 5
    if mode != SAFE:
        mine = course_under(bodies, me, pair[0], keep * pair[1])
        if is_wall_later(bodies, me, mine, own.sight, rules) or stops_within(
            own, paths, pose[me, 2], pair[0], pair[1], xi, rules.boundary_low
        ):
            met = first_robot(bodies, near, mine, rules.horizon, -1.0)
            mode = next_mode(memory.mode, distance, met, boundary, rules)
    rule = FOLLOW if dwell == 0 else PLAN
    interval = rules.longest_interval
    if mode == SAFE:
        interval *= rules.dwell[dwell] / rules.update_period
    else:
        pairs = room.pairs[: put_pairs(own.speeds, own.nu, own.omegas, room.pairs)]
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
        hold = min(hold, (own.stop_station - own.station) / pair[0])
    goes_on = mode == SAFE and hold == interval and dwell + 1 < len(rules.dwell)
    report[0], report[1] = tx, ty
    report[2], report[3], report[4] = distance, boundary, xi
    report[5] = evaluations
    dwell = dwell + 1 if goes_on else 0
    return pair[0], pair[1], hold, mode, rule, dwell, len(rows)


@compiled
def is_wall_later(bodies: Bodies, me: int, mine: Course, sight: Sight, rules: Rules) -> bool:
    """Whether no wall is met on course ``mine`` up to ``boundary_time_high``, below ``time_high``.

    Else a robot that had to stop, and is to turn at a corner only farther on, has the wall behind
    the corner ahead of it for ever: standing is what (13) likes best.
    """
    high = rules.boundary_time_high
    if high >= rules.time_high:
        return False
    return seen_time(bodies.shapes, bodies.shape[me], mine, sight, rules.time_high) > high


@compiled
def stops_within(
    own: EgoState,
    paths: Polylines,
    heading: float,
    v: float,
    omega: float,
    time: float,
    clear: float,
) -> bool:
    """Whether a robot under (v, omega) comes to its stop, and stands, within ``time``.

    A wall that it would only meet later puts nobody in danger. Otherwise it would depend on when
    the robot decides, and how it is turned, whether it still comes to a stop before an end wall.
    One that turns, so may turn otherwise, must stand ``clear`` [m] of its way before the wall:
    where it came nearer than that to a wall beside its stop, it backed and came back for ever.
    """
    dx, dy = point_at(paths, own.path, own.station)[2:]
    c, s = cos(heading), sin(heading)
    missing, advance = own.stop_station - own.station, v * (c * dx + s * dy)
    if advance <= 0.0:
        return False
    if omega == 0.0:
        return missing <= advance * time
    astray = asin(max(-1.0, min(1.0, (s * dx - c * dy) * copysign(1.0, v))))
    across = (0.5 * pi - astray * copysign(1.0, omega)) / abs(omega)  # farther it does not come
    turned = sin(astray + omega * min(time - clear / abs(v), across)) - sin(astray)
    return missing <= abs(v) * turned / omega


class ModeSwitching:
    """Formation, path following and collision avoidance by the paper's rules, all of them."""

    Settings = ModeSwitchingSettings
    modes = PAPER_MODES
    rules = RULES
    columns = STANDARD_COLUMNS

    def __init__(self, settings: ModeSwitchingSettings | None = None) -> None:
        self.settings = settings or ModeSwitchingSettings()
        self._rules = self.settings.rules()

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

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Decide for one robot from what it sees; ``memory`` is None or a `Memory`."""
        o = observation
        dwells = len(self._rules.dwell)
        memory = memory or Memory(mode=SAFE, plan=np.zeros((dwells, 2)), dwell=0)
        memory = memory._replace(plan=memory.plan.copy())
        station = np.array([o.reference_station, *(n.station for n in o.neighbours)])
        lead = np.array([o.lead, *(n.lead for n in o.neighbours)])
        rule = SpeedRule.of(o.formation, self.settings.speed)
        rows, neighbours = np.arange(len(station)), np.arange(1, len(station))
        pose = np.array([o.pose, *(other.pose for other in o.others)])
        bodies = Bodies(
            shapes=pack_parts([o.footprint, *(other.footprint for other in o.others)]),
            shape=np.arange(1 + len(o.others)),
            number=np.array([o.index, *(other.index for other in o.others)]),
            pose=pose,
            command=np.array([(o.v, o.omega), *((s.v, s.omega) for s in o.others)]),
            station=np.array([o.reference_station, *(other.station for other in o.others)]),
            facing=facings(pose),
        )
        walls = pack_parts([[part] for part in o.walls])
        own = EgoState(
            row=0,
            path=0,
            station=o.station,
            stop_station=o.stop_station,
            outside=o.path.outside,
            nu=forward_speed(rule, o.limits[0], 0, rows, neighbours, station, lead),
            forward_only=self.settings.forward_only(o.formation.active),
            speeds=np.array(self.settings.speeds if o.speeds is None else o.speeds),
            omegas=np.array(self.settings.omegas if o.omegas is None else o.omegas),
            sight=Sight(build_wall_tree(walls), o.pose[0], o.pose[1], o.range, nearest_walls(1)),
        )
        rows = considered(0, bodies.number, bodies.pose, bodies.station, o.range)
        report = np.empty(len(STANDARD_COLUMNS))
        v, omega, hold, mode, made_by, dwell, looked_at = decide_one(
            bodies, rows, own, o.path.lines, self._rules, memory,
            room_for(len(own.speeds) * len(own.omegas), dwells), report,
        )  # fmt: skip
        columns = (column.name for column in STANDARD_COLUMNS)
        return Decision(
            v=v,
            omega=omega,
            hold=hold,
            mode=PAPER_MODES[mode],
            memory=Memory(mode, memory.plan, dwell),
            rule=RULES[made_by],
            considered=bodies.number[rows[:looked_at]].tolist(),
            report=dict(zip(columns, report.tolist(), strict=True)),
        )

    def batch(self, scene: Scene) -> BatchController:
        """Set up the compiled form for all robots of a scene."""
        from .batch import ModeSwitchingBatch

        return ModeSwitchingBatch(self.settings, scene)
