"""Sideways lines that cross themselves in tight bends: the loops are cut off where they cross."""

from __future__ import annotations

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray

MOST_LOOPS = 300
"""Loops of one line that are cut off; a line with more is no road."""


class CrossingError(ValueError):
    """A line that crosses itself far along it: no bend, but a crossing. ``point`` (2,) [m]."""

    def __init__(self, point: FloatArray, first: int, last: int) -> None:
        super().__init__("the line crosses itself")
        self.point, self.first, self.last = point, first, last


def without_loops(
    line: FloatArray, longest: float
) -> tuple[FloatArray, list[tuple[FloatArray, float]]]:
    """Cut off every loop of a polyline (n, 2) whose length [m] is at most ``longest``.

    Returns the line, which no longer crosses itself, and the crossing point and length of each
    loop. Raises CrossingError where a loop is longer.
    """
    cut: list[tuple[FloatArray, float]] = []
    while len(cut) <= MOST_LOOPS:
        loop = _smallest_loop(line)
        if loop is None:
            return line, cut
        first, last, point = loop
        piece = np.vstack([point, line[first + 1 : last + 1], point])
        length = float(np.hypot(*np.diff(piece, axis=0).T).sum())
        if length > longest:
            raise CrossingError(point, first, last)
        cut.append((point, length))
        line = np.vstack([line[: first + 1], point, line[last + 1 :]])
        line = line[np.concatenate(([True], np.hypot(*np.diff(line, axis=0).T) > 1e-9))]
    raise CrossingError(line[0], 0, len(line) - 1)


def _smallest_loop(line: FloatArray) -> tuple[int, int, FloatArray] | None:
    """Segments i < j that cross with the fewest segments between them, and where."""
    if len(line) < 3 or shapely.LineString(line).is_simple:
        return None
    segments = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    i, j = shapely.STRtree(segments).query(segments, predicate="intersects")
    apart = (j - i >= 2) & ~(
        (i == 0) & (j == len(segments) - 1) & bool((line[0] == line[-1]).all())
    )
    if not apart.any():
        return None
    k = np.flatnonzero(apart)[np.argmin((j - i)[apart])]
    first, last = int(i[k]), int(j[k])
    common = shapely.intersection(segments[first], segments[last])
    return first, last, np.asarray(shapely.get_coordinates(common)[0])
