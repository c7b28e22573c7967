"""A control barrier function: the nearest command to the wished one that closes no gap too fast.

Ames, Xu, Grizzle and Tabuada: Control barrier function based quadratic programs for safety critical
systems (IEEE TAC 62(8), 2017), for polygons and unicycles. Values and wish are those of an open
implementation, tkkim-robot/safe_control. With d the gap between a point a of the robot and a point
b of something else, n the unit vector from b to a, and h = d - margin, the barrier is

    h' = n . e v + n . J (a - x) omega - n . u_b >= -kappa h,                                 (1)

a line in the plane of v and omega. The gap of two convex parts is the least of the gaps between a
vertex of either and the point of the other that is nearest to it, each of which is smooth. Each
makes a line: one whose gap is larger by g than the least may also fall by g within the period, so
that after it h is (1 - kappa T) times what it was, or more. Of a pair of robots each takes half,
n . e v + n . J (a - x) omega >= -kappa h / 2, and both together keep (1), whatever the other does
with its half. What gives no way is avoided whole, u_b seen.

The command minimises the squares of its changes, each as a share of the limit, in all half-planes
and the box of the limits, exactly (`half_planes`). To stand is permitted as long as every h >= 0
and whatever moves gives way.

Departures: the implementation has discs, and a barrier of distance and heading; it counts changes
in m/s and rad/s. A linear kappa is held for a period, so kappa times the period is 1 at most, and
the margin takes up how gaps curve meanwhile. Where nothing is permitted, the implementation stops;
here the half-planes of walls are kept and those of others violated least. As there, robots may go
backwards, if only to give way: the wish never does.
"""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from physim.compiled import compiled
from physim.geometry.bodies import frame_from
from physim.geometry.convex import Frame, before, frame_at, from_vertex, part_witness, seen_back
from physim.geometry.shapes import FloatArray, IntArray, Part, Rows2, Rows3, Rows4, Shapes
from physim.geometry.walls import parts_seen
from physim.parts.declarations import Column, Rule

from .half_planes import nearest_in, nearest_permitted, put_box
from .navigation import (
    PREFERRED,
    STOP,
    Asked,
    Navigating,
    NavigationSettings,
    Team,
    project_and_turn,
    share_of,
    sight_of,
    velocity_of,
)
from .priority import Bodies
from .settings import Positive

if TYPE_CHECKING:
    from physim.simulation.observation import View

BOX = 4
"""Half-planes of the limits"""
TINY = 1e-9
"""[m/s] A barrier that no command moves by more is left out"""
TOUCHING = 1e-9
"""[m] Gaps below have no direction between the nearest points"""


class CbfQpSettings(NavigationSettings):
    """Keys under ``controller:`` for ``type: cbf_qp``."""

    rate: Positive = Field(
        default=1.0,
        description="[1/s] kappa: a gap may close in a second by this share of what it is beyond "
        "the margin; at most 1 / update_period (safe_control: 1)",
    )
    turn_time: Positive = Field(
        default=0.5,
        description="[s] in which the wished command turns to the preferred velocity, if it can "
        "(safe_control: 0.5)",
    )

    @model_validator(mode="after")
    def _slow_enough(self) -> CbfQpSettings:
        if self.rate * self.update_period > 1.0:
            raise ValueError(
                f"rate is {self.rate:g} 1/s; with update_period {self.update_period:g} s it must "
                f"be at most {1.0 / self.update_period:g} 1/s, else gaps may close within a period"
            )
        return self


class Filtered(NamedTuple):
    """What is decided, a row for each of the M robots asked."""

    command: Rows2
    rule: IntArray
    report: Rows3


class Approached(NamedTuple):
    """Something else as a robot sees it, in its own frame, and what of (1) is up to the robot."""

    frame: Frame
    ux: float
    uy: float
    """[m/s] velocity of its reference point"""
    omega: float
    """[rad/s]"""
    share: float
    rate: float
    """[1/s] kappa"""
    period: float
    """[s] T"""
    margin: float
    v_max: float
    omega_max: float


@compiled
def put_barrier(
    other: Approached, gap: float, ax: float, ay: float, d: float, nx: float, ny: float,
    lines: Rows4, k: int,
) -> int:  # fmt: skip
    """Write (1) behind k half-planes, unless all commands keep it; return how many there are.

    The least gap of the parts is ``gap`` [m]. The points are d [m] apart, a is the robot's own, n
    leads to it, all in its frame.
    """
    fall = other.rate * (gap - other.margin) + (d - gap) / other.period
    bx, by = ax - d * nx - other.frame.tx, ay - d * ny - other.frame.ty
    closing = nx * (other.ux - other.omega * by) + ny * (other.uy + other.omega * bx)  # n . u_b
    least = closing - other.share * fall
    gv, gw = nx * other.v_max, (ax * ny - ay * nx) * other.omega_max
    size = hypot(gv, gw)
    if size <= TINY or abs(gv) + abs(gw) <= -least:
        return k
    gv, gw, least = gv / size, gw / size, least / size
    lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3] = least * gv, least * gw, gw, -gv
    return k + 1


@compiled
def nearest_of_part(P: Part, x: float, y: float) -> tuple[float, float]:
    """Point of the outline of a part that is nearest to (x, y)."""
    V, best, px, py = P.vertices, np.inf, 0.0, 0.0
    for m in range(P.first, P.end):
        k = before(P, m)
        ex, ey = V[m, 0] - V[k, 0], V[m, 1] - V[k, 1]
        dx, dy = x - V[k, 0], y - V[k, 1]
        square, along = ex * ex + ey * ey, 0.0
        if square > 0.0:
            along = min(max((ex * dx + ey * dy) / square, 0.0), 1.0)
        dx, dy = dx - along * ex, dy - along * ey
        if dx * dx + dy * dy < best:
            best, px, py = dx * dx + dy * dy, x - dx, y - dy
    return px, py


@compiled
def put_barriers(other: Approached, P: Part, Q: Part, lines: Rows4, k: int) -> tuple[int, float]:
    """Write the barriers of a convex part P of the robot and Q of something else.

    Returns how many half-planes there are then, and the gap [m] of the parts.
    """
    one, many = part_witness(P, Q, other.frame), Q.end - Q.first
    gap = one.distance
    if gap <= TOUCHING:
        k = put_barrier(other, gap, one.ax, one.ay, gap, -one.nx, -one.ny, lines, k)
        return k, gap
    placed, px, py = np.empty((many, 2)), P.vertices[P.first, 0], P.vertices[P.first, 1]
    for j in range(many):
        dx, dy = from_vertex(P, P.first, Q, Q.first + j, other.frame)
        bx, by = px + dx, py + dy
        placed[j, 0], placed[j, 1] = bx, by
        ax, ay = nearest_of_part(P, bx, by)
        d = hypot(ax - bx, ay - by)
        k = put_barrier(other, gap, ax, ay, d, (ax - bx) / d, (ay - by) / d, lines, k)
    for m in range(P.first, P.end):
        ax, ay = P.vertices[m, 0], P.vertices[m, 1]
        bx, by = nearest_of_part(Part(placed, 0, many), ax, ay)
        d = hypot(ax - bx, ay - by)
        k = put_barrier(other, gap, ax, ay, d, (ax - bx) / d, (ay - by) / d, lines, k)
    return k, gap


@compiled
def put_all_barriers(
    other: Approached, shapes: Shapes, i: int, theirs: Shapes, first: int, end: int, lines: Rows4,
    k: int,
) -> tuple[int, float]:  # fmt: skip
    """`put_barriers` of robot i and the parts of others from ``first`` to before ``end``."""
    least = np.inf
    for q in range(first, end):
        Q = Part(theirs.vertices, theirs.part_start[q], theirs.part_start[q + 1])
        for p in range(shapes.body_start[i], shapes.body_start[i + 1]):
            P = Part(shapes.vertices, shapes.part_start[p], shapes.part_start[p + 1])
            k, gap = put_barriers(other, P, Q, lines, k)
            least = min(least, gap)
    return k, least


@compiled
def put_filtered(
    k: int, team: Team, bodies: Bodies, asked: Asked, rate: float, turn_time: float, out: Filtered
) -> None:
    """Decide for the k-th robot asked."""
    i, me = asked.robot[k], asked.row[k]
    shapes, walls, pose, near = team.shapes, team.walls.walls, bodies.pose[me], asked.near
    c, s, begin, end = (
        bodies.facing[me, 0],
        bodies.facing[me, 1],
        asked.start[k],
        asked.start[k + 1],
    )
    v_max, omega_max, start = team.limits[i, 0], team.limits[i, 1], shapes.body_start
    # Walls beyond cannot be neared too fast.
    reached = shapes.radius[i] + team.margin + (v_max + shapes.radius[i] * omega_max) / rate
    seen = parts_seen(sight_of(team, bodies, me), pose[0], pose[1], reached)

    parts, vertices, own = seen.size, 0, start[i + 1] - start[i]
    for m in range(seen.size):
        vertices += walls.part_start[seen.number[m] + 1] - walls.part_start[seen.number[m]]
    for m in range(begin, end):
        j = bodies.number[near[m]]
        parts += start[j + 1] - start[j]
        vertices += shapes.part_start[start[j + 1]] - shapes.part_start[start[j]]
    parts *= shapes.part_start[start[i + 1]] - shapes.part_start[start[i]]
    lines, count, least = np.empty((BOX + parts + own * vertices, 4)), BOX, np.inf
    disc = put_box(lines, -1.0, -1.0, 1.0, 1.0)
    other = Approached(
        seen_back(frame_at(c, s, pose[0], pose[1])), 0.0, 0.0, 0.0, 1.0, rate,
        team.update_period, team.margin, v_max, omega_max,
    )  # fmt: skip
    for m in range(seen.size):
        part = seen.number[m]
        count, gap = put_all_barriers(other, shapes, i, walls, part, part + 1, lines, count)
        least = min(least, gap)
    hard = count
    for m in range(begin, end):
        j, share = bodies.number[near[m]], share_of(team, bodies, me, near[m])
        ux, uy, turn = 0.0, 0.0, 0.0
        if share == 1.0:
            ux, uy = velocity_of(bodies, near[m])
            turn = bodies.twist[near[m], 1]
        other = Approached(
            frame_from(pose, c, s, bodies.pose[near[m]]), c * ux + s * uy, c * uy - s * ux, turn,
            share, rate, team.update_period, team.margin, v_max, omega_max,
        )  # fmt: skip
        count, gap = put_all_barriers(
            other, shapes, i, shapes, start[j], start[j + 1], lines, count
        )  # fmt: skip
        least = min(least, gap)

    x, y = project_and_turn(
        asked.preferred[k, 0], asked.preferred[k, 1], pose[2], v_max, omega_max, turn_time
    )
    x, y = x / v_max, y / omega_max
    kept, _, _ = nearest_permitted(lines, hard, disc, x, y, False)
    found = nearest_in(lines, count, hard if kept == hard else BOX, disc, x, y)
    out.rule[k] = 2 if found.violation > 0.0 else 1
    if found.x == x and found.y == y:
        out.rule[k] = 0
    out.command[k, 0] = v_max * min(max(found.x, -1.0), 1.0)
    out.command[k, 1] = omega_max * min(max(found.y, -1.0), 1.0)
    out.report[k, 0], out.report[k, 1] = least - team.margin, count - BOX
    out.report[k, 2] = found.violation


@compiled
def put_cbf_qp(
    team: Team, bodies: Bodies, asked: Asked, rate: float, turn_time: float, out: Filtered
) -> None:
    """Decide for the robots asked."""
    for k in range(asked.size):
        put_filtered(k, team, bodies, asked, rate, turn_time, out)


class CbfQp(Navigating):
    """A control barrier function for polygons: a quadratic program on the wished command."""

    Settings = CbfQpSettings
    settings: CbfQpSettings
    rules = (
        PREFERRED,
        Rule("barriers", "the command nearest to the wished one that all barriers permit"),
        Rule("least_violation", "barriers permit no command: violates those of others least"),
        STOP,
    )
    columns = (
        *Navigating.columns,
        Column("barrier", "m", "least h: smallest gap to all in range, less the margin"),
        Column("half_planes", "-", "barriers that some command within the limits violates"),
        Column("violation", "-", "by how much the worst is violated, in shares of the limits"),
    )

    def avoid(
        self, view: View, team: Team, bodies: Bodies, asked: Asked, memory: dict[str, NDArray[Any]]
    ) -> tuple[FloatArray, IntArray, FloatArray]:
        """Decide for the robots asked by the barriers to others and to walls."""
        own, many = self.settings, asked.size
        out = Filtered(np.empty((many, 2)), np.empty(many, np.int64), np.empty((many, 3)))
        put_cbf_qp(team, bodies, asked, own.rate, own.turn_time, out)
        return out
