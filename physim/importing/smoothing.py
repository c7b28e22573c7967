"""A way over a grid drawn smooth, without coming nearer to the walls than it must."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.importing.line import clearances, length_of, points_at, samples

KEPT = 0.9
"""[-] A straight cut keeps this share of the clearance of the way it replaces."""
ROUNDS = 60
"""Times that every point moves towards the middle of its neighbours."""


def smooth(way: FloatArray, area: Any, room: float) -> FloatArray:
    """Straighten and round a way (n, 2) whose points have clearance ``room`` [m] in ``area``."""
    line = _straightened(way, area, room)
    at = samples(length_of(line), 0.3 * room)
    points = points_at(line, at)
    low = np.minimum(clearances(points, area), room)
    for _ in range(ROUNDS):
        moved = points.copy()
        moved[1:-1] = 0.5 * points[1:-1] + 0.25 * (points[:-2] + points[2:])
        allowed = clearances(moved, area) >= low
        points = np.where(allowed[:, None], moved, points)
    simple = shapely.simplify(shapely.LineString(points), 0.02 * room)
    return np.asarray(shapely.get_coordinates(simple))


def _straightened(way: FloatArray, area: Any, room: float) -> FloatArray:
    """Replace stretches by straight ones that keep away from the walls nearly as well."""
    edge = area.boundary
    shapely.prepare(edge)
    gaps = clearances(way, area)
    kept, k = [0], 0
    while k < len(way) - 1:
        reach = len(way) - 1 - k
        while reach > 1:
            j = k + reach
            there = float(gaps[k : j + 1].min())
            wanted = max(KEPT * min(there, 4.0 * room), min(there, room))
            if shapely.distance(edge, shapely.LineString(way[[k, j]])) >= wanted:
                break
            reach = reach // 2 if reach > 8 else reach - 1
        k += max(reach, 1)
        kept.append(k)
    return np.asarray(way[kept])
