"""What methods that choose a velocity share, so that they differ in how they avoid and no more.

Each robot has a preferred velocity: towards the target (3) on its own path, as fast as (7) says in
a formation, slower where it would pass its stop station within a period. A method moves it out of
what others and walls forbid, and makes a command of what is left. Robots at their stop stations
stand. All decide every ``update_period``.

A method is one file: settings that extend `NavigationSettings`, a subclass of `Navigating` with its
`avoid`, and below that a kernel over the robots of an `Asked`.
"""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from physim.compiled import compiled
from physim.errors import Fault, Location
from physim.geometry.path import point_at
from physim.geometry.shapes import Flags, FloatArray, IntArray, Polylines, Rows2, Shapes
from physim.geometry.walls import NearestWalls, Sight, WallTree, nearest_walls
from physim.parts.controller import Decisions
from physim.parts.declarations import AT_STOP, SAFE, STANDARD_COLUMNS, Column, Mode, Rule
from physim.randomness import uniform
from physim.world.scene import Scene

from .formation import SpeedRule, forward_speed, put_neighbours
from .path_following import target_on_path
from .priority import Bodies, has_priority, row_of
from .settings import NotNegative, Positive, Speed
from .world_checks import speed_doubts, speed_faults, stop_doubts

if TYPE_CHECKING:
    from physim.simulation.observation import View
    from physim.world import World

AVOIDING = Mode("avoiding", "#e69f00", "avoiding", danger=True)
PREFERRED = Rule("preferred", "takes its preferred velocity")
"""The first of a method's rules"""
STOP = Rule("stop", "stands at its stop station")
"""The last of them"""
STILL = 0.001
"""[m/s] A velocity below has no direction"""
ALIGNED = 0.001
"""[rad] Angles below are not turned by"""


class NavigationSettings(BaseModel):
    """Keys under ``controller:`` that all these methods have."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    speed: Speed = 1.0
    look_ahead: Positive = Field(
        default=2.0,
        description="[m] distance along the path from the robot's projection to its target, (3)",
    )
    update_period: Positive = Field(default=0.1, description="[s] time between two decisions")
    arrival_tolerance: NotNegative = Field(
        default=0.06,
        description="[m] distance from its stop station along the path at which a robot stands",
    )
    priority: Literal["shared", "ahead"] = Field(
        default="shared",
        description='who avoids: "shared", both of a pair take half; "ahead", those further along '
        "the reference path are avoided whole and those behind not at all, as the paper's "
        "controller does. Movers and obstacles that can be pushed are always avoided whole",
    )
    margin: NotNegative = Field(
        default=0.05, description="[m] distance kept between footprints, and to walls"
    )
    nudge: NotNegative = Field(
        default=0.0,
        description="[m/s] the preferred velocity is off by up to this, drawn from the seed at "
        "each decision: it breaks symmetry, which may make robots stand for ever",
    )


class Team(NamedTuple):
    """What does not change in a run, for all N robots: the scene, and `NavigationSettings`."""

    shapes: Shapes
    walls: WallTree
    nearest: NearestWalls
    """for `sight_of`; it only saves time"""
    paths: Polylines
    stop_station: FloatArray
    stop: Rows2
    """(N, 2) [m] places of the stop stations"""
    beside: FloatArray
    """(N,) [m] a quarter of the width: beyond that it goes back to its stop"""
    limits: Rows2
    """(N, 2) largest v [m/s] and omega [rad/s]"""
    speed_rule: SpeedRule
    lead: FloatArray
    adjacency: IntArray
    """(N N,)"""
    listed: int
    """N, or 0 where it is empty"""
    formation_range: float
    reach: float
    """[m] within which robots sense others and walls"""
    look_ahead: float
    update_period: float
    arrival_tolerance: float
    ahead: bool
    """whether the priority is ``ahead``"""
    margin: float


class Asked(NamedTuple):
    """The M robots that decide, none of which has arrived, and what each goes by."""

    robot: IntArray
    """(M,) numbers of the robots"""
    row: IntArray
    """(M,) its row of `Bodies`"""
    target: Rows2
    """(M, 2) [m]"""
    preferred: Rows2
    """(M, 2) velocity [m/s], world frame"""
    near: IntArray
    """(E,) rows of what is within range and to be avoided, increasing: of the k-th robot those
    from ``start[k]`` to ``start[k + 1]``"""
    start: IntArray
    """(M + 1,)"""
    size: int
    """M"""


@compiled
def share_of(team: Team, bodies: Bodies, me: int, j: int) -> float:
    """How much of avoiding row j is up to row ``me``: all, half or nothing."""
    if bodies.station[j] == np.inf:
        return 1.0  # no robot
    if not team.ahead:
        return 0.5
    number, station = bodies.number, bodies.station
    return 1.0 if has_priority(station[me], number[me], station[j], number[j]) else 0.0


@compiled
def velocity_of(bodies: Bodies, j: int) -> tuple[float, float]:
    """Velocity [m/s] of the reference point of row j, world frame."""
    c, s = bodies.facing[j, 0], bodies.facing[j, 1]
    v, lateral = bodies.twist[j, 0], bodies.twist[j, 2]
    return v * c - lateral * s, v * s + lateral * c


@compiled
def sight_of(team: Team, bodies: Bodies, me: int) -> Sight:
    """Walls as row ``me`` sees them."""
    return Sight(team.walls, bodies.pose[me, 0], bodies.pose[me, 1], team.reach, team.nearest)


@compiled
def turn_to(ux: float, uy: float, heading: float) -> float:
    """Angle [rad], -pi to pi, by which a robot turns from its heading to a velocity."""
    error = atan2(uy, ux) - heading
    return atan2(sin(error), cos(error))


@compiled
def project_and_turn(
    ux: float, uy: float, heading: float, v_max: float, omega_max: float, turn_time: float
) -> tuple[float, float]:
    """(v, omega) for a velocity [m/s]: the part of it along the heading, never backwards.

    The robot turns towards it within ``turn_time`` [s], or as fast as it can.
    """
    speed = hypot(ux, uy)
    if speed <= STILL:
        return 0.0, 0.0
    turn = turn_to(ux, uy, heading)
    v = max(0.0, min(speed, v_max) * cos(turn))
    if abs(turn) < ALIGNED:
        return v, 0.0
    return v, min(max(turn / turn_time, -omega_max), omega_max)


@compiled
def speed_of(
    team: Team, i: int, me: int, number: IntArray, station: FloatArray, rows: int, room: IntArray
) -> float:
    """Speed nu of Robot i [m/s] within its limits, in a formation by (7).

    From so many ``rows``, of which ``me`` is its own; ``room`` (rows,) is room for work.
    """
    many = 0
    if team.speed_rule.active:
        many = put_neighbours(
            me, number, station, rows, team.adjacency, team.listed, team.formation_range, room
        )
    top = team.limits[i, 0]
    return forward_speed(team.speed_rule, top, me, number, room, many, station, team.lead)


@compiled
def put_going(
    team: Team,
    bodies: Bodies,
    due: IntArray,
    many: int,
    first: IntArray,
    end: IntArray,
    station: FloatArray,
    goes: Flags,
) -> None:
    """Write which of so ``many`` robots due (M,) are not at their stops yet."""
    for k in range(many):
        i = due[k]
        me = first[i] + row_of(bodies.number[first[i] :], end[i] - first[i], i)
        off = hypot(bodies.pose[me, 0] - team.stop[i, 0], bodies.pose[me, 1] - team.stop[i, 1])
        away = team.stop_station[i] - station[i] > team.arrival_tolerance
        goes[k] = away or off > max(team.beside[i], team.arrival_tolerance)


@compiled
def put_asked(
    team: Team,
    bodies: Bodies,
    first: IntArray,
    end: IntArray,
    station: FloatArray,
    asked: Asked,
    room: int,
) -> int:
    """Write everything of ``asked`` but its robots, of whom each has the rows from ``first`` to
    ``end`` and a ``station`` on its own path (N,).

    Returns how many rows are near, of which there is ``room`` for so many.
    """
    count, rows = 0, np.empty(bodies.size, np.int64)
    for k in range(asked.size):
        i = asked.robot[k]
        a, many = first[i], end[i] - first[i]
        me = row_of(bodies.number[a:], many, i)
        nu = speed_of(team, i, me, bodies.number[a:], bodies.station[a:], many, rows)
        me += a
        x, y = bodies.pose[me, 0], bodies.pose[me, 1]
        tx, ty, _, _ = target_on_path(team.paths, i, station[i], team.look_ahead)
        missing = team.stop_station[i] - station[i]
        if missing <= team.arrival_tolerance:  # it came beside its stop
            tx, ty = team.stop[i, 0], team.stop[i, 1]
            missing = hypot(tx - x, ty - y)
        nu = min(nu, missing / team.update_period)
        far = hypot(tx - x, ty - y)
        pace = nu / far if far > 0.0 else 0.0
        asked.row[k] = me
        asked.target[k, 0], asked.target[k, 1] = tx, ty
        asked.preferred[k, 0], asked.preferred[k, 1] = pace * (tx - x), pace * (ty - y)
        asked.start[k] = count
        for j in range(a, a + many):
            dx, dy = bodies.pose[j, 0] - x, bodies.pose[j, 1] - y
            if j == me or not dx * dx + dy * dy <= team.reach * team.reach:  # nor what is not seen
                continue
            if share_of(team, bodies, me, j) > 0.0:
                if count < room:
                    asked.near[count] = j
                count += 1
    asked.start[asked.size] = count
    return count


class Navigating:
    """A method that chooses a velocity, or a command, near the preferred one."""

    Settings: ClassVar[type[NavigationSettings]] = NavigationSettings
    settings: NavigationSettings
    modes = (SAFE, AVOIDING, AT_STOP)
    rules: tuple[Rule, ...] = (PREFERRED, STOP)
    """`PREFERRED` first, `STOP` last"""
    columns: tuple[Column, ...] = STANDARD_COLUMNS[:2]
    """target first"""
    drives = ("unicycle",)
    told = "always"  # robots tell their commands, which are their velocities here

    def __init__(self, settings: NavigationSettings | None = None) -> None:
        self.settings = settings or self.Settings()

    def world_faults(self, world: World, where: Location) -> list[Fault]:
        """Refuse a speed of its own beside that of a formation."""
        return speed_faults(self.settings, world, where)

    def world_doubts(self, world: World, where: Location) -> list[Fault]:
        """Doubt speeds out of reach, and stops short of arrival."""
        return [
            *speed_doubts(self.settings, world, where, by_7=True),
            *stop_doubts(self.settings, world),
        ]

    def kept_from_walls(self) -> tuple[str, float]:
        """Setting by which it keeps off walls, and how near [m]."""
        return "margin", self.settings.margin

    def avoid(
        self, view: View, team: Team, bodies: Bodies, asked: Asked, memory: dict[str, NDArray[Any]]
    ) -> tuple[FloatArray, IntArray, FloatArray]:
        """Decide for the M robots asked, who may know their own row and those near them.

        Returns commands (M, 2), numbers of rules (M,), and what the columns behind the target
        report (M, columns - 2). Rows of ``memory`` are those of all N robots.
        """
        raise NotImplementedError

    def decide_all(self, view: View, due: IntArray, memory: dict[str, NDArray[Any]]) -> Decisions:
        """Decide for robots ``due`` from what each of them may know."""
        team, s, many = view.prepared(self._team), view.sensed, len(due)
        bodies = Bodies.of(view, team.shapes)
        goes = np.empty(many, np.bool_)
        put_going(team, bodies, due, many, s.first, s.end, s.station, goes)
        robots = due[goes]
        size = len(robots)
        asked = Asked(
            robots, np.empty(size, np.int64), np.empty((size, 2)), np.empty((size, 2)),
            np.empty(16 * size, np.int64), np.empty(size + 1, np.int64), size,
        )  # fmt: skip
        given = team, bodies, s.first, s.end, s.station
        while (near := put_asked(*given, asked, len(asked.near))) > len(asked.near):
            asked = asked._replace(near=np.empty(near, np.int64))
        if self.settings.nudge > 0.0:
            share, turn = uniform(view.scene.seed, "nudge", s.step, robots, width=2).T
            off = np.stack((np.cos(2.0 * pi * turn), np.sin(2.0 * pi * turn)), axis=1)
            asked.preferred[:] += self.settings.nudge * share[:, None] * off
        chosen, followed, own = self.avoid(view, team, bodies, asked, memory)

        command, considered = np.zeros((many, 2)), np.zeros(many + 1, np.int64)
        rule, mode = np.full(many, len(self.rules) - 1), np.full(many, self.modes.index(AT_STOP))
        report = np.full((many, len(self.columns)), np.nan)
        command[goes], rule[goes], mode[goes] = chosen, followed, np.minimum(followed, 1)
        report[goes] = np.concatenate((asked.target, own), axis=1)
        considered[1:][goes] = np.diff(asked.start)
        return Decisions(
            due, command, np.full(many, team.update_period), mode, rule, report,
            bodies.number[asked.near[:near]], np.cumsum(considered),
        )  # fmt: skip

    def _team(self, scene: Scene) -> Team:
        settings, plan, shapes = self.settings, scene.formation, scene.shapes
        corner = shapes.part_start[shapes.body_start[: scene.robots]]
        end = shapes.part_start[shapes.body_start[scene.robots]]
        y = shapes.vertices[:end, 1]
        width = np.maximum.reduceat(y, corner) - np.minimum.reduceat(y, corner)
        stops = [point_at(scene.paths, i, at)[:2] for i, at in enumerate(scene.stop_station)]
        return Team(
            shapes=scene.shapes,
            walls=scene.wall_tree,
            nearest=nearest_walls(scene.robots),
            paths=scene.paths,
            stop_station=scene.stop_station,
            stop=np.array(stops),
            beside=0.25 * width,
            limits=np.ascontiguousarray(scene.limits[:, :2]),
            speed_rule=SpeedRule.of(plan, settings.speed),
            lead=plan.lead,
            adjacency=plan.adjacency.reshape(-1),
            listed=len(plan.adjacency),
            formation_range=plan.range,
            reach=scene.sensing_range,
            look_ahead=settings.look_ahead,
            update_period=settings.update_period,
            arrival_tolerance=settings.arrival_tolerance,
            ahead=settings.priority == "ahead",
            margin=settings.margin,
        )
