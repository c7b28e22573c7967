"""Robots that a decision may look at."""

from __future__ import annotations

from typing import NamedTuple

from physim.geometry.shapes import FloatArray, IntArray, Shapes


class Bodies(NamedTuple):
    """Rows of robots as the deciding one senses them: all of them, or those in sight."""

    shapes: Shapes
    shape: IntArray
    """(n,) which body of ``shapes`` each row has"""
    number: IntArray
    """(n,) robot indices"""
    pose: FloatArray
    """(n, 3)"""
    command: FloatArray
    """(n, 2) held"""
    station: FloatArray
    """(n,) [m] along the reference path"""
