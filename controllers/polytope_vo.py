"""Polytope velocity obstacles: of all velocities near the present one, the best that never hits.

Huang, Zeng, Chi, Sreenath, Liu and Su: Velocity obstacle for polytopic collision avoidance for
distributed multi-robot systems (RA-L 8, 2023), with the values and steps of its published code
(vo-polytope), which are numbered here:

1. Footprints and obstacles are inflated: each vertex moves out from the mean of the vertices.
2. The cone: velocities relative to another at which the two ever touch, while neither turns, lie
   between the two extreme differences of their vertices.
3. Where they overlap it is the half-plane towards the other.
4. The cone stands at the other's velocity (VO), halfway to the own one (RVO), or where one side of
   either meets (HRVO). What stands, or does not avoid, has a VO.
5. Candidates are a grid about the present velocity. The free one nearest to the preferred is taken.
6. Where none is free: the least of 10 s / t + difference to the preferred velocity, with t the time
   at which the first two discs touch.

With ``shape: circle`` the cones are those of the discs, too.

Departures: what counts for the range is the nearest point of a body (``range_of: mean`` is the
source's), and a wall is cut off there; nonconvex footprints have a cone for each pair of convex
parts; discs of robots lie about their reference points; near its stop a robot is slower; cones may
end at a ``horizon``. The velocity is projected on the heading and turned to: neither turning nor
the error of the heading is in the cones.

Two things of the source look like chance, and decide courses: where discs overlap already t is 0
for all candidates, and the first is taken, the one of the least x and y; the grid about standing
still misses it by a rounding, so that what stands before a wall has to go on.
"""

from __future__ import annotations

from math import floor, hypot, sqrt
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from physim.compiled import compiled
from physim.geometry.convex import frame_at, part_gap
from physim.geometry.shapes import FloatArray, IntArray, Part, Rows2, Rows6, Rows7
from physim.geometry.walls import parts_seen
from physim.parts.declarations import STANDARD_COLUMNS, Column, Rule

from .navigation import (
    PREFERRED,
    STILL,
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
from .settings import NotNegative, Positive

if TYPE_CHECKING:
    from physim.simulation.observation import View

LEAST_SINE = 0.01
"""[-] The sides of a half-plane meet nowhere: HRVO takes them for a cone of nearly 180 degrees."""


class PolytopeVOSettings(NavigationSettings):
    """Keys under ``controller:`` for ``type: polytope_vo``."""

    kind: Literal["vo", "rvo", "hrvo"] = Field(
        default="rvo",
        description='where the cones of robots that avoid, too, stand: "vo" at their velocities; '
        '"rvo" halfway to the own one; "hrvo" so that the other side is not passed on',
    )
    shape: Literal["polytope", "circle"] = Field(
        default="polytope",
        description='what is avoided: "polytope", the polygons; "circle", discs about them',
    )
    margin: NotNegative = Field(
        default=0.15,
        description="[m] by which each vertex, of the own footprint and of what is avoided, is "
        "moved out from the mean of all; edges move by less",
    )
    neighbour_range: Positive = Field(
        default=5.0, description="[m] distance up to which others and walls are avoided"
    )
    range_of: Literal["nearest", "mean"] = Field(
        default="nearest",
        description='what counts for it: "nearest", the nearest point; "mean", the mean of the '
        "vertices, as in the source, which does not see the end of a long wall",
    )
    window: Positive = Field(
        default=0.5, description="[m/s] by which either component may change in a decision"
    )
    grid: Positive = Field(default=0.05, description="[m/s] between candidates")
    penalty: NotNegative = Field(
        default=10.0, description="[m] weight of 1 / time to collision where no candidate is free"
    )
    horizon: Positive | None = Field(
        default=None,
        description="[s] within which a candidate must not lead to a collision; none: ever, as in "
        "the source. Then a wall behind the goal keeps robots from it",
    )
    turn_time: Positive = Field(
        default=0.2, description="[s] in which a robot turns to the velocity, if it can"
    )
    rounding: NotNegative = Field(
        default=0.01,
        description="[m/s, rad/s] commands are multiples of it, as in the source; 0: not rounded. "
        "It lets slow robots stand, and breaks symmetry",
    )


class Search(NamedTuple):
    """`PolytopeVOSettings` as the kernels take them."""

    reciprocal: bool
    hybrid: bool
    circle: bool
    nearest: bool
    margin: float
    reach: float
    slowness: float
    """[1/s] 1 / horizon"""
    window: float
    grid: float
    penalty: float
    turn_time: float
    rounding: float


class Cones(NamedTuple):
    """What a robot at (x, y) with velocity (ux, uy) avoids."""

    by: Search
    x: float
    y: float
    ux: float
    uy: float
    own: Rows2
    """inflated parts, world frame"""
    first: IntArray
    """of each part; behind them the end of the last"""
    parts: int
    radius: float
    """of the own disc"""
    cone: Rows7
    """apex, unit vectors of the left and the right side, distance from the apex [m/s] from which
    on it forbids"""
    disc: Rows6
    """the other's centre from here, sum of radii, a and b of the relative velocity a u - b"""
    size: IntArray
    """cones, discs"""


class Obstacle(NamedTuple):
    """One body to avoid: its disc, and how it moves."""

    x: float
    y: float
    radius: float
    vx: float
    vy: float
    is_shared: bool
    """whether it avoids, too"""


@compiled
def inflate(
    P: Part, c: float, s: float, x: float, y: float, by: float, out: Rows2, at: int
) -> None:
    """Write a part with its vertices moved out ``by`` [m], turned by (c, s), at (x, y). (1.)"""
    mx, my, many = 0.0, 0.0, P.end - P.first
    for k in range(P.first, P.end):
        mx, my = mx + P.vertices[k, 0] / many, my + P.vertices[k, 1] / many
    for k in range(many):
        dx, dy = P.vertices[P.first + k, 0] - mx, P.vertices[P.first + k, 1] - my
        size = hypot(dx, dy)
        f = 1.0 + by / size if size > 0.0 else 1.0
        dx, dy = mx + f * dx, my + f * dy
        out[at + k, 0], out[at + k, 1] = x + c * dx - s * dy, y + s * dx + c * dy


@compiled
def put_cone(
    cones: Cones, o: Obstacle, lx: float, ly: float, rx: float, ry: float, gap: float
) -> None:
    """Add the cone between two unit vectors, of a body ``gap`` [m] away. (4.)"""
    ax, ay, row, pace = o.vx, o.vy, cones.cone[cones.size[0]], 1.0
    if o.is_shared and cones.by.reciprocal and hypot(o.vx, o.vy) > STILL:
        hx, hy = 0.5 * (cones.ux - o.vx), 0.5 * (cones.uy - o.vy)
        ax, ay, pace = o.vx + hx, o.vy + hy, 0.5
        if cones.by.hybrid:
            cx, cy = lx + rx, ly + ry
            if cx * cx + cy * cy < STILL:  # a half-plane
                cx, cy = o.x - cones.x, o.y - cones.y
            sine = rx * ly - ry * lx
            k = (hx * ly - hy * lx) / (sine if sine > LEAST_SINE else LEAST_SINE)
            if cx * hy - cy * hx <= 0.0:
                ax, ay = ax - k * rx, ay - k * ry
            else:
                ax, ay = o.vx + k * rx, o.vy + k * ry
    row[0], row[1], row[2], row[3], row[4], row[5] = ax, ay, lx, ly, rx, ry
    row[6] = pace * gap * cones.by.slowness
    cones.size[0] += 1


@compiled
def put_half_plane(cones: Cones, o: Obstacle) -> None:
    """Add the half-plane towards what overlaps. (3.)"""
    dx, dy = o.x - cones.x, o.y - cones.y
    size = hypot(dx, dy)
    if size > 0.0:
        put_cone(cones, o, -dy / size, dx / size, dy / size, -dx / size, 0.0)


@compiled
def put_cones_of(cones: Cones, o: Obstacle, other: Part) -> None:
    """Add the cones of an inflated part of a body, one for each own part. (2.)"""
    V = other.vertices
    for p in range(cones.parts):
        mine = Part(cones.own, cones.first[p], cones.first[p + 1])
        gap = part_gap(mine, other, frame_at(1.0, 0.0, 0.0, 0.0), np.inf)
        if gap > cones.by.reach and cones.by.nearest:
            continue
        if gap <= 0.0:
            put_half_plane(cones, o)
            continue
        lx, ly, rx, ry = 0.0, 0.0, 0.0, 0.0
        for a in range(mine.first, mine.end):
            for b in range(other.first, other.end):
                dx, dy = V[b, 0] - cones.own[a, 0], V[b, 1] - cones.own[a, 1]
                if lx * dy - ly * dx > 0.0 or (lx == 0.0 and ly == 0.0):
                    lx, ly = dx, dy
                if rx * dy - ry * dx < 0.0 or (rx == 0.0 and ry == 0.0):
                    rx, ry = dx, dy
        left, right = hypot(lx, ly), hypot(rx, ry)
        put_cone(cones, o, lx / left, ly / left, rx / right, ry / right, gap)


@compiled
def put_disc(cones: Cones, o: Obstacle) -> bool:
    """Add two discs, and their cone where discs are avoided: are polygons to be looked at?"""
    row, size = cones.disc[cones.size[1]], cones.radius + o.radius
    dx, dy = o.x - cones.x, o.y - cones.y
    far = hypot(dx, dy)
    if far - (size if cones.by.nearest else 0.0) > cones.by.reach:
        return False
    row[0], row[1], row[2], row[3], row[4], row[5] = dx, dy, size, 1.0, o.vx, o.vy
    if o.is_shared and cones.by.reciprocal:
        row[3], row[4], row[5] = 2.0, o.vx + cones.ux, o.vy + cones.uy
    cones.size[1] += 1
    if cones.by.circle and far <= size:
        put_half_plane(cones, o)
    elif cones.by.circle:
        s = size / far
        c, gap = sqrt(1.0 - s * s), far - size
        dx, dy = dx / far, dy / far
        put_cone(cones, o, c * dx - s * dy, s * dx + c * dy, c * dx + s * dy, c * dy - s * dx, gap)
    return not cones.by.circle


@compiled
def put_robot(cones: Cones, team: Team, bodies: Bodies, me: int, j: int) -> None:
    """Add what row j forbids row ``me``."""
    V, start, body = team.shapes.vertices, team.shapes.part_start, bodies.number[j]
    x, y, c, s = bodies.pose[j, 0], bodies.pose[j, 1], bodies.facing[j, 0], bodies.facing[j, 1]
    vx, vy = velocity_of(bodies, j)
    radius = team.shapes.radius[body] + cones.by.margin
    o = Obstacle(x, y, radius, vx, vy, share_of(team, bodies, me, j) < 1.0)
    if not put_disc(cones, o):
        return
    for q in range(team.shapes.body_start[body], team.shapes.body_start[body + 1]):
        size = start[q + 1] - start[q]
        inflated = np.empty((size, 2))
        inflate(Part(V, start[q], start[q + 1]), c, s, x, y, cones.by.margin, inflated, 0)
        put_cones_of(cones, o, Part(inflated, 0, size))


@compiled
def put_wall(cones: Cones, wall: Part) -> None:
    """Add what a part of a wall forbids; a segment is cut off at the range."""
    size = wall.end - wall.first
    cut, inflated = np.empty((size, 2)), np.empty((size, 2))
    for k in range(size):
        cut[k, 0], cut[k, 1] = wall.vertices[wall.first + k, 0], wall.vertices[wall.first + k, 1]
    if size == 2 and cones.by.nearest:
        ex, ey, far = cut[1, 0] - cut[0, 0], cut[1, 1] - cut[0, 1], cones.by.reach + cones.radius
        ox, oy, square = cones.x - cut[0, 0], cones.y - cut[0, 1], ex * ex + ey * ey
        foot, beside = (ox * ex + oy * ey) / square, (ox * ey - oy * ex) ** 2 / square
        if beside > far * far:
            return
        half = sqrt((far * far - beside) / square)
        a, b = max(foot - half, 0.0), min(foot + half, 1.0)
        if a >= b:
            return
        cut[1, 0], cut[1, 1] = cut[0, 0] + b * ex, cut[0, 1] + b * ey
        cut[0, 0], cut[0, 1] = cut[0, 0] + a * ex, cut[0, 1] + a * ey
    inflate(Part(cut, 0, size), 1.0, 0.0, 0.0, 0.0, cones.by.margin, inflated, 0)
    x, y, radius = 0.0, 0.0, 0.0
    for k in range(size):
        x, y = x + cut[k, 0] / size, y + cut[k, 1] / size
    for k in range(size):
        radius = max(radius, hypot(inflated[k, 0] - x, inflated[k, 1] - y))
    o = Obstacle(x, y, radius, 0.0, 0.0, False)
    if put_disc(cones, o):
        put_cones_of(cones, o, Part(inflated, 0, size))


@compiled
def is_free(cones: Cones, x: float, y: float) -> bool:
    """Whether a velocity lies in none of the cones."""
    for k in range(cones.size[0]):
        c = cones.cone[k]
        dx, dy = x - c[0], y - c[1]
        if c[2] * dy - c[3] * dx < 0.0 and c[4] * dy - c[5] * dx > 0.0 and hypot(dx, dy) >= c[6]:
            return False
    return True


@compiled
def disc_time(cones: Cones, x: float, y: float) -> float:
    """Time [s] at which the first two discs touch at a velocity; 0 where they do, inf: never."""
    time = np.inf
    for k in range(cones.size[1]):
        o = cones.disc[k]
        vx, vy = o[3] * x - o[4], o[3] * y - o[5]
        a, b, c = vx * vx + vy * vy, o[0] * vx + o[1] * vy, o[0] * o[0] + o[1] * o[1] - o[2] * o[2]
        if c <= 0.0:
            return 0.0
        root = b * b - a * c
        if b > 0.0 and root > 0.0:
            time = min(time, (b - sqrt(root)) / a)
    return time


@compiled
def choose(cones: Cones, px: float, py: float, most: float) -> tuple[int, float, float]:
    """Number of the rule, and the candidate for a preferred velocity, up to ``most`` an axis."""
    window, grid = cones.by.window, cones.by.grid
    low_x, low_y = max(cones.ux - window, -most), max(cones.uy - window, -most)
    many_x = 1 + int((min(cones.ux + window, most) - low_x) / grid - STILL)
    many_y = 1 + int((min(cones.uy + window, most) - low_y) / grid - STILL)
    step_x, step_y = (low_x + grid) - low_x, (low_y + grid) - low_y  # as numpy's arange has it
    best, nearest, found_x, found_y = np.inf, np.inf, 0.0, 0.0
    for i in range(many_x):
        for j in range(many_y):
            x, y = low_x + step_x * i, low_y + step_y * j
            off = hypot(x - px, y - py)
            nearest = min(nearest, off)
            if off < best and is_free(cones, x, y):  # (5.)
                best, found_x, found_y = off, x, y
    if best < np.inf:
        return (0 if best == nearest else 1), found_x, found_y
    found_x, found_y = low_x, low_y
    for i in range(many_x):
        for j in range(many_y):
            x, y = low_x + step_x * i, low_y + step_y * j
            time = disc_time(cones, x, y)
            if time > 0.0 and cones.by.penalty / time + hypot(x - px, y - py) < best:  # (6.)
                best = cones.by.penalty / time + hypot(x - px, y - py)
                found_x, found_y = x, y
    return 2, found_x, found_y


@compiled
def put_choice(
    team: Team, bodies: Bodies, asked: Asked, by: Search, k: int, chosen: FloatArray
) -> int:
    """Write the velocity that the k-th robot asked chooses into ``chosen`` (2,): the rule."""
    shapes, walls, i, me = team.shapes, team.walls.walls, asked.robot[k], asked.row[k]
    first, parts = shapes.body_start[i], shapes.body_start[i + 1] - shapes.body_start[i]
    x, y, radius = bodies.pose[me, 0], bodies.pose[me, 1], shapes.radius[i] + by.margin
    sight = sight_of(team, bodies, me)
    seen = parts_seen(sight, x, y, min(sight.reach, by.reach + radius + by.margin))
    discs = seen.size + asked.start[k + 1] - asked.start[k]
    other = seen.size
    for m in range(asked.start[k], asked.start[k + 1]):
        body = bodies.number[asked.near[m]]
        other += shapes.body_start[body + 1] - shapes.body_start[body]
    offset, own = shapes.part_start[first], np.empty((shapes.part_start[first + parts], 2))
    starts, cone = np.empty(parts + 1, np.int64), np.empty((parts * other, 7))
    disc, count = np.empty((discs, 6)), np.zeros(2, np.int64)
    for p in range(parts + 1):
        starts[p] = shapes.part_start[first + p] - offset
    for p in range(parts):
        mine = Part(shapes.vertices, shapes.part_start[first + p], shapes.part_start[first + p + 1])
        c, s = bodies.facing[me, 0], bodies.facing[me, 1]
        inflate(mine, c, s, x, y, by.margin, own, starts[p])
    ux, uy = velocity_of(bodies, me)
    cones = Cones(by, x, y, ux, uy, own, starts, parts, radius, cone, disc, count)
    for m in range(asked.start[k], asked.start[k + 1]):
        put_robot(cones, team, bodies, me, asked.near[m])
    for m in range(seen.size):
        part = seen.number[m]
        put_wall(cones, Part(walls.vertices, walls.part_start[part], walls.part_start[part + 1]))
    px, py = asked.preferred[k, 0], asked.preferred[k, 1]
    rule, chosen[0], chosen[1] = choose(cones, px, py, team.limits[i, 0])
    return rule


@compiled
def put_polytope_vo(
    team: Team,
    bodies: Bodies,
    asked: Asked,
    by: Search,
    command: Rows2,
    rule: IntArray,
    chosen: Rows2,
) -> None:
    """Decide for all that are asked: commands, numbers of rules, and velocities [m/s]."""
    for k in range(asked.size):
        i, heading = asked.robot[k], bodies.pose[asked.row[k], 2]
        rule[k] = put_choice(team, bodies, asked, by, k, chosen[k])
        v, omega = project_and_turn(
            chosen[k, 0], chosen[k, 1], heading, team.limits[i, 0], team.limits[i, 1], by.turn_time
        )
        if by.rounding > 0.0:
            most, fastest = team.limits[i, 0], team.limits[i, 1]
            v = min(by.rounding * floor(v / by.rounding + 0.5), most)
            omega = by.rounding * floor(omega / by.rounding + 0.5)
            omega = min(max(omega, -fastest), fastest)
        command[k, 0], command[k, 1] = v, omega


class PolytopeVO(Navigating):
    """Velocity obstacles of polygons, by Huang and others."""

    Settings = PolytopeVOSettings
    settings: PolytopeVOSettings
    rules = (
        PREFERRED,
        Rule("free", "nearest velocity that is free of all cones"),
        Rule("penalty", "none is free: long time to a collision"),
        STOP,
    )
    columns = (
        *STANDARD_COLUMNS[:2],
        Column("chosen_x", "m/s", "velocity chosen"),
        Column("chosen_y", "m/s", "velocity chosen"),
    )

    def avoid(
        self, view: View, team: Team, bodies: Bodies, asked: Asked, memory: dict[str, NDArray[Any]]
    ) -> tuple[FloatArray, IntArray, FloatArray]:
        """Take the best velocity of the grid."""
        s, many = self.settings, asked.size
        by = Search(
            s.kind != "vo", s.kind == "hrvo", s.shape == "circle", s.range_of == "nearest",
            s.margin, s.neighbour_range,
            1.0 / s.horizon if s.horizon else 0.0, s.window, s.grid, s.penalty, s.turn_time,
            s.rounding,
        )  # fmt: skip
        command, rule, chosen = np.empty((many, 2)), np.empty(many, np.int64), np.empty((many, 2))
        put_polytope_vo(team, bodies, asked, by, command, rule, chosen)
        return command, rule, chosen
