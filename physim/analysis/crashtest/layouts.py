"""Layouts of two robots, or of one and something that stands: walls, corners, obstacles.

Two robots meet at random, side by side, in rows, or graze each other. A layout is planned from
the meeting: the poses at which the two would overlap or touch are chosen first, and each is
taken back along its arc. All lengths [m], about the origin of the place.
"""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.random import Generator

from physim.analysis.crashtest.case import STEPS, Footprint, Layout, Solid, Store
from physim.geometry.motion import arc
from physim.geometry.separation import body_separation
from physim.geometry.shapes import FloatArray, pack_parts
from physim.tolerances import TUNNEL_FRACTION

FASTEST = 3.0
"""[m/s]"""
TURNING = 4.0
"""[rad/s] fastest turn"""
ROOM = 0.96
"""[-] share of the advance that the tunnelling rule allows, left for rounding"""

Pose = tuple[float, float, float]
Origin = tuple[float, float]


def pick(rng: Generator, store: tuple[Footprint, ...]) -> Footprint:
    """One footprint of a sort."""
    return store[int(rng.integers(len(store)))]


def meeting_time(rng: Generator, dt: float) -> float:
    """Time of a planned meeting [s], anywhere between samples."""
    return float(rng.uniform(4.0, STEPS - 6.0) * dt)


def advance(robots: tuple[Footprint, ...], dt: float) -> float:
    """Largest speed [m/s] of any point that a world with these robots may have."""
    return ROOM * TUNNEL_FRACTION * min(robot.width for robot in robots) / dt


def command(rng: Generator, robot: Footprint, most: float) -> tuple[float, float]:
    """Random (v, omega): straight, on an arc, or turning on the spot; one in ten is slow."""
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
    return float(share * v), float(share * omega)


def back(pose: Pose, order: tuple[float, float], time: float) -> Pose:
    """Pose a time earlier on the arc."""
    return arc(pose, order[0], order[1], -time)


def pair(rng: Generator, origin: Origin, dt: float, a: Footprint, b: Footprint) -> Layout:
    """Two robots whose discs overlap at the meeting: most collide, some pass."""
    most, time = advance((a, b), dt), meeting_time(rng, dt)
    reach, bearing = rng.uniform(0.0, 1.05) * (a.radius + b.radius), rng.uniform(-pi, pi)
    first = (origin[0], origin[1], rng.uniform(-pi, pi))
    second = (
        origin[0] + reach * cos(bearing),
        origin[1] + reach * sin(bearing),
        rng.uniform(-pi, pi),
    )
    orders = command(rng, a, most), command(rng, b, most)
    start = [back(p, order, time) for p, order in zip((first, second), orders, strict=True)]
    return Layout((a, b), np.array(start), np.array(orders))


def side_by_side(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    """Boxes beside each other with one heading, so that their edges are collinear or parallel."""
    return _aligned(rng, origin, dt, store, across=True)


def in_row(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    """Boxes one behind the other with one heading: their sides lie on one line."""
    return _aligned(rng, origin, dt, store, across=False)


def _aligned(rng: Generator, origin: Origin, dt: float, store: Store, across: bool) -> Layout:
    a = pick(rng, store.boxes)
    b = a if rng.random() < 0.7 else pick(rng, store.boxes)
    heading, most = rng.uniform(-pi, pi), advance((a, b), dt)
    room = a.outline[2] + b.outline[2]  # half lengths and half widths of both
    gap = rng.uniform(0.05, 0.5) if rng.random() < 0.6 else 10.0 ** rng.uniform(-7.0, -1.0)
    shift = 0.0 if rng.random() < 0.5 else rng.uniform(-0.9, 0.9)
    along, left = (shift * room[0], room[1] + gap) if across else (room[0] + gap, shift * room[1])
    c, s = cos(heading), sin(heading)
    start = [
        (origin[0], origin[1], heading),
        (origin[0] + c * along - s * left, origin[1] + s * along + c * left, heading),
    ]
    orders = _aligned_orders(rng, (a, b), most)
    return Layout((a, b), np.array(start), np.array(orders))


def _aligned_orders(
    rng: Generator, robots: tuple[Footprint, Footprint], most: float
) -> list[tuple[float, float]]:
    """In step, at different speeds, or one turning into the other."""
    v = rng.uniform(0.1, 0.9) * min(FASTEST, most)
    sort = rng.integers(4)
    if sort == 0:
        return [(v, 0.0), (v, 0.0)]
    if sort == 1:
        return [(v, 0.0), (v * rng.uniform(-1.0, 1.0), 0.0)]
    if sort == 2:
        omega = rng.uniform(-1.0, 1.0) * min(TURNING, 0.1 * most / max(r.radius for r in robots))
        return [(v, omega), (v, 0.0)]
    return [command(rng, robot, most) for robot in robots]


def graze(rng: Generator, origin: Origin, dt: float, a: Footprint, b: Footprint) -> Layout:
    """Two robots that pass within a hair: at the meeting they touch and neither close nor part."""
    most, time = advance((a, b), dt), meeting_time(rng, dt)
    reach, bearing = a.radius + b.radius, rng.uniform(-pi, pi)
    first = np.array((*origin, rng.uniform(-pi, pi)))
    second = np.array(
        (origin[0] + reach * cos(bearing), origin[1] + reach * sin(bearing), rng.uniform(-pi, pi))
    )
    d, nx, ny, ax, ay, _, _ = body_separation(a.packed, 0, first, b.packed, 0, second)
    second[:2] -= (d - hair(rng)) * np.array((nx, ny))
    one, two = command(rng, a, most), command(rng, b, most)
    normal, point = np.array((nx, ny)), np.array((ax, ay))
    # The second robot's speed makes the relative velocity of the touching points tangential.
    closing = normal @ (velocity(first, one, point) - velocity(second, (0.0, two[1]), point))
    ahead = nx * cos(second[2]) + ny * sin(second[2])
    v = float(closing / ahead) if abs(ahead) > 0.05 else two[0]
    orders = _within([one, (v, two[1])], (a, b), most)
    start = [back(tuple(p), order, time) for p, order in zip((first, second), orders, strict=True)]
    return Layout((a, b), np.array(start), np.array(orders))


def hair(rng: Generator) -> float:
    """Gap or overlap [m] of a graze: from 1e-11 to 1e-2, one in twenty exactly 0."""
    if rng.random() < 0.05:
        return 0.0
    return float(10.0 ** rng.uniform(-11.0, -2.0) * (1.0 if rng.random() < 0.5 else -1.0))


def velocity(pose: FloatArray, order: tuple[float, float], point: FloatArray) -> FloatArray:
    """Velocity [m/s] of a point that is fixed to a robot."""
    v, omega = order
    x, y = point[0] - pose[0], point[1] - pose[1]
    return np.array((v * cos(pose[2]) - omega * y, v * sin(pose[2]) + omega * x))


def _within(
    orders: list[tuple[float, float]], robots: tuple[Footprint, ...], most: float
) -> list[tuple[float, float]]:
    """Orders slowed alike, so that directions stay, until none exceeds the largest speed."""
    fastest = max(abs(v) + r.radius * abs(w) for (v, w), r in zip(orders, robots, strict=True))
    share = min(1.0, most / fastest)
    return [(float(share * v), float(share * w)) for v, w in orders]


def any_robot(rng: Generator, store: Store) -> Footprint:
    """A footprint of any sort."""
    return pick(rng, store[int(rng.integers(3))])


def wall(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    """Straight wall near the meeting, drawn as one to four collinear segments."""
    robot = any_robot(rng, store)
    direction, across = _axes(rng)
    foot = np.array(origin) + rng.uniform(-0.5, 1.05) * robot.radius * across
    ends = np.array((-rng.uniform(1.0, 5.0), rng.uniform(1.0, 5.0)))
    inner = np.sort(rng.uniform(ends[0] + 0.1, ends[1] - 0.1, int(rng.integers(0, 4))))
    along = np.concatenate((ends[:1], inner, ends[1:]))
    along = along[np.concatenate(([True], np.diff(along) > 1e-3))]
    return _facing(rng, origin, dt, robot, foot + along[:, None] * direction)


def corner(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    """Two walls that meet at any angle from 20 to 340 degrees."""
    robot = any_robot(rng, store)
    tip = _near(rng, origin, robot)
    first, opening = rng.uniform(-pi, pi), rng.uniform(pi / 9, 17 * pi / 9)
    ends = [
        tip + rng.uniform(0.5, 4.0) * np.array((cos(angle), sin(angle)))
        for angle in (first, first + opening)
    ]
    return _facing(rng, origin, dt, robot, np.array((ends[0], tip, ends[1])))


def wall_end(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    """Free end of a wall, or a stub with both ends near."""
    robot = any_robot(rng, store)
    end = _near(rng, origin, robot)
    direction, _ = _axes(rng)
    length = rng.uniform(1.0, 5.0) if rng.random() < 0.7 else rng.uniform(0.05, 0.5)
    return _facing(rng, origin, dt, robot, np.array((end, end + length * direction)))


def obstacle(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    """Solid polygon, convex or not."""
    robot, solid = any_robot(rng, store), any_robot(rng, store)
    bearing, (direction, _) = rng.uniform(-pi, pi), _axes(rng)
    reach = rng.uniform(0.0, 1.05) * (robot.radius + solid.radius)
    middle = np.array(origin) + reach * np.array((cos(bearing), sin(bearing)))
    x, y = direction
    turned = [
        np.stack((x * part[:, 0] - y * part[:, 1], y * part[:, 0] + x * part[:, 1]), axis=1)
        for part in (solid.outline, *solid.parts)
    ]
    outline, *parts = (middle + part for part in turned)
    start, orders = _approach(rng, origin, dt, robot)
    return Layout((robot,), start, orders, solids=(Solid(outline, tuple(parts)),))


def wall_graze(rng: Generator, origin: Origin, dt: float, store: Store) -> Layout:
    """Passing a wall, or the end of one, within a hair: along it, or turning away as it touches."""
    robot = any_robot(rng, store)
    pose = np.array((*origin, rng.uniform(-pi, pi)))
    direction, across = _axes(rng)
    ends = (-rng.uniform(1.0, 5.0), rng.uniform(1.0, 5.0))
    if rng.random() < 0.4:
        ends = (rng.uniform(-1.0, 1.0) * robot.radius, 5.0)
    line = np.array(origin) + 2.0 * robot.radius * across + np.outer(ends, direction)
    still = np.zeros(3)
    d, nx, ny, ax, ay, _, _ = body_separation(robot.packed, 0, pose, pack_parts([[line]]), 0, still)
    line = line - (d - hair(rng)) * np.array((nx, ny))
    most, time = advance((robot,), dt), meeting_time(rng, dt)
    v = rng.uniform(0.1, 1.0) * min(FASTEST, most)
    normal, point = np.array((nx, ny)), np.array((ax, ay))
    straight, turn = (
        float(normal @ velocity(pose, order, point)) for order in ((v, 0.0), (0.0, 1.0))
    )
    omega = -straight / turn if abs(turn) > 0.05 * robot.radius else 0.0
    share = min(1.0, most / (v + robot.radius * abs(omega)), TURNING / max(abs(omega), 1e-9))
    order = (float(share * v), float(share * omega))
    start = np.array([back((pose[0], pose[1], pose[2]), order, time)])
    return Layout((robot,), start, np.array([order]), lines=(line,))


def _facing(
    rng: Generator, origin: Origin, dt: float, robot: Footprint, line: FloatArray
) -> Layout:
    start, orders = _approach(rng, origin, dt, robot)
    return Layout((robot,), start, orders, lines=(line,))


def _approach(
    rng: Generator, origin: Origin, dt: float, robot: Footprint
) -> tuple[FloatArray, FloatArray]:
    """Start and command of a robot that is at the origin of the place at the meeting."""
    order = command(rng, robot, advance((robot,), dt))
    pose = (origin[0], origin[1], rng.uniform(-pi, pi))
    return np.array([back(pose, order, meeting_time(rng, dt))]), np.array([order])


def _near(rng: Generator, origin: Origin, robot: Footprint) -> FloatArray:
    bearing, reach = rng.uniform(-pi, pi), rng.uniform(0.0, 1.05) * robot.radius
    return np.array((origin[0] + reach * cos(bearing), origin[1] + reach * sin(bearing)))


def _axes(rng: Generator) -> tuple[FloatArray, FloatArray]:
    """A random direction, and the one to its left."""
    angle = rng.uniform(-pi, pi)
    return np.array((cos(angle), sin(angle))), np.array((-sin(angle), cos(angle)))
