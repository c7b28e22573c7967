"""Cases drawn by number, and each written as a world: two robots, or one and something else.

The same seed and number give the same case, whatever the others. Two robots meet at random, side by
side, in rows, or graze each other; one meets walls, corners, obstacles, a mover, a box to push. A
layout is planned from the meeting: the poses at which the two would overlap or touch are chosen
first, and each is taken back along its arc. All lengths [m], about the origin of the place. The
world of a case is a small one that ``physim run`` replays, to the bit at the same coordinates; a
box to push to rounding.

Footprints are random: convex, boxes, nonconvex. They come from a store that depends on the
seed alone, since cutting an outline into convex parts costs more than the case itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan, cos, hypot, pi, sin
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.random import Generator

from physim.geometry.bodies import body_distance, body_separation
from physim.geometry.motion import Twist, arc
from physim.geometry.polygon import (
    circumscribed_radius,
    convex_parts,
    counter_clockwise,
    is_simple,
    signed_area,
    smallest_width,
)
from physim.geometry.shapes import FloatArray, Shapes, pack_parts
from physim.randomness import stream
from physim.tolerances import TUNNEL_FRACTION
from physim.world import World
from physim.world.scene import DENSITY

STEPS = 48
"""Steps that a case lasts."""
TIME_STEPS = (0.005, 0.01, 0.02, 0.05, 0.1)
"""[s]"""
CLEAR = 1e-8
"""[m] least distance at the start: a world with less is refused as touching"""
TRIES = 50
"""Layouts tried; the last resort is a robot pair far enough apart"""
SPACING = 60.0
"""[m] between the places of two cases: twice what any of them can reach"""
HALF_WIDTH = 29.0
"""[m] from the middle of the place to the boundary that closes it"""
LEAST = 1e-6
"""[m/s, rad/s] least limit of a robot that does not use it"""
STORED = 200
"""Footprints of each sort."""
THINNEST = 0.05
"""[m] least width of a convex part"""
FASTEST = 3.0
"""[m/s]"""
TURNING = 4.0
"""[rad/s] fastest turn"""
WHEELBASE = 0.1
"""[m] of cars: short, so that they can take every arc"""
ROOM = 0.96
"""[-] share of the advance that the tunnelling rule allows, left for rounding"""

Place = tuple[float, float]
Walls = tuple[Sequence[FloatArray], ...]
"""Convex parts or segments of each line and each solid"""


class Footprint(NamedTuple):
    """A robot's shape in its own frame [m]."""

    outline: FloatArray
    """(n, 2) counter-clockwise"""
    parts: tuple[FloatArray, ...]
    """convex, as a world with this outline has them"""
    radius: float
    """[m] of the disc about the reference point"""
    width: float
    """[m] least width of a part"""
    mass: float
    """[kg]"""
    packed: Shapes
    """the one body, for kernels"""


class Layout(NamedTuple):
    """What stands and moves, before it is known to be clear at the start."""

    robots: tuple[Footprint, ...]
    """two, or one where something stands"""
    start: FloatArray
    """(r, 3) x, y [m], heading [rad], world frame, at sample 0"""
    command: FloatArray
    """(r, 3) twists that are held"""
    lines: tuple[FloatArray, ...] = ()
    """boundaries as drawn, (n, 2) [m] each, world frame"""
    solids: tuple[tuple[FloatArray, ...], ...] = ()
    """outline (n, 2) [m] of each obstacle and its convex parts, world frame"""
    second: Literal["robot", "mover", "pushed"] = "robot"
    """what the second of two is"""


Store = dict[str, tuple[Footprint, ...]]
"""Footprints to draw from, by sort"""


def build_store(seed: int) -> Store:
    """Footprints of one seed, each simple, not too thin, and cut as a world would have it cut."""

    def usable(name: str, k: int) -> Footprint:
        rng = stream(seed, f"crash test, {name}", k)
        while True:
            if not is_simple(points := SORTS[name](rng)):
                continue
            outline = counter_clockwise(points)
            parts = convex_parts(outline)
            if (width := smallest_width(parts)) >= THINNEST:
                radius, mass = circumscribed_radius(outline), DENSITY * abs(signed_area(outline))
                return Footprint(outline, parts, radius, width, mass, pack_parts([parts]))

    return {name: tuple(usable(name, k) for k in range(STORED)) for name in SORTS}


def _box(rng: Generator) -> FloatArray:
    """Box about its centre; one in four is 1.0 x 0.6 m, with which the engine was seen to err."""
    length, width = (1.0, 0.6) if rng.random() < 0.25 else rng.uniform(0.2, 2.0, 2)
    x, y = 0.5 * length, 0.5 * width
    return np.array([(-x, -y), (x, -y), (x, y), (-x, y)])


def _convex(rng: Generator) -> FloatArray:
    """Corners on a turned ellipse; the reference point may lie off the middle, even outside."""
    corners = rng.integers(3, 9)
    angles = np.sort(rng.uniform(-pi, pi, corners))
    points = np.stack((np.cos(angles), np.sin(angles)), axis=1) * rng.uniform(0.15, 1.0, 2)
    turn = rng.uniform(-pi, pi)
    c, s = np.cos(turn), np.sin(turn)
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + _shift(rng))


def _nonconvex(rng: Generator) -> FloatArray:
    """L, U, T, or a star about the origin."""
    a, b = rng.uniform(0.3, 1.2, 2)
    s, t, u = rng.uniform(0.2, 0.8, 3)
    if (sort := rng.integers(4)) == 3:
        corners = 2 * int(rng.integers(3, 6))
        angles = np.arange(corners) * 2.0 * pi / corners + rng.uniform(-0.2, 0.2, corners)
        radii = np.where(np.arange(corners) % 2, rng.uniform(0.2, 0.5), rng.uniform(0.5, 1.0))
        points = list(zip(radii * np.cos(angles), radii * np.sin(angles), strict=True))
    else:
        low, high = sorted((s, t) if sort == 2 else (0.1 + 0.8 * s, 0.1 + 0.8 * t))
        left, right, top = low * a, high * a, u * b
        points = (
            [(0, 0), (a, 0), (a, s * b), (t * a, s * b), (t * a, b), (0, b)],
            [(0, 0), (a, 0), (a, b), (right, b), (right, top), (left, top), (left, b), (0, b)],
            [(left, 0), (right, 0), (right, top), (a, top), (a, b), (0, b), (0, top), (left, top)],
        )[sort]
    made = np.array(points, dtype=np.float64)
    middle = 0.5 * (made.min(axis=0) + made.max(axis=0))
    return np.asarray(made - middle + _shift(rng))


def _shift(rng: Generator) -> FloatArray:
    return np.asarray(rng.uniform(-0.3, 0.3, 2) if rng.random() < 0.5 else np.zeros(2))


SORTS: dict[str, Callable[[Generator], FloatArray]] = {
    "convex": _convex, "boxes": _box, "nonconvex": _nonconvex,
}  # fmt: skip


class Draft:
    """One case in the making: its random numbers, its place and step, and robots to draw from."""

    def __init__(
        self, rng: Generator, sideways: Generator, origin: Place, dt: float, store: Store
    ) -> None:
        self.rng, self.origin, self.dt, self.store = rng, origin, dt, store
        self.sideways = sideways
        """which robots are omnidirectional, and which way they go"""

    def robot(self, sort: str = "") -> Footprint:
        """A footprint of a sort, or of any."""
        some = self.store[sort or tuple(SORTS)[int(self.rng.integers(3))]]
        return some[int(self.rng.integers(len(some)))]

    def pair(self, a: Footprint, b: Footprint, *, stands: bool = False) -> Layout:
        """Two robots whose discs overlap at the meeting: most collide, some pass.

        The second one ``stands``, or moves too.
        """
        most, time = self._most(a, b), self._time()
        reach, bearing = self.rng.uniform(0.0, 1.05) * (a.radius + b.radius), self._angle()
        (x, y), first, second = self.origin, self._angle(), self._angle()
        poses = (x, y, first), (x + reach * cos(bearing), y + reach * sin(bearing), second)
        orders = [self._order(a, most), (0.0, 0.0, 0.0) if stands else self._order(b, most)]
        return _back((a, b), poses, orders, time)

    def mover(self) -> Layout:
        """A robot and a mover, on its arc too; as `pair`."""
        mover = self.robot()._replace(mass=np.inf)
        return self.pair(self.robot(), mover)._replace(second="mover")

    def pushed(self) -> Layout:
        """A robot and an obstacle that it pushes, if it meets it."""
        return self.pair(self.robot(), self.robot(), stands=True)._replace(second="pushed")

    def aligned(self, across: bool) -> Layout:
        """Boxes with one heading, beside each other, so that their edges are collinear or parallel,
        or one behind the other: their sides lie on one line."""
        rng, a = self.rng, self.robot("boxes")
        b = a if rng.random() < 0.7 else self.robot("boxes")
        heading, most = self._angle(), self._most(a, b)
        room = a.outline[2] + b.outline[2]  # half lengths and half widths of both
        gap = rng.uniform(0.05, 0.5) if rng.random() < 0.6 else 10.0 ** rng.uniform(-7.0, -1.0)
        shift = 0.0 if rng.random() < 0.5 else rng.uniform(-0.9, 0.9)
        along, left = shift * room[0], room[1] + gap
        if not across:
            along, left = room[0] + gap, shift * room[1]
        (x, y), c, s = self.origin, np.cos(heading), np.sin(heading)
        second = (x + c * along - s * left, y + s * along + c * left, heading)
        v, sort = rng.uniform(0.1, 0.9) * min(FASTEST, most), rng.integers(4)
        if sort == 0:  # in step
            orders = [(v, 0.0, 0.0), (v, 0.0, 0.0)]
        elif sort == 1:  # at different speeds
            orders = [(v, 0.0, 0.0), (v * rng.uniform(-1.0, 1.0), 0.0, 0.0)]
        elif sort == 2:  # one turning into the other
            omega = rng.uniform(-1.0, 1.0) * min(TURNING, 0.1 * most / max(a.radius, b.radius))
            orders = [(v, omega, 0.0), (v, 0.0, 0.0)]
        else:
            orders = [self._order(robot, most) for robot in (a, b)]
        return Layout((a, b), np.array([(x, y, heading), second]), np.array(orders))

    def graze(self, a: Footprint, b: Footprint) -> Layout:
        """Two robots that pass within a hair: at the meeting they touch and neither close nor
        part."""
        most, time = self._most(a, b), self._time()
        reach, bearing = a.radius + b.radius, self._angle()
        x, y = self.origin
        first = np.array((x, y, self._angle()))
        second = np.array((x + reach * cos(bearing), y + reach * sin(bearing), self._angle()))
        d, nx, ny, ax, ay, _, _ = body_separation(a.packed, 0, first, b.packed, 0, second)
        normal, point = np.array((nx, ny)), np.array((ax, ay))
        second[:2] -= (d - self._hair()) * normal
        one, two = self._order(a, most), self._order(b, most)
        # The second robot's speed makes the relative velocity of the touching points tangential.
        closing = normal @ (
            _velocity(first, one, point) - _velocity(second, (0.0, *two[1:]), point)
        )
        ahead = nx * cos(second[2]) + ny * sin(second[2])
        v = float(closing / ahead) if abs(ahead) > 0.05 else two[0]
        orders = [one, (v, *two[1:])]  # slowed alike, so that directions stay
        fastest = max(
            hypot(v, lateral) + r.radius * abs(w)
            for (v, w, lateral), r in zip(orders, (a, b), strict=True)
        )
        share = min(1.0, most / fastest)
        orders = [_scaled(order, share) for order in orders]
        return _back((a, b), (tuple(first), tuple(second)), orders, time)

    def wall(self) -> Layout:
        """Straight wall near the meeting, drawn as one to four collinear segments."""
        rng, robot = self.rng, self.robot()
        direction, across = self._axes()
        foot = np.array(self.origin) + rng.uniform(-0.5, 1.05) * robot.radius * across
        ends = np.array((-rng.uniform(1.0, 5.0), rng.uniform(1.0, 5.0)))
        inner = np.sort(rng.uniform(ends[0] + 0.1, ends[1] - 0.1, int(rng.integers(0, 4))))
        along = np.concatenate((ends[:1], inner, ends[1:]))
        along = along[np.concatenate(([True], np.diff(along) > 1e-3))]
        return self._alone(robot, foot + along[:, None] * direction)

    def corner(self) -> Layout:
        """Two walls that meet at any angle from 20 to 340 degrees."""
        rng, robot = self.rng, self.robot()
        tip = self._near(robot)
        first, opening = self._angle(), rng.uniform(pi / 9, 17 * pi / 9)
        ends = [
            tip + rng.uniform(0.5, 4.0) * np.array((cos(angle), sin(angle)))
            for angle in (first, first + opening)
        ]
        return self._alone(robot, np.array((ends[0], tip, ends[1])))

    def wall_end(self) -> Layout:
        """Free end of a wall, or a stub with both ends near."""
        rng, robot = self.rng, self.robot()
        end = self._near(robot)
        direction, _ = self._axes()
        length = rng.uniform(1.0, 5.0) if rng.random() < 0.7 else rng.uniform(0.05, 0.5)
        return self._alone(robot, np.array((end, end + length * direction)))

    def wall_graze(self) -> Layout:
        """Passing a wall, or the end of one, within a hair: along it, or turning away as it
        touches."""
        rng, robot = self.rng, self.robot()
        pose = np.array((*self.origin, self._angle()))
        direction, across = self._axes()
        ends = (-rng.uniform(1.0, 5.0), rng.uniform(1.0, 5.0))
        if rng.random() < 0.4:
            ends = (rng.uniform(-1.0, 1.0) * robot.radius, 5.0)
        line = np.array(self.origin) + 2.0 * robot.radius * across + np.outer(ends, direction)
        solid = pack_parts([[line]])
        d, nx, ny, ax, ay, _, _ = body_separation(robot.packed, 0, pose, solid, 0, np.zeros(3))
        normal, point = np.array((nx, ny)), np.array((ax, ay))
        line = line - (d - self._hair()) * normal
        most, time = self._most(robot), self._time()
        v = rng.uniform(0.1, 1.0) * min(FASTEST, most)
        straight, turn = (
            float(normal @ _velocity(pose, order, point))
            for order in ((v, 0.0, 0.0), (0.0, 1.0, 0.0))
        )
        omega = -straight / turn if abs(turn) > 0.05 * robot.radius else 0.0
        share = min(1.0, most / (v + robot.radius * abs(omega)), TURNING / max(abs(omega), 1e-9))
        orders = [_scaled((v, omega, 0.0), share)]
        return _back((robot,), (tuple(pose),), orders, time)._replace(lines=(line,))

    def obstacle(self) -> Layout:
        """Solid polygon, convex or not."""
        robot, solid = self.robot(), self.robot()
        bearing, (direction, _) = self._angle(), self._axes()
        reach = self.rng.uniform(0.0, 1.05) * (robot.radius + solid.radius)
        middle = np.array(self.origin) + reach * np.array((cos(bearing), sin(bearing)))
        x, y = direction
        turned = tuple(
            middle
            + np.stack((x * part[:, 0] - y * part[:, 1], y * part[:, 0] + x * part[:, 1]), axis=1)
            for part in (solid.outline, *solid.parts)
        )
        return self._alone(robot, solids=(turned,))

    def _alone(
        self, robot: Footprint, *lines: FloatArray, solids: tuple[tuple[FloatArray, ...], ...] = ()
    ) -> Layout:
        """A robot that is at the origin of the place at the meeting, and what stands there."""
        order = self._order(robot, self._most(robot))
        pose = (*self.origin, self._angle())
        found = _back((robot,), (pose,), [order], self._time())
        return found._replace(lines=lines, solids=solids)

    def _most(self, *robots: Footprint) -> float:
        """Largest speed [m/s] of any point that a world with these robots may have."""
        return ROOM * TUNNEL_FRACTION * min(robot.width for robot in robots) / self.dt

    def _time(self) -> float:
        """Time of a planned meeting [s], anywhere between samples."""
        return float(self.rng.uniform(4.0, STEPS - 6.0) * self.dt)

    def _angle(self) -> float:
        return self.rng.uniform(-pi, pi)

    def _order(self, robot: Footprint, most: float) -> Twist:
        """Random twist: straight, on an arc, or turning on the spot; one in ten is slow.

        One in three goes some way that it does not face.
        """
        rng = self.rng
        v = rng.uniform(0.1, 1.0) * min(FASTEST, most) * (1.0 if rng.random() < 0.8 else -1.0)
        omega = rng.uniform(-1.0, 1.0) * TURNING
        sort = rng.random()
        if sort < 0.4:
            omega = 0.0
        elif sort < 0.5:
            v = 0.0
        share = min(1.0, most / (abs(v) + robot.radius * abs(omega)))
        if rng.random() < 0.1:
            share *= 10.0 ** rng.uniform(-3.0, 0.0)
        way = self.sideways.uniform(-pi, pi) if self.sideways.random() < 1.0 / 3.0 else 0.0
        return _scaled((v * cos(way), omega, v * sin(way)), share)

    def _hair(self) -> float:
        """Gap or overlap [m] of a graze: from 1e-11 to 1e-2, one in twenty exactly 0."""
        rng = self.rng
        if rng.random() < 0.05:
            return 0.0
        return float(10.0 ** rng.uniform(-11.0, -2.0) * (1.0 if rng.random() < 0.5 else -1.0))

    def _near(self, robot: Footprint) -> FloatArray:
        """A point that the robot may reach at the meeting."""
        bearing, reach = self._angle(), self.rng.uniform(0.0, 1.05) * robot.radius
        return np.array(self.origin) + reach * np.array((cos(bearing), sin(bearing)))

    def _axes(self) -> tuple[FloatArray, FloatArray]:
        """A random direction, and the one to its left."""
        angle = self._angle()
        return np.array((cos(angle), sin(angle))), np.array((-sin(angle), cos(angle)))


def _back(
    robots: tuple[Footprint, ...],
    poses: tuple[tuple[float, ...], ...],
    orders: list[Twist],
    time: float,
) -> Layout:
    """Robots that are at ``poses`` a time later, on their arcs."""
    start = [
        arc(x, y, heading, *order, -time)
        for (x, y, heading), order in zip(poses, orders, strict=True)
    ]
    return Layout(robots, np.array(start), np.array(orders))


def _scaled(order: Twist, share: float) -> Twist:
    v, omega, lateral = order
    return float(share * v), float(share * omega), float(share * lateral)


def _velocity(pose: FloatArray, order: Twist, point: FloatArray) -> FloatArray:
    """Velocity [m/s] of a point that is fixed to a robot."""
    v, omega, lateral = order
    x, y, c, s = point[0] - pose[0], point[1] - pose[1], cos(pose[2]), sin(pose[2])
    return np.array((v * c - lateral * s - omega * y, v * s + lateral * c + omega * x))


KINDS: dict[str, Callable[[Draft], Layout]] = {
    "convex": lambda draft: draft.pair(draft.robot("convex"), draft.robot("convex")),
    "nonconvex": lambda draft: draft.pair(draft.robot("nonconvex"), draft.robot("nonconvex")),
    "mixed": lambda draft: draft.pair(draft.robot(), draft.robot()),
    "side by side": lambda draft: draft.aligned(across=True),
    "in a row": lambda draft: draft.aligned(across=False),
    "graze": lambda draft: draft.graze(draft.robot(), draft.robot()),
    "wall": Draft.wall,
    "corner": Draft.corner,
    "wall end": Draft.wall_end,
    "wall graze": Draft.wall_graze,
    "obstacle": Draft.obstacle,
    "mover": Draft.mover,
    "pushed": Draft.pushed,
}
"""What is drawn, in turn."""


class Case(NamedTuple):
    """A layout with its number, by which it can be drawn again."""

    number: int
    kind: str
    dt: float
    """[s]"""
    origin: Place
    """[m] middle of the place where it happens"""
    layout: Layout
    walls: Walls


def draw_case(seed: int, number: int, origin: Place, store: Store) -> Case:
    """Draw one case: kind and time step follow from its number, all else from its stream."""
    kind = tuple(KINDS)[number % len(KINDS)]
    dt = TIME_STEPS[number // len(KINDS) % len(TIME_STEPS)]
    rng, sideways = stream(seed, "crash test", number), stream(seed, "crash test, ways", number)
    draft = Draft(rng, sideways, origin, dt, store)
    for _ in range(TRIES):
        layout = KINDS[kind](draft)
        lines = (tuple(line[k : k + 2] for k in range(len(line) - 1)) for line in layout.lines)
        walls = (*lines, *(parts for _, *parts in layout.solids))
        if _is_clear(layout, walls):
            return Case(number, kind, dt, origin, layout, walls)
    return Case(number, kind, dt, origin, draft.aligned(across=True), ())


def _is_clear(layout: Layout, walls: Walls) -> bool:
    """Whether nothing touches at the start, as a world must have it."""
    start, robot = layout.start, layout.robots[0].packed
    if len(start) == 2:
        other = layout.robots[1].packed
        return bool(body_distance(robot, 0, start[0], other, 0, start[1]) > CLEAR)
    solid, still = pack_parts(walls), np.zeros(3)
    return all(
        body_distance(robot, 0, start[0], solid, k, still) > CLEAR for k in range(len(walls))
    )


def place_of(index: int) -> Place:
    """Middle of the place of a case [m]: a spiral of squares about the origin."""
    ring = int((np.sqrt(index) + 1.0) / 2.0)
    along = index - (2 * ring - 1) ** 2 if ring else 0
    side, offset = divmod(along, 2 * ring) if ring else (0, 0)
    far, near = ring, offset - ring
    x, y = ((far, near), (-near, far), (-far, -near), (near, -far))[side]
    return SPACING * x, SPACING * y


def way_of(layout: Layout, dt: float) -> tuple[FloatArray, FloatArray]:
    """Waypoints (n, 3) and times (n,) [s] of the mover of a layout: its arc, for a whole case."""
    (v, omega, lateral), duration = layout.command[1].tolist(), (STEPS + 1) * dt
    times = np.linspace(0.0, duration, 2 + int(0.5 * abs(omega) * duration))
    x, y, heading = layout.start[1].tolist()
    poses = [arc(x, y, heading, v, omega, lateral, time) for time in times.tolist()]
    return np.array(poses), times


def case_world(case: Case, seed: int, reason: str) -> World:
    """World of a case; ``reason`` goes into its description."""
    layout = case.layout
    (x, y), commands = case.origin, layout.command
    movers, pushed = [], []
    if layout.second != "robot":
        commands, other = commands[:1], layout.robots[1]
        px, py, heading = layout.start[1].tolist()
        c, s = cos(heading), sin(heading)
        corners = other.outline @ np.array([[c, s], [-s, c]]) + [px, py]
        pushed = [{"corners": corners.tolist(), "mass": other.mass}]
    if layout.second == "mover":
        poses, times = way_of(layout, case.dt)
        way = {"waypoints": poses.tolist(), "times": times.tolist()}
        movers, pushed = [{"name": "mover", "footprint": other.outline.tolist(), **way}], []
    square = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    ring = [(x + i * HALF_WIDTH, y + j * HALF_WIDTH) for i, j in square]
    robots = []
    for k, (v, omega, lateral) in enumerate(commands.tolist()):
        px, py, heading = layout.start[k].tolist()
        robots.append({
            "name": f"robot {k + 1}",
            "footprint": layout.robots[k].outline.tolist(),
            "pose": [px, py, heading],
            # a metre straight ahead: every robot needs a path, nobody follows it here
            "path": [(px, py), (px + cos(heading), py + sin(heading))],
            "limits": {"v": max(abs(v), LEAST), "omega": max(abs(omega), LEAST)},
        })  # fmt: skip
        if lateral:
            robots[k]["drive"] = {"type": "omni", "lateral": abs(lateral)}
        elif v and case.number % 2:
            steering = atan(WHEELBASE * abs(omega / v)) + LEAST
            robots[k]["drive"] = {"type": "car", "wheelbase": WHEELBASE, "steering": steering}
    columns = 3 if commands[:, 2].any() else 2
    values: dict[str, Any] = {
        "name": f"crash-{seed}-{case.number}",
        "description": f"Crash test, seed {seed}, case {case.number} ({case.kind}): {reason}",
        "seed": seed,
        "time": {"step": case.dt, "duration": round(STEPS * case.dt, 12)},
        "boundaries": [*(line.tolist() for line in layout.lines), [*ring, ring[0]]],
        "reference_path": [(x - 5.0, y - HALF_WIDTH + 1.0), (x + 5.0, y - HALF_WIDTH + 1.0)],
        "robots": robots,
        "controller": {"type": "constant", "commands": commands[:, :columns].tolist()},
        "obstacles": [*(outline.tolist() for outline, *_ in layout.solids), *pushed],
        "movers": movers,
    }
    return World(**values)
