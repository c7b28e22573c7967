"""Layouts of one robot and something that stands: walls, corners, wall ends, obstacles.

Planned from the meeting, like those of two robots (`meetings`).
"""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.random import Generator

from physim.crashtest.case import Layout, Solid
from physim.crashtest.footprints import Footprint, Store
from physim.crashtest.meetings import (
    FASTEST,
    TURNING,
    Origin,
    advance,
    back,
    command,
    hair,
    meeting_time,
    pick,
    velocity,
)
from physim.geometry.separation import body_separation
from physim.geometry.shapes import FloatArray, pack_shapes


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
    d, nx, ny, ax, ay, _, _ = body_separation(
        robot.packed, 0, pose, pack_shapes([[line]]), 0, still
    )
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
