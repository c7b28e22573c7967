"""Polygons: simple or not, area, cut into convex parts, width.

A polygon is an array (n, 2) [m] of its corners in either direction, not closed by a repeated
corner (a repeated last corner is dropped). Parts are convex and counter-clockwise.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from physim.errors import PhysimError
from physim.geometry.convex_cut import cut
from physim.geometry.shapes import FloatArray
from physim.tolerances import FLAT, LENGTH


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
    if _is_convex(points):
        return (points,)
    ways = list(cut(points))
    fewest = min(len(parts) for parts in ways)
    candidates = [[points[part] for part in parts] for parts in ways if len(parts) == fewest]
    widest = max(candidates, key=smallest_width) if len(candidates) > 1 else candidates[0]
    return tuple(_trimmed(part) for part in widest)


def _turns(points: FloatArray) -> FloatArray:
    """Sine of the turn at each corner, positive to the left."""
    before = points - np.roll(points, 1, axis=0)
    after = np.roll(points, -1, axis=0) - points
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    lengths = np.hypot(*before.T) * np.hypot(*after.T)
    return np.asarray(cross / lengths, dtype=np.float64)


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


def _trimmed(part: FloatArray) -> FloatArray:
    return np.ascontiguousarray(part[_turning(part)])


def _is_convex(points: FloatArray) -> bool:
    return bool((_turns(points) > -FLAT).all())


def circumscribed_radius(polygon: ArrayLike) -> float:
    """Largest distance [m] of a corner from the origin of the polygon's frame."""
    return float(np.hypot(*np.asarray(polygon, dtype=np.float64).T).max())


def least_width(polygon: ArrayLike) -> float:
    """Least width [m] of the convex hull over all directions."""
    hull = convex_hull(polygon)
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


def convex_hull(polygon: ArrayLike) -> FloatArray:
    """Corners (m, 2) of the convex hull, counter-clockwise, without flat ones (monotone chain)."""
    points = np.unique(np.asarray(polygon, dtype=np.float64).reshape(-1, 2), axis=0)
    if len(points) < 3:
        return points
    lower, upper = _chain(points), _chain(points[::-1])
    return np.array(lower[:-1] + upper[:-1])


def _chain(points: FloatArray) -> list[tuple[float, float]]:
    chain: list[tuple[float, float]] = []
    for x, y in points.tolist():
        while len(chain) > 1:
            (ax, ay), (bx, by) = chain[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                break
            chain.pop()
        chain.append((x, y))
    return chain
