"""Cases drawn by number: two robots, or one and something else.

The same seed and number give the same case, whatever the others. Two robots meet at random, side by
side, in rows, or graze each other; one meets walls, corners, obstacles, a mover, a box to push. A
layout is planned from the meeting: the poses at which the two would overlap or touch are chosen
first, and each is taken back along its arc. All lengths [m], about the origin of the place.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, hypot, pi, sin
from typing import Literal, NamedTuple

import numpy as np
from numpy.random import Generator

from physim.analysis.crashtest.footprints import SORTS, Footprint, Store
from physim.geometry.bodies import body_distance, body_separation
from physim.geometry.motion import Twist, arc
from physim.geometry.shapes import FloatArray, pack_parts
from physim.randomness import stream
from physim.tolerances import TUNNEL_FRACTION

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
FASTEST = 3.0
"""[m/s]"""
TURNING = 4.0
"""[rad/s] fastest turn"""
ROOM = 0.96
"""[-] share of the advance that the tunnelling rule allows, left for rounding"""

Place = tuple[float, float]
Walls = tuple[Sequence[FloatArray], ...]
"""Convex parts or segments of each line and each solid"""


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
