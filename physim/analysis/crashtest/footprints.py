"""Random footprints to draw from: convex, boxes, nonconvex.

They depend on the seed alone and are stored, since cutting an outline into convex parts costs more
than a case itself.
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
from physim.world.scene import DENSITY

STORED = 200
"""Footprints of each sort."""
THINNEST = 0.05
"""[m] least width of a convex part"""


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
