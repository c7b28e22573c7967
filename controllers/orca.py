"""ORCA of discs, with the bound of NH-ORCA on how far a unicycle strays from the velocity it takes.

Sources: van den Berg, Guy, Lin and Manocha, Reciprocal n-body collision avoidance (ISRR 2009), as
its authors' RVO2 has it; Alonso-Mora, Breitenmoser, Rufli, Beardsley and Siegwart, Optimal
reciprocal collision avoidance for multiple non-holonomic robots (DARS 2010), by the formulas of
collvoid. A velocity u of Robot i avoids Robot j for ``time_horizon`` if u - u_j is outside a cone
that a disc cuts off. Of the smallest change that takes the present one out of it each of a pair
makes half: one half-plane for every neighbour, and one for every edge of walls. The permitted
velocity nearest to the preferred one is taken; where there is none, that which violates the
half-planes of others least and keeps those of walls (`half_planes`).

A robot that turns towards u within T, on an arc, and then drives straight, is never farther from
where u would have taken it than E = |u| T |sin(angle / 2)|. Discs are larger by E, and only
velocities are taken that keep E.

Departures: a robot is the disc about its reference point that holds its footprint, whatever its
shape. The present velocity is that of the held command. Movers and obstacles that can be pushed do
not give way, so they are avoided whole. Who is near is what the robot senses, at most
``max_neighbours``. Another's E is taken to be one's own; E also shrinks near walls, and is not
smoothed. Trackable velocities are sampled all around rather than ahead only, and what lies between
the samples but beyond the bound is slowed to it.
"""

from __future__ import annotations

from math import cos, hypot, pi, sin, sqrt, tan
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from physim.compiled import compiled
from physim.geometry.bodies import point_segment
from physim.geometry.shapes import FloatArray, IntArray, Rows2, Rows3, Rows4, Rows8
from physim.geometry.walls import Parts, Sight, parts_seen
from physim.parts.declarations import Column, Rule
from physim.world.scene import Scene

from .half_planes import PARALLEL, nearest_in, violation_by
from .navigation import (
    PREFERRED,
    STILL,
    STOP,
    Asked,
    Navigating,
    NavigationSettings,
    Team,
    share_of,
    sight_of,
    turn_to,
    velocity_of,
)
from .priority import Bodies
from .settings import NotNegative, Positive

if TYPE_CHECKING:
    from physim.simulation.observation import View

SAMPLES = 20
"""Directions in which the trackable speed is sampled: every 18 degrees, as in collvoid"""
TINY = 1e-12
"""[m/s] for which no direction is worked out"""


class OrcaSettings(NavigationSettings):
    """Keys under ``controller:`` for ``type: orca``."""

    time_horizon: Positive = Field(
        default=5.0, description="[s] for which others are avoided (RVO2's example Blocks: 5)"
    )
    wall_time_horizon: Positive = Field(
        default=5.0, description="[s] for which walls are avoided (RVO2's example Blocks: 5)"
    )
    max_neighbours: Annotated[int, Field(ge=0, le=1000)] = Field(
        default=10, description="number of others that are avoided, the nearest (RVO2: 10)"
    )
    bounded: bool = Field(
        default=True,
        description="whether only velocities are taken that the robot follows within the tracking "
        "error, as in NH-ORCA; otherwise any, as in ORCA, which supposes that it turns at once",
    )
    turning_time: Positive = Field(
        default=0.4, description="[s] T in which a robot turns to a new velocity (collvoid: 0.4)"
    )
    error_min: Positive = Field(
        default=0.02, description="[m] tracking error E allowed in contact (collvoid: 0.02)"
    )
    error_max: Positive = Field(
        default=0.1,
        description="[m] tracking error E allowed where all else is two radii away (collvoid: 0.1)",
    )
    margin: NotNegative = Field(
        default=0.0, description="[m] distance kept between discs, and to walls (RVO2: 0)"
    )
    nudge: NotNegative = Field(
        default=0.0001,
        description="[m/s] the preferred velocity is off by up to this, drawn from the seed at "
        "each decision: it breaks symmetry, which may make robots stand for ever (RVO2: 0.0001)",
    )

    @model_validator(mode="after")
    def _errors_in_order(self) -> OrcaSettings:
        if self.error_max < self.error_min:
            raise ValueError(
                f"error_max is {self.error_max:g} m, below error_min {self.error_min:g} m; it must "
                "be at least that"
            )
        return self


class WallEdges(NamedTuple):
    """Edges of walls, each from a to b and seen from its right; those of boundaries both ways."""

    edge: Rows8
    """(E, 8) a, b [m], unit directions of the edge that ends at a and of the one that begins at b;
    at the end of a wall the edge back"""
    start: IntArray
    """(P + 1,) part p of the walls has the edges from ``start[p]`` on"""


class OrcaRules(NamedTuple):
    """Edges of walls, and the numbers of `OrcaSettings`."""

    edges: WallEdges
    horizon: float
    wall_horizon: float
    most: int
    bounded: bool
    turning_time: float
    error_min: float
    error_max: float


class Taken(NamedTuple):
    """What is decided, a row for each of the M robots asked."""

    command: Rows2
    rule: IntArray
    report: Rows3


def edges_of(scene: Scene) -> WallEdges:
    """Edges of the walls of a scene."""
    walls, joins = scene.walls, scene.pieces.joins
    rows, start = [np.zeros((0, 8))], [0]
    parts = np.split(walls.vertices, walls.part_start[1:-1])
    for p, part in enumerate(parts):
        a, b = part, np.roll(part, -1, axis=0)
        way = (b - a) / np.hypot(*(b - a).T)[:, None]
        before, after = np.roll(way, 1, axis=0), np.roll(way, -1, axis=0)
        for end in range(2):
            if len(part) == 2 and (other := joins[p, end]) >= 0:
                here, (first, last) = part[end], parts[other]
                off = (last if np.array_equal(first, here) else first) - here
                off /= np.hypot(*off)
                after[1 - end], before[end] = off, -off
        rows.append(np.hstack((a, b, before, after)))
        start.append(start[-1] + len(part))
    return WallEdges(np.concatenate(rows), np.array(start))


@compiled
def put_line(lines: Rows4, k: int, px: float, py: float, dx: float, dy: float) -> None:
    """Write half-plane k: point p, unit direction d."""
    lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3] = px, py, dx, dy


@compiled
def leg(x: float, y: float, r: float, side: float) -> tuple[float, float]:
    """Unit direction of the tangent to a disc of radius r about (x, y): 1 left of it, -1 right."""
    square = x * x + y * y
    along = sqrt(max(0.0, square - r * r))
    return (x * along - side * y * r) / square, (side * x * r + y * along) / square


@compiled
def put_agent_line(
    team: Team, bodies: Bodies, me: int, j: int, r: float, horizon: float, lines: Rows4, k: int
) -> None:
    """Write as half-plane k which velocities of row ``me`` avoid row j, r [m] the radii of both.

    Those that touch are to be apart within a period.
    """
    px, py = bodies.pose[j, 0] - bodies.pose[me, 0], bodies.pose[j, 1] - bodies.pose[me, 1]
    ux, uy = velocity_of(bodies, me)
    vx, vy = velocity_of(bodies, j)
    apart = px * px + py * py > r * r
    time = horizon if apart else team.update_period
    rel_x, rel_y = ux - vx, uy - vy
    wx, wy = rel_x - px / time, rel_y - py / time  # from the middle of the disc that cuts off
    size = max(hypot(wx, wy), TINY)
    ahead = wx * px + wy * py
    if not apart or (ahead < 0.0 and ahead * ahead > r * r * size * size):  # the disc
        nx, ny = wx / size, wy / size
        dx, dy = ny, -nx
        cx, cy = (r / time - size) * nx, (r / time - size) * ny
    else:
        side = 1.0 if px * wy - py * wx > 0.0 else -1.0
        dx, dy = leg(px, py, r, side)
        dx, dy = side * dx, side * dy
        along = rel_x * dx + rel_y * dy
        cx, cy = along * dx - rel_x, along * dy - rel_y
    share = share_of(team, bodies, me, j)
    put_line(lines, k, ux + share * cx, uy + share * cy, dx, dy)


@compiled
def edges_seen(edges: WallEdges, sight: Sight, within: float) -> Parts:
    """Edges in sight within so many [m] that are seen from their right, nearest first."""
    parts, many = parts_seen(sight, sight.x, sight.y, within), 0
    for k in range(parts.size):
        many += edges.start[parts.number[k] + 1] - edges.start[parts.number[k]]
    found, gap, count = np.empty(many, np.int64), np.empty(many), 0
    for k in range(parts.size):
        for e in range(edges.start[parts.number[k]], edges.start[parts.number[k] + 1]):
            a, bx, by = edges.edge[e], edges.edge[e, 2], edges.edge[e, 3]
            if (bx - a[0]) * (sight.y - a[1]) - (by - a[1]) * (sight.x - a[0]) >= 0.0:
                continue
            distance = point_segment(sight.x, sight.y, a[0], a[1], bx, by)
            if distance >= within:
                continue
            at = count
            while at > 0 and gap[at - 1] > distance:
                found[at], gap[at] = found[at - 1], gap[at - 1]
                at -= 1
            found[at], gap[at] = e, distance
            count += 1
    return Parts(found, count)


@compiled
def put_wall_line(
    edge: FloatArray,
    sight: Sight,
    r: float,
    ux: float,
    uy: float,
    time: float,
    lines: Rows4,
    k: int,
) -> int:
    """Write behind ``k`` half-planes which velocities avoid an edge (8,), if it needs one;
    return how many there are then.

    The own velocity is u. What is beyond a corner out of sight is not known: the wall ends there.
    """
    ax, ay, bx, by = edge[0] - sight.x, edge[1] - sight.y, edge[2] - sight.x, edge[3] - sight.y
    dx, dy = bx - ax, by - ay
    length = hypot(dx, dy)
    dx, dy = dx / length, dy / length
    prev_x, prev_y, next_x, next_y = edge[4], edge[5], edge[6], edge[7]
    from_a, from_b = hypot(ax, ay), hypot(bx, by)
    if from_a > sight.reach:
        prev_x, prev_y = -dx, -dy
    if from_b > sight.reach:
        next_x, next_y = -dx, -dy
    a_convex, b_convex = prev_x * dy - prev_y * dx >= 0.0, dx * next_y - dy * next_x >= 0.0

    rest = r / time
    at_ax, at_ay, at_bx, at_by = ax / time, ay / time, bx / time, by / time
    for j in range(k):  # covered by that of another edge
        from_line = min(violation_by(lines[j], at_ax, at_ay), violation_by(lines[j], at_bx, at_by))
        if from_line - rest >= -PARALLEL:
            return k

    s = -(ax * dx + ay * dy) / length
    from_line = abs(ax * dy - ay * dx)
    if s < 0.0 and from_a <= r:  # it touches
        if a_convex:
            put_line(lines, k, 0.0, 0.0, -ay / from_a, ax / from_a)
            k += 1
        return k
    if s > 1.0 and from_b <= r:
        if b_convex and bx * next_y - by * next_x >= 0.0:
            put_line(lines, k, 0.0, 0.0, -by / from_b, bx / from_b)
            k += 1
        return k
    if 0.0 <= s <= 1.0 and from_line <= r:
        put_line(lines, k, 0.0, 0.0, -dx, -dy)
        return k + 1

    is_one = from_line <= r  # seen obliquely: both legs from the near end
    if is_one and s < 0.0:
        if not a_convex:
            return k
        bx, by, at_bx, at_by = ax, ay, at_ax, at_ay
        b_convex, next_x, next_y = True, dx, dy
    elif is_one:
        if not b_convex:
            return k
        ax, ay, at_ax, at_ay = bx, by, at_bx, at_by
        a_convex, prev_x, prev_y = True, dx, dy
    left_x, left_y, right_x, right_y = -dx, -dy, dx, dy
    left_foreign, right_foreign = False, False
    if a_convex:
        left_x, left_y = leg(ax, ay, r, 1.0)
        if left_y * prev_x - left_x * prev_y >= 0.0:  # it points into the edge before
            left_x, left_y, left_foreign = -prev_x, -prev_y, True
    if b_convex:
        right_x, right_y = leg(bx, by, r, -1.0)
        if right_x * next_y - right_y * next_x <= 0.0:
            right_x, right_y, right_foreign = next_x, next_y, True

    off_x, off_y = ux - at_ax, uy - at_ay
    t = 0.5
    if not is_one:
        t = (off_x * dx + off_y * dy) * time / length
    t_left = off_x * left_x + off_y * left_y
    t_right = (ux - at_bx) * right_x + (uy - at_by) * right_y
    at_x, at_y = at_ax, at_ay
    is_end = (t < 0.0 and t_left < 0.0) or (is_one and t_left < 0.0 and t_right < 0.0)
    if not is_end and t > 1.0 and t_right < 0.0:
        at_x, at_y, is_end = at_bx, at_by, True
    if is_end:
        size = max(hypot(ux - at_x, uy - at_y), TINY)
        nx, ny = (ux - at_x) / size, (uy - at_y) / size
        put_line(lines, k, at_x + rest * nx, at_y + rest * ny, ny, -nx)
        return k + 1
    cut, to_left, to_right = np.inf, np.inf, np.inf
    if not is_one and 0.0 <= t <= 1.0:
        cut = abs(off_x * dy - off_y * dx)
    if t_left >= 0.0:
        to_left = hypot(off_x - t_left * left_x, off_y - t_left * left_y)
    if t_right >= 0.0:
        to_right = hypot(ux - at_bx - t_right * right_x, uy - at_by - t_right * right_y)
    if cut <= to_left and cut <= to_right:
        dx, dy = -dx, -dy
    elif to_left <= to_right:
        if left_foreign:
            return k
        dx, dy = left_x, left_y
    else:
        if right_foreign:
            return k
        dx, dy, at_x, at_y = -right_x, -right_y, at_bx, at_by
    put_line(lines, k, at_x - rest * dy, at_y + rest * dx, dx, dy)
    return k + 1


@compiled
def trackable_speed(turn: float, error: float, time: float, v_max: float, omega: float) -> float:
    """Greatest speed [m/s] that a unicycle follows within ``error`` [m], ``turn`` [rad] off."""
    turn = abs(turn)
    if turn > omega * time:
        return min(v_max, error * omega / turn)  # it turns on the spot, then goes
    lost = time * sin(0.5 * turn)
    return v_max if lost * v_max <= error else error / lost


@compiled
def put_trackable_lines(
    heading: float, error: float, time: float, limits: FloatArray, lines: Rows4
) -> int:
    """Write half-planes of the velocities followed within ``error`` [m]; return how many.

    None where only the greatest speed bounds them.
    """
    count, v_max = 0, limits[0]
    speed = trackable_speed(-pi, error, time, v_max, limits[1])
    x, y = -speed * cos(heading), -speed * sin(heading)
    for k in range(1, SAMPLES + 1):
        turn, before, before_x, before_y = 2.0 * pi * k / SAMPLES - pi, speed, x, y
        speed = trackable_speed(turn, error, time, v_max, limits[1])
        x, y = speed * cos(heading + turn), speed * sin(heading + turn)
        if before < v_max or speed < v_max:
            length = hypot(x - before_x, y - before_y)
            put_line(lines, count, x, y, (x - before_x) / length, (y - before_y) / length)
            count += 1
    return count


@compiled
def tracking_command(
    speed: float, turn: float, time: float, omega_max: float
) -> tuple[float, float]:
    """(v, omega) that follows a speed [m/s] in a direction ``turn`` [rad] off, in ``time`` [s]."""
    if abs(turn) > omega_max * time:
        return 0.0, omega_max if turn > 0.0 else -omega_max
    half = 0.5 * turn
    return speed * (half / tan(half) if half != 0.0 else 1.0), turn / time


@compiled
def put_velocity(
    k: int, team: Team, bodies: Bodies, asked: Asked, rules: OrcaRules, out: Taken
) -> None:
    """Decide for the k-th robot asked."""
    i, me, edges = asked.robot[k], asked.row[k], rules.edges
    command, report = out.command[k], out.report[k]
    x, y, heading = bodies.pose[me, 0], bodies.pose[me, 1], bodies.pose[me, 2]
    ux, uy = velocity_of(bodies, me)
    limits, radius = team.limits[i], team.shapes.radius[i] + team.margin

    near, gap, others, room = np.empty(rules.most, np.int64), np.empty(rules.most), 0, np.inf
    for m in range(asked.start[k], asked.start[k + 1]):
        j = asked.near[m]
        distance = hypot(bodies.pose[j, 0] - x, bodies.pose[j, 1] - y)
        room = min(room, distance - radius - team.shapes.radius[bodies.number[j]])
        if others == rules.most and (others == 0 or distance >= gap[others - 1]):
            continue
        others = min(others + 1, rules.most)
        at = others - 1
        while at > 0 and gap[at - 1] > distance:
            near[at], gap[at] = near[at - 1], gap[at - 1]
            at -= 1
        near[at], gap[at] = j, distance
    sight = sight_of(team, bodies, me)
    walls = edges_seen(edges, sight, rules.wall_horizon * limits[0] + radius)
    error = 0.0
    if rules.bounded:
        if walls.size:
            edge = edges.edge[walls.number[0]]
            room = min(room, point_segment(x, y, edge[0], edge[1], edge[2], edge[3]) - radius)
        share = min(1.0, max(0.0, room) / (2.0 * radius))
        error = rules.error_min + (rules.error_max - rules.error_min) * share * share

    lines, count, hard = np.empty((walls.size + SAMPLES + others, 4)), 0, 0
    for m in range(walls.size):
        count = put_wall_line(
            edges.edge[walls.number[m]], sight, radius + error, ux, uy, rules.wall_horizon, lines,
            count,
        )  # fmt: skip
    of_walls = count
    if rules.bounded:
        count += put_trackable_lines(heading, error, rules.turning_time, limits, lines[count:])
    hard = count
    for m in range(others):
        j = near[m]
        both = 2.0 if bodies.station[j] < np.inf else 1.0  # a robot strays as well
        r = radius + team.shapes.radius[bodies.number[j]] + both * error
        put_agent_line(team, bodies, me, j, r, rules.horizon, lines, count)
        count += 1
    wish_x, wish_y = asked.preferred[k, 0], asked.preferred[k, 1]
    found = nearest_in(lines, count, hard, limits[0], wish_x, wish_y)
    out.rule[k] = 0
    for m in range(count):
        if (m < of_walls or m >= hard) and violation_by(lines[m], wish_x, wish_y) > 0.0:
            out.rule[k] = 2 if found.violation > 0.0 else 1
    report[0], report[1], report[2] = count, found.violation, error

    speed, turn = hypot(found.x, found.y), turn_to(found.x, found.y, heading)
    if rules.bounded:
        time = rules.turning_time
        speed = min(speed, trackable_speed(turn, error, time, limits[0], limits[1]))
    if speed <= STILL:
        command[0], command[1] = 0.0, 0.0
        return
    command[0], command[1] = tracking_command(speed, turn, rules.turning_time, limits[1])


@compiled
def put_orca(team: Team, bodies: Bodies, asked: Asked, rules: OrcaRules, out: Taken) -> None:
    """Decide for the robots asked."""
    for k in range(asked.size):
        put_velocity(k, team, bodies, asked, rules, out)


class Orca(Navigating):
    """Optimal reciprocal collision avoidance of discs, for unicycles."""

    Settings = OrcaSettings
    settings: OrcaSettings
    rules = (
        PREFERRED,
        Rule("half_planes", "nearest to its preferred velocity in all half-planes"),
        Rule("least_violation", "no velocity is in all half-planes: violates others' least"),
        STOP,
    )
    columns = (
        *Navigating.columns,
        Column("half_planes", "-", "half-planes of walls, of what can be tracked, and of others"),
        Column("violation", "m/s", "by how much the velocity violates the worst half-plane"),
        Column("tracking_error", "m", "how far the robot may stray from its velocity"),
    )

    def avoid(
        self, view: View, team: Team, bodies: Bodies, asked: Asked, memory: dict[str, NDArray[Any]]
    ) -> tuple[FloatArray, IntArray, FloatArray]:
        """Decide for the robots asked by the half-planes of others and of walls."""
        own, many = self.settings, asked.size
        rules = OrcaRules(
            view.prepared(edges_of), own.time_horizon, own.wall_time_horizon, own.max_neighbours,
            own.bounded, own.turning_time, own.error_min, own.error_max,
        )  # fmt: skip
        out = Taken(np.empty((many, 2)), np.empty(many, np.int64), np.empty((many, 3)))
        put_orca(team, bodies, asked, rules, out)
        return out
