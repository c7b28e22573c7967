"""Curves of an SVG drawing as polylines, no chord further from its curve than a tolerance."""

from __future__ import annotations

from math import acos, ceil, hypot, isfinite, pi, sqrt
from typing import Any

import numpy as np
import svgelements

from physim.authoring.importing.lines import is_closed
from physim.authoring.importing.work import MOST_POINTS
from physim.geometry.shapes import FloatArray

MOST_CHORDS = 10_000
"""Chords of one curve."""


def subpaths(
    shape: Any, tolerance: float, most: int = MOST_POINTS
) -> list[tuple[FloatArray, bool]]:
    """Polylines (n, 2) of an svgelements path, in pixels, and whether each is closed.

    The points are found before the path's own transform, and moved by it: the library does not
    move arcs right by one that skews. ``tolerance`` in pixels, too. A closed one has its first
    point repeated. Raises ValueError for coordinates that are not finite, and before there are
    more than ``most`` points.
    """
    m = shape.transform
    turn = np.array([[m.a, m.b], [m.c, m.d]], dtype=np.float64)
    largest = float(np.linalg.norm(turn, 2)) if np.isfinite(turn).all() else 0.0
    tolerance /= largest if largest > 0.0 else 1.0
    made = 0
    found: list[tuple[FloatArray, bool]] = []
    points: list[tuple[float, float]] = []
    for segment in shape:
        if isinstance(segment, svgelements.Move):
            _finish(found, points, False)
            points = [(segment.end.x, segment.end.y)]
        elif isinstance(segment, svgelements.Close):
            _finish(found, points, True)
            points = [points[0]] if points else []
        else:
            if not points:
                points = [(segment.start.x, segment.start.y)]
            count = _chords(segment, tolerance)
            made += count
            if made > most:
                raise ValueError(
                    f"more than {MOST_POINTS} points up to here; use a larger "
                    "--tolerance, check --scale, or simplify the drawing"
                )
            points += _points(segment, count)
    _finish(found, points, False)
    moved = [(line @ turn + (float(m.e), float(m.f)), closed) for line, closed in found]
    if not all(np.isfinite(line).all() for line, _ in moved):
        raise ValueError("a coordinate is not a finite number")
    return moved


def _finish(
    found: list[tuple[FloatArray, bool]], points: list[tuple[float, float]], closed: bool
) -> None:
    line = np.array(points, dtype=np.float64).reshape(-1, 2)
    if not np.isfinite(line).all():
        raise ValueError("a coordinate is not a finite number")
    if len(line) < 2:
        return
    if closed and (line[0] != line[-1]).any():
        line = np.vstack([line, line[:1]])
    found.append((line, closed or (len(line) > 3 and is_closed(line))))


def _chords(segment: Any, tolerance: float) -> int:
    """How many chords stand for a segment."""
    if isinstance(segment, svgelements.Line):
        return 1
    count = _count(segment, tolerance)
    if not isfinite(count):
        raise ValueError("a coordinate is not a finite number")
    return min(max(ceil(count), 1), MOST_CHORDS)


def _points(segment: Any, count: int) -> list[tuple[float, float]]:
    """Points of a segment after its first, the ends of ``count`` chords."""
    inner = segment.npoint(np.arange(1, count) / count) if count > 1 else ()
    return [*((float(x), float(y)) for x, y in inner), (segment.end.x, segment.end.y)]


def _count(segment: Any, tolerance: float) -> float:
    """Chords that keep within the tolerance: from the largest second difference, or the radius."""
    if isinstance(segment, svgelements.QuadraticBezier):
        a, b, c = segment.start, segment.control, segment.end
        bend = hypot(a.x - 2 * b.x + c.x, a.y - 2 * b.y + c.y)
        return sqrt(bend / (4.0 * tolerance))
    if isinstance(segment, svgelements.CubicBezier):
        p = (segment.start, segment.control1, segment.control2, segment.end)
        bend = max(
            hypot(a.x - 2 * b.x + c.x, a.y - 2 * b.y + c.y)
            for a, b, c in (p[:3], p[1:])
        )  # fmt: skip
        return sqrt(0.75 * bend / tolerance)
    radius = max(float(segment.rx), float(segment.ry))
    turn = acos(max(1.0 - tolerance / radius, -1.0)) if radius > tolerance else pi / 2.0
    return abs(float(segment.sweep)) / (2.0 * turn) if turn > 0.0 else float(MOST_CHORDS)
