"""Sideways lines that cross themselves in tight bends: the loops are cut off where they cross."""

from __future__ import annotations

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.importing.line import stations

MOST_ROUNDS = 20
"""Times that a line is looked over; one that still crosses itself then is no road."""


class CrossingError(ValueError):
    """A line that crosses itself far along it: no bend, but a crossing. ``point`` (2,) [m]."""

    def __init__(self, point: FloatArray) -> None:
        super().__init__("the line crosses itself")
        self.point = point


def without_loops(
    line: FloatArray, longest: float
) -> tuple[FloatArray, list[tuple[FloatArray, float]]]:
    """Cut off every loop of a polyline (n, 2) whose length [m] is at most ``longest``.

    Returns the line, which no longer crosses itself, and the crossing point and length of each
    loop. Raises CrossingError where a loop is longer.
    """
    cut: list[tuple[FloatArray, float]] = []
    for _ in range(MOST_ROUNDS):
        loops = _loops(line)
        if not loops:
            return line, cut
        station = stations(line)
        pieces, at = [], 0
        for first, last, point in sorted(loops, key=lambda loop: (loop[0], -loop[1])):
            ends = np.hypot(*(line[[first + 1, last]] - point).T).sum()
            length = float(station[last] - station[first + 1] + ends)
            if first < at or length > longest:
                continue
            pieces += [line[at : first + 1], point[None]]
            cut.append((point, length))
            at = last + 1
        if not pieces:
            raise CrossingError(loops[0][2])
        line = np.vstack([*pieces, line[at:]])
        line = line[np.concatenate(([True], np.hypot(*np.diff(line, axis=0).T) > 1e-9))]
    raise CrossingError(line[0])


def _loops(line: FloatArray) -> list[tuple[int, int, FloatArray]]:
    """Segments i < j, not neighbours, that cross, and where."""
    if len(line) < 3 or shapely.LineString(line).is_simple:
        return []
    segments = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    i, j = shapely.STRtree(segments).query(segments, predicate="intersects")
    ring = bool((line[0] == line[-1]).all())
    apart = (j - i >= 2) & ~((i == 0) & (j == len(segments) - 1) & ring)
    i, j = i[apart], j[apart]
    common = shapely.intersection(segments[i], segments[j])
    return [
        (int(a), int(b), np.asarray(shapely.get_coordinates(c)[0]))
        for a, b, c in zip(i, j, common, strict=True)
    ]
