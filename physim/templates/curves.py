"""Lines that roads are made of, as points (n, 2) [m]."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, ceil, cos, pi, sin, tan

import numpy as np

from physim.geometry.shapes import FloatArray

TURN = pi / 12.0
"""[rad] largest turn between two pieces of an arc"""


def arc(x: float, y: float, radius: float, first: float, last: float) -> FloatArray:
    """Points of an arc around (x, y) from angle ``first`` to ``last`` [rad], both included."""
    angles = np.linspace(first, last, 1 + max(1, ceil(abs(last - first) / TURN)))
    return np.stack([x + radius * np.cos(angles), y + radius * np.sin(angles)], axis=1)


def rounded(points: Sequence[Sequence[float]], radius: float) -> FloatArray:
    """Polyline whose inner corners are arcs of a radius; its pieces must be long enough."""
    line = [np.array(points[0], dtype=np.float64)]
    for a, corner, b in zip(points, points[1:], points[2:], strict=False):
        into = atan2(corner[1] - a[1], corner[0] - a[0])
        out = atan2(b[1] - corner[1], b[0] - corner[0])
        turn = (out - into + pi) % (2.0 * pi) - pi
        side = 1.0 if turn > 0.0 else -1.0
        back = radius * tan(0.5 * abs(turn))
        x = corner[0] - back * cos(into) - side * radius * sin(into)
        y = corner[1] - back * sin(into) + side * radius * cos(into)
        start = into - side * 0.5 * pi
        line.extend(arc(x, y, radius, start, start + turn))
    line.append(np.array(points[-1], dtype=np.float64))
    return np.array(line, dtype=np.float64).round(2)


def rectangle(x0: float, y0: float, x1: float, y1: float) -> FloatArray:
    """Corners (4, 2) of a rectangle, counter-clockwise."""
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def tangent_join(ring: float, fillet: float) -> tuple[float, float]:
    """Where an arc joins a straight line through a ring's centre to the ring, from outside.

    Returns how far from the centre along the line the arc leaves the line [m], and the angle [rad]
    between the line and the point at which it meets the ring.
    """
    along = ((ring + fillet) ** 2 - fillet**2) ** 0.5
    return along, atan2(fillet, along)
