"""Polygons: simple or not, area, cut into few convex parts, width.

A polygon is an array (n, 2) [m] of its corners in either direction, not closed by a repeated
corner (a repeated last corner is dropped). Parts are convex and counter-clockwise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from physim.compiled import compiled
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray, Rows2
from physim.tolerances import FLAT, LENGTH

MOST_TRIALS = 8
"""Ways to cut a small polygon that are tried; of a large one it is one."""
LARGE = 40
"""Corners of a large polygon."""
MOST_LINES = 10_000
"""Diagonals of a polygon that are thought of at once."""


def corners(polygon: ArrayLike) -> FloatArray:
    """Return the corners (n, 2) [m] without neighbours closer than ``LENGTH``."""
    points = np.asarray(polygon, dtype=np.float64).reshape(-1, 2)
    if len(points) == 0:
        return points
    steps = np.hypot(*(points - np.roll(points, 1, axis=0)).T)
    keep = steps > LENGTH
    return points[keep] if keep.any() else points[:1]


def is_simple(polygon: ArrayLike) -> bool:
    """Whether the outline neither crosses nor touches itself and encloses an area."""
    points = corners(polygon)
    if len(points) < 3 or not np.isfinite(points).all():
        return False
    import shapely

    shape = shapely.Polygon(points)
    return bool(shape.is_valid) and shape.area > 0.0


def signed_area(polygon: ArrayLike) -> float:
    """Area [m²], positive for counter-clockwise corners (shoelace about the first corner)."""
    points = np.asarray(polygon, dtype=np.float64)
    x, y = (points - points[0]).T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def counter_clockwise(polygon: ArrayLike) -> FloatArray:
    """Return the corners (n, 2) in counter-clockwise order, beginning with the same corner."""
    points = corners(polygon)
    if signed_area(points) < 0.0:
        points = np.concatenate((points[:1], points[:0:-1]))
    return np.ascontiguousarray(points)


def convex_parts(polygon: ArrayLike) -> tuple[FloatArray, ...]:
    """Cut a simple polygon into convex parts (n, 2), counter-clockwise [m].

    The parts cover the polygon and have disjoint interiors; every corner of a part is a corner of
    the polygon. A convex polygon is its own part. Few parts are sought, not the fewest, and of
    equally few those whose narrowest part is widest. Corners at which the outline turns by less
    than ``FLAT`` are dropped.

    Raises `PhysimError` when the polygon is not simple.
    """
    if not is_simple(polygon):
        raise PhysimError("a polygon that crosses or touches itself, or has no area, has no parts")
    points = counter_clockwise(polygon)
    points = points[_turning(points)]
    trials = MOST_TRIALS if len(points) <= LARGE else 1
    ways = [_cut(points, first) for first in range(trials)]
    ways = [way for way in ways if len(way) == min(map(len, ways))]
    widest = max(ways, key=smallest_width) if len(ways) > 1 else ways[0]
    return tuple(np.ascontiguousarray(part[_turning(part)]) for part in widest)


def _cut(points: FloatArray, first: int = 0) -> list[FloatArray]:
    """Cut a simple counter-clockwise polygon along diagonals from its reflex corners.

    Each time along the one that leaves the fewest corners reflex, the shortest of these; to begin
    with along the ``first`` of them, counted from 0.
    """
    import shapely

    count, reflex = len(points), np.flatnonzero(_turns(points) < -FLAT)
    if not len(reflex):
        return [points]
    i, j = map(np.ravel, np.meshgrid(reflex[: max(1, MOST_LINES // count)], np.arange(count)))
    beside = np.isin((j - i) % count, (0, 1, count - 1))
    i, j = i[~beside], j[~beside]
    left = -1.0 * np.isin(j, reflex)
    for a, b in ((i, j), (j, i)):
        for corner in ((b, a, (a + 1) % count), (a - 1, a, b)):
            left += _sine(*points[list(corner)]) < -FLAT
    length = np.hypot(*(points[j] - points[i]).T)
    corners, whole = shapely.points(points), shapely.Polygon(points)
    best = None
    for k in np.lexsort((length, left)):
        line = shapely.linestrings(points[[i[k], j[k]]])
        if whole.covers(line) and np.count_nonzero(shapely.dwithin(corners, line, LENGTH)) == 2:
            best, first = sorted((i[k], j[k])), first - 1
            if first < 0:
                break
    if best is None:
        raise PhysimError("a polygon could not be cut into convex parts: its edges nearly touch")
    a, b = best
    return _cut(points[a : b + 1]) + _cut(np.concatenate((points[b:], points[: a + 1])))


@compiled
def is_convex_part(points: Rows2, count: int) -> bool:
    """Whether a polygon (n, 2), n >= 3, surely is what `convex_parts` makes of it.

    Every corner turns to the left by clearly more than ``FLAT``, all of them together once round,
    and no two neighbours are one corner. No says nothing. What is asked of a part at every
    decision would otherwise cost far more than its collision time.
    """
    turned = 0.0
    for k in range(count):
        a, b = (k + count - 2) % count, (k + count - 1) % count
        ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        wx, wy = points[k, 0] - points[b, 0], points[k, 1] - points[b, 1]
        before, after = np.hypot(ux, uy), np.hypot(wx, wy)
        cross = ux * wy - uy * wx
        if not (after > 2.0 * LENGTH and cross > 2.0 * FLAT * before * after):
            return False
        turned += math.atan2(cross, ux * wx + uy * wy)
    return turned < 3.0 * math.pi


def _sine(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Sine of the turn at b of the way from a over b to c, positive to the left; each (n, 2)."""
    (ux, uy), (wx, wy) = (b - a).T, (c - b).T
    return np.asarray((ux * wy - uy * wx) / (np.hypot(ux, uy) * np.hypot(wx, wy)))


def _turns(points: FloatArray) -> FloatArray:
    """Sine of the turn at each corner, positive to the left."""
    return _sine(np.roll(points, 1, axis=0), points, np.roll(points, -1, axis=0))


def _turning(points: FloatArray) -> list[int]:
    """Indices of the corners that remain when flat ones go, one after the other."""
    keep = list(range(len(points)))
    k = 0
    while k < len(keep) and len(keep) > 3:
        around = points[[keep[k - 1], keep[k], keep[(k + 1) % len(keep)]]]
        if abs(_turns(around)[1]) > FLAT:
            k += 1
        else:
            del keep[k]
            k = max(k - 1, 0)
    return keep


def circumscribed_radius(polygon: ArrayLike) -> float:
    """Largest distance [m] of a corner from the origin of the polygon's frame."""
    return float(np.hypot(*np.asarray(polygon, dtype=np.float64).T).max())


def least_width(polygon: ArrayLike) -> float:
    """Least width [m] of the convex hull over all directions."""
    import shapely

    hull = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(polygon)))[:0:-1]
    if len(hull) < 3:
        return 0.0
    edges = np.roll(hull, -1, axis=0) - hull
    normals = np.stack((-edges[:, 1], edges[:, 0])) / np.hypot(*edges.T)
    heights = (hull @ normals) - np.sum(hull.T * normals, axis=0)
    return float(heights.max(axis=0).min())


def smallest_width(parts: Sequence[ArrayLike]) -> float:
    """Least width [m] of any convex part: what may slip past a wall in one step.

    For a nonconvex footprint this is at most the width of its hull, so it errs on the safe side.
    """
    return min(least_width(part) for part in parts)


def moment(parts: list[FloatArray], mass: float) -> float:
    """Moment of inertia [kg m^2] about the origin of even polygons that share ``mass`` by area."""
    area = inertia = 0.0
    for part in parts:
        after = np.roll(part, -1, axis=0)
        cross = part[:, 0] * after[:, 1] - part[:, 1] * after[:, 0]
        square = (part * part + part * after + after * after).sum(axis=1)
        area += cross.sum() / 2.0
        inertia += (cross * square).sum() / 12.0
    return float(mass * inertia / area)
