"""One case: one or two robots, each at a constant (v, omega), perhaps with walls in the way.

Footprints are random: convex, boxes, nonconvex. They come from a store that depends on the
seed alone, since cutting an outline into convex parts costs more than the case itself.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

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

STORED = 200
"""Footprints of each sort."""
THINNEST = 0.05
"""[m] least width of a convex part"""


Outline = Callable[[Generator], FloatArray]
"""Draws an outline (n, 2) [m]."""


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
    area: float
    """[m^2]"""
    packed: Shapes
    """the one body, for kernels"""


class Store(NamedTuple):
    """Footprints to draw from."""

    convex: tuple[Footprint, ...]
    boxes: tuple[Footprint, ...]
    nonconvex: tuple[Footprint, ...]


def footprint(points: FloatArray) -> Footprint:
    """Make a footprint of a simple outline (n, 2), cut exactly as a world would have it cut."""
    outline = counter_clockwise(points)
    parts = convex_parts(outline)
    return Footprint(
        outline,
        parts,
        circumscribed_radius(outline),
        smallest_width(parts),
        abs(signed_area(outline)),
        pack_parts([parts]),
    )


def build_store(seed: int) -> Store:
    """Footprints of one seed."""

    def draw(name: str, outline: Outline) -> tuple[Footprint, ...]:
        return tuple(
            _usable(stream(seed, f"crash test, {name}", k), outline) for k in range(STORED)
        )

    return Store(draw("convex", _convex), draw("boxes", box), draw("nonconvex", _nonconvex))


def _usable(rng: Generator, outline: Outline) -> Footprint:
    while True:
        points = outline(rng)
        if is_simple(points):
            made = footprint(points)
            if made.width >= THINNEST:
                return made


def box(rng: Generator) -> FloatArray:
    """Box about its centre; one in four is 1.0 x 0.6 m, with which the engine was seen to err."""
    length, width = (1.0, 0.6) if rng.random() < 0.25 else rng.uniform(0.2, 2.0, 2)
    x, y = 0.5 * length, 0.5 * width
    return np.array([(-x, -y), (x, -y), (x, y), (-x, y)])


def _convex(rng: Generator) -> FloatArray:
    """Corners on a turned ellipse; the reference point may lie off the middle, even outside."""
    corners = rng.integers(3, 9)
    angles = np.sort(rng.uniform(-pi, pi, corners))
    points = np.stack((np.cos(angles), np.sin(angles)), axis=1) * rng.uniform(0.15, 1.0, 2)
    return _turned(points, rng.uniform(-pi, pi)) + _shift(rng)


def _nonconvex(rng: Generator) -> FloatArray:
    a, b = rng.uniform(0.3, 1.2, 2)
    s, t, u = rng.uniform(0.2, 0.8, 3)
    sort = rng.integers(4)
    if sort == 0:  # L
        points = [(0, 0), (a, 0), (a, s * b), (t * a, s * b), (t * a, b), (0, b)]
    elif sort == 1:  # U
        low, high = sorted((0.1 + 0.8 * s, 0.1 + 0.8 * t))
        points = [
            (0, 0), (a, 0), (a, b), (high * a, b), (high * a, u * b), (low * a, u * b),
            (low * a, b), (0, b),
        ]  # fmt: skip
    elif sort == 2:  # T
        low, high = sorted((s, t))
        points = [
            (low * a, 0), (high * a, 0), (high * a, u * b), (a, u * b), (a, b), (0, b),
            (0, u * b), (low * a, u * b),
        ]  # fmt: skip
    else:  # a star about the origin
        corners = 2 * int(rng.integers(3, 6))
        angles = np.arange(corners) * 2.0 * pi / corners + rng.uniform(-0.2, 0.2, corners)
        radii = np.where(np.arange(corners) % 2, rng.uniform(0.2, 0.5), rng.uniform(0.5, 1.0))
        points = list(zip(radii * np.cos(angles), radii * np.sin(angles), strict=True))
    made = np.array(points, dtype=np.float64)
    middle = 0.5 * (made.min(axis=0) + made.max(axis=0))
    return np.asarray(made - middle + _shift(rng))


def _shift(rng: Generator) -> FloatArray:
    return np.asarray(rng.uniform(-0.3, 0.3, 2) if rng.random() < 0.5 else np.zeros(2))


def _turned(points: FloatArray, angle: float) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]), dtype=np.float64)


STEPS = 48
"""Steps that a case lasts."""


class Solid(NamedTuple):
    """An obstacle, world frame [m]."""

    outline: FloatArray
    """(n, 2)"""
    parts: tuple[FloatArray, ...]
    """convex"""


class Layout(NamedTuple):
    """What stands and moves, before it is known to be clear at the start."""

    robots: tuple[Footprint, ...]
    """one or two"""
    start: FloatArray
    """(r, 3) x, y [m], heading [rad], world frame, at sample 0"""
    command: FloatArray
    """(r, 2) v [m/s], omega [rad/s], held"""
    lines: tuple[FloatArray, ...] = ()
    """boundaries as drawn, (n, 2) [m] each, world frame"""
    solids: tuple[Solid, ...] = ()


class Case(NamedTuple):
    """A layout with its number, by which it can be drawn again."""

    number: int
    kind: str
    dt: float
    """[s]"""
    origin: tuple[float, float]
    """[m] middle of the place where it happens"""
    layout: Layout
    walls: tuple[tuple[FloatArray, ...], ...]
    """convex parts or segments of each line and each solid"""
