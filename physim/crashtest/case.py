"""One case: one or two robots, each at a constant (v, omega), perhaps with walls in the way."""

from __future__ import annotations

from typing import NamedTuple

from physim.crashtest.footprints import Footprint
from physim.geometry.shapes import FloatArray

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
