"""The social force model: a wish, and a push by everything that is near.

Helbing and Molnar: Social force model for pedestrian dynamics (Phys. Rev. E 51, 1995), with the
values of its open implementation svenkreiss/socialforce. Terms are named by the symbols of the
source. A robot changes its velocity u at the rate

    F = (preferred - u) / tau + sum of w f_ij + sum of f_iW,

where f_ij falls off exponentially with the ellipse b that another sweeps within its next step, and
f_iW with the distance of a wall. What lies behind counts less.

Departures: the model has points, so z is the gap between the footprints along its witness points
here, and pushes the reference point; nothing fluctuates (but see ``nudge``); the force is
integrated in `SUBSTEPS` with gaps that change by the motion alone, as the walls' is stiff; a place
that adjoining walls share pushes once; others push whole, half a push has no meaning here: only
``priority: ahead`` leaves out who is behind. The velocity is projected on the heading, and turned
to. Nothing rules a contact out.
"""

from __future__ import annotations

from math import cos, exp, hypot, pi
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physim.compiled import compiled
from physim.geometry.bodies import body_separation
from physim.geometry.convex import Witness, frame_at, part_witness
from physim.geometry.shapes import FloatArray, IntArray, Part, Rows2
from physim.geometry.walls import all_seen
from physim.parts.declarations import STANDARD_COLUMNS, Column, Rule

from .navigation import (
    PREFERRED,
    STOP,
    Asked,
    Navigating,
    NavigationSettings,
    Team,
    project_and_turn,
    sight_of,
    velocity_of,
)
from .priority import Bodies
from .settings import NotNegative, Positive

if TYPE_CHECKING:
    from physim.simulation.observation import View

SUBSTEPS = 10
"""In which the force is integrated over a decision"""
LEAST = 1e-3
"""[m] Gaps count as no less: at a touch the direction of a push is still known"""
FELT = 0.1
"""[m/s²] A push below it leaves the robot to its wish"""
SAME = 1e-6
"""[m] Nearest points of two walls no farther apart are one"""


class SocialForceSettings(NavigationSettings):
    """Keys under ``controller:`` for ``type: social_force``."""

    strength: NotNegative = Field(
        default=2.1, description="[m²/s²] V_0 of the push by others (1995: 2.1)"
    )
    width: Positive = Field(
        default=0.3, description="[m] sigma, over which the push by others falls off (1995: 0.3)"
    )
    wall_strength: NotNegative = Field(
        default=10.0, description="[m²/s²] U_0 of the push by walls (1995: 10)"
    )
    wall_width: Positive = Field(
        default=0.2, description="[m] R, over which the push by walls falls off (1995: 0.2)"
    )
    relaxation: Positive = Field(
        default=0.5, description="[s] tau, in which a robot comes to its wish (1995: 0.5)"
    )
    step_ahead: NotNegative = Field(
        default=0.4, description="[s] by which the motion of others stretches their push (1995: 2)"
    )
    sight: Annotated[float, Field(gt=0.0, le=2.0 * pi)] = Field(
        default=3.490658503988659,
        description="[rad] 2 phi: angle about the wish within which all counts (1995: 200 degrees)",
    )
    behind: Annotated[float, Field(ge=0.0, le=1.0)] = Field(
        default=0.5, description="[-] c: weight of what is outside of it (1995: 0.5)"
    )
    fastest: Positive = Field(
        default=1.3, description="[-] greatest speed, as a multiple of the wished one (1995: 1.3)"
    )
    turn_time: Positive = Field(
        default=0.2, description="[s] in which a robot turns to the velocity, if it can"
    )


class Forces(NamedTuple):
    """`SocialForceSettings` as the kernels take them."""

    strength: float
    width: float
    wall_strength: float
    wall_width: float
    relaxation: float
    step_ahead: float
    cos_sight: float
    """of phi"""
    behind: float
    fastest: float
    turn_time: float


class Sources(NamedTuple):
    """What pushes a robot: others first, then walls."""

    gap: Rows2
    """(n, 2) [m] from the nearest point of each to that of the robot"""
    velocity: Rows2
    """(n, 2) [m/s]"""
    others: int
    size: int


@compiled
def push_of_robot(forces: Forces, x: float, y: float, vx: float, vy: float) -> tuple[float, float]:
    """f_ij [m/s²] by another that is (x, y) [m] away and moves at (vx, vy): minus the gradient of
    V_0 exp(-b / sigma), 2 b = sqrt((|z| + |z - y|)² - |y|²), y = v Δt."""
    sx, sy = forces.step_ahead * vx, forces.step_ahead * vy
    near, later = hypot(x, y), max(hypot(x - sx, y - sy), LEAST)
    b = 0.5 * max((near + later) ** 2 - sx * sx - sy * sy, LEAST * LEAST) ** 0.5
    slope = forces.strength / forces.width * exp(-b / forces.width) * (near + later) / (4.0 * b)
    return slope * (x / near + (x - sx) / later), slope * (y / near + (y - sy) / later)


@compiled
def push_of_wall(forces: Forces, x: float, y: float) -> tuple[float, float]:
    """f_iW [m/s²] by a wall that is (x, y) [m] away: minus the gradient of U_0 exp(-d / R)."""
    d = hypot(x, y)
    size = forces.wall_strength / forces.wall_width * exp(-d / forces.wall_width) / d
    return size * x, size * y


@compiled
def push(
    forces: Forces, near: Sources, wx: float, wy: float, px: float, py: float, time: float
) -> tuple[float, float]:
    """All pushes [m/s²] on a robot that has moved by (px, py) [m] in a ``time`` [s], and wants to
    go along (wx, wy)."""
    fx, fy, wish = 0.0, 0.0, hypot(wx, wy)
    for k in range(near.size):
        gx, gy = near.gap[k, 0], near.gap[k, 1]
        d = hypot(gx, gy)
        vx, vy = near.velocity[k, 0], near.velocity[k, 1]
        x, y = gx + px - time * vx, gy + py - time * vy
        if x * gx + y * gy < LEAST * d:
            x, y = LEAST * gx / d, LEAST * gy / d
        if k < near.others:
            ax, ay = push_of_robot(forces, x, y, vx, vy)
            sight = forces.cos_sight * wish * hypot(ax, ay)
            weight = 1.0 if -(wx * ax + wy * ay) >= sight else forces.behind  # w
            ax, ay = weight * ax, weight * ay
        else:
            ax, ay = push_of_wall(forces, x, y)
        fx, fy = fx + ax, fy + ay
    return fx, fy


@compiled
def put_gap(near: Sources, k: int, found: Witness) -> None:
    """Write the gap from what is found first to the robot, found second, into row k."""
    d = max(found.distance, LEAST)
    near.gap[k, 0], near.gap[k, 1] = d * found.nx, d * found.ny


@compiled
def put_social(
    team: Team,
    bodies: Bodies,
    asked: Asked,
    forces: Forces,
    command: Rows2,
    rule: IntArray,
    felt: FloatArray,
) -> None:
    """Decide for all that are asked: commands, numbers of rules, and pushes felt [m/s²]."""
    shapes, W, start = team.shapes, team.walls.walls.vertices, team.walls.walls.part_start
    dt = team.update_period / SUBSTEPS
    for k in range(asked.size):
        i, me = asked.robot[k], asked.row[k]
        pose, seen = bodies.pose[me], all_seen(sight_of(team, bodies, me))
        others, room = asked.start[k + 1] - asked.start[k], 2 * seen.size
        gap, velocity = np.zeros((others + seen.size, 2)), np.zeros((others + seen.size, 2))
        touched, count = np.empty(room), others
        near = Sources(gap, velocity, others, others + seen.size)
        for m in range(others):
            j = asked.near[asked.start[k] + m]
            put_gap(
                near, m, body_separation(shapes, bodies.number[j], bodies.pose[j], shapes, i, pose)
            )
            velocity[m, 0], velocity[m, 1] = velocity_of(bodies, j)
        f = frame_at(bodies.facing[me, 0], bodies.facing[me, 1], pose[0], pose[1])
        for m in range(seen.size):
            part, nearest = seen.number[m], Witness(np.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            wall = Part(W, start[part], start[part + 1])
            for q in range(shapes.body_start[i], shapes.body_start[i + 1]):
                one = part_witness(
                    wall, Part(shapes.vertices, shapes.part_start[q], shapes.part_start[q + 1]), f
                )
                if one.distance < nearest.distance:
                    nearest = one
            known = False
            for n in range(count - others):
                dx, dy = touched[2 * n] - nearest.ax, touched[2 * n + 1] - nearest.ay
                known = known or hypot(dx, dy) <= SAME
            if not known:
                touched[2 * (count - others)] = nearest.ax
                touched[2 * (count - others) + 1] = nearest.ay
                put_gap(near, count, nearest)
                count += 1
        near = Sources(gap, velocity, others, count)

        wx, wy = asked.preferred[k, 0], asked.preferred[k, 1]
        ux, uy = velocity_of(bodies, me)
        fx, fy = push(forces, near, wx, wy, 0.0, 0.0, 0.0)
        felt[k] = hypot(fx, fy)
        rule[k] = 1 if felt[k] > FELT else 0
        px, py, most = 0.0, 0.0, forces.fastest * hypot(wx, wy)
        for n in range(SUBSTEPS):
            fx, fy = push(forces, near, wx, wy, px, py, n * dt)
            ux += dt * ((wx - ux) / forces.relaxation + fx)  # F
            uy += dt * ((wy - uy) / forces.relaxation + fy)
            speed = hypot(ux, uy)
            if speed > most:
                ux, uy = ux * most / speed, uy * most / speed
            px, py = px + dt * ux, py + dt * uy
        command[k, 0], command[k, 1] = project_and_turn(
            ux, uy, pose[2], team.limits[i, 0], team.limits[i, 1], forces.turn_time
        )


class SocialForce(Navigating):
    """The social force model of Helbing and Molnar, for polygons."""

    Settings = SocialForceSettings
    settings: SocialForceSettings
    rules = (PREFERRED, Rule("pushed", "the social force"), STOP)
    columns = (
        *STANDARD_COLUMNS[:2],
        Column("push", "m/s²", "size of all pushes by others and walls"),
    )

    def kept_from_walls(self) -> tuple[str, float]:
        """It has no distance that it keeps."""
        return "wall_width", 0.0

    def avoid(
        self, view: View, team: Team, bodies: Bodies, asked: Asked, memory: dict[str, NDArray[Any]]
    ) -> tuple[FloatArray, IntArray, FloatArray]:
        """Follow the force from the present velocity for a period."""
        s, many = self.settings, asked.size
        forces = Forces(
            s.strength, s.width, s.wall_strength, s.wall_width, s.relaxation, s.step_ahead,
            cos(0.5 * s.sight), s.behind, s.fastest, s.turn_time,
        )  # fmt: skip
        command, rule, felt = np.empty((many, 2)), np.empty(many, np.int64), np.empty(many)
        put_social(team, bodies, asked, forces, command, rule, felt)
        return command, rule, felt[:, None]
