"""Polygons: simple or not, area, cut into few convex parts, width.

A polygon is an array (n, 2) [m] of its corners in either direction, not closed by a repeated
corner (a repeated last corner is dropped). Parts are convex and counter-clockwise.

The cut goes along diagonals. Ears are clipped to triangles, then diagonals that are not needed
are taken out again (Hertel and Mehlhorn 1983: at most four times as many parts as the fewest).
The result depends on the order, so several orders are tried and the best is chosen.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from physim.compiled import compiled
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray
from physim.tolerances import FLAT, LENGTH

Corner = tuple[float, float]
Ring = list[int]

MOST_TRIALS = 8
"""Orders tried for a small polygon; a large one gets one."""
LARGE = 40
"""Corners of a large polygon."""


def cut(points: FloatArray) -> Iterator[list[Ring]]:
    """Yield ways to cut a simple counter-clockwise polygon (n, 2): parts as lists of indices."""
    corners: list[Corner] = [(x, y) for x, y in (points - points[0]).tolist()]
    trials = 1 if len(corners) > LARGE else min(len(corners), MOST_TRIALS)
    for trial in range(trials):
        start = None if trial == 0 else trial * len(corners) // trials
        triangles = _triangles(corners, start)
        for longest_first in (True, False):
            yield _merged(corners, triangles, longest_first)


def _turn(a: Corner, b: Corner, c: Corner) -> float:
    """Twice the signed area of a triangle, positive when counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _is_flat_or_left(a: Corner, b: Corner, c: Corner) -> bool:
    return _turn(a, b, c) >= -FLAT * math.dist(a, b) * math.dist(b, c)


def _is_left(a: Corner, b: Corner, c: Corner) -> bool:
    return _turn(a, b, c) > FLAT * math.dist(a, b) * math.dist(b, c)


def _triangles(corners: list[Corner], start: int | None) -> list[Ring]:
    """Clip ears: the best-shaped one each time, or the next one from ``start`` on."""
    ring = list(range(len(corners)))
    if start is not None:
        ring = ring[start:] + ring[:start]
    after = dict(zip(ring, ring[1:] + ring[:1], strict=True))
    before = {j: i for i, j in after.items()}
    reflex = {i for i in ring if not _is_left(corners[before[i]], corners[i], corners[after[i]])}
    quality = {i: q for i in ring if (q := _ear(corners, before[i], i, after[i], reflex)) > 0.0}
    triangles: list[Ring] = []
    while len(after) > 3:
        if not quality:
            quality = _all_ears(corners, before, after, reflex)
        i = max(quality, key=quality.__getitem__) if start is None else next(iter(quality))
        a, c = before.pop(i), after.pop(i)
        triangles.append([a, i, c])
        after[a], before[c] = c, a
        quality.pop(i)
        reflex.discard(i)
        for k in (a, c):
            quality.pop(k, None)
            if _is_left(corners[before[k]], corners[k], corners[after[k]]):
                reflex.discard(k)
            if (q := _ear(corners, before[k], k, after[k], reflex)) > 0.0:
                quality[k] = q
    i = next(iter(after))
    triangles.append([before[i], i, after[i]])
    return triangles


def _all_ears(
    corners: list[Corner], before: dict[int, int], after: dict[int, int], reflex: set[int]
) -> dict[int, float]:
    """Look for ears anew; where rounding hides them all, take the flattest corner off."""
    ears = {i: q for i in after if (q := _ear(corners, before[i], i, after[i], reflex)) > 0.0}
    if ears:
        return ears
    flat = min(after, key=lambda i: abs(_turn(*(corners[k] for k in (before[i], i, after[i])))))
    a, b, c = (corners[k] for k in (before[flat], flat, after[flat]))
    if abs(_turn(a, b, c)) > 1e3 * FLAT * math.dist(a, b) * math.dist(b, c):
        raise PhysimError("a polygon could not be cut into convex parts: its edges nearly touch")
    return {flat: 1.0}


def _ear(corners: list[Corner], i: int, j: int, k: int, reflex: set[int]) -> float:
    """Return the smallest height over the longest side of ear (i, j, k), 0 where it is none."""
    a, b, c = corners[i], corners[j], corners[k]
    if not _is_left(a, b, c):
        return 0.0
    for r in reflex:
        if r in (i, j, k):
            continue
        p = corners[r]
        if _turn(c, a, p) >= 0.0 and _turn(a, b, p) >= 0.0 and _turn(b, c, p) >= 0.0:
            return 0.0
    longest = max(math.dist(a, b), math.dist(b, c), math.dist(c, a))
    return _turn(a, b, c) / longest**2


def _merged(corners: list[Corner], triangles: list[Ring], longest_first: bool) -> list[Ring]:
    """Take out every diagonal whose two parts together are convex."""
    parts = dict(enumerate(triangles))
    owner = {edge: k for k, part in parts.items() for edge in _edges(part)}
    diagonals = [(i, j) for i, j in owner if i < j and (j, i) in owner]
    diagonals.sort(key=lambda e: math.dist(corners[e[0]], corners[e[1]]), reverse=longest_first)
    for i, j in diagonals:
        keep, drop = owner[i, j], owner[j, i]
        joined = _joined(parts[keep], parts[drop], i, j)
        if joined is None or not _convex_at(corners, joined, (i, j)):
            continue
        parts[keep] = joined
        for edge in _edges(parts.pop(drop)):
            owner[edge] = keep
    return list(parts.values())


def _edges(part: Ring) -> list[tuple[int, int]]:
    return list(zip(part, part[1:] + part[:1], strict=True))


def _joined(first: Ring, second: Ring, i: int, j: int) -> Ring | None:
    """Ring of two parts without the edge i-j they share; None if they share more of it."""
    at, to = first.index(j), second.index(i)
    ring = first[at:] + first[:at] + (second[to:] + second[:to])[1:-1]
    return ring if len(set(ring)) == len(ring) else None


def _convex_at(corners: list[Corner], ring: Ring, ends: tuple[int, int]) -> bool:
    for end in ends:
        k = ring.index(end)
        a, b, c = (corners[ring[m % len(ring)]] for m in (k - 1, k, k + 1))
        if not _is_flat_or_left(a, b, c):
            return False
    return True


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


@compiled
def is_convex_part(points: FloatArray) -> bool:
    """Whether a polygon (n, 2), n >= 3, surely is what `convex_parts` makes of it.

    Every corner turns to the left by clearly more than ``FLAT``, all of them together once round,
    and no two neighbours are one corner. No says nothing. What is asked of a part at every
    decision would otherwise cost far more than its collision time.
    """
    count, turned = len(points), 0.0
    for k in range(count):
        a, b, c = points[k - 2], points[k - 1], points[k]
        ux, uy, wx, wy = b[0] - a[0], b[1] - a[1], c[0] - b[0], c[1] - b[1]
        before, after = math.hypot(ux, uy), math.hypot(wx, wy)
        cross = ux * wy - uy * wx
        if not (after > 2.0 * LENGTH and cross > 2.0 * FLAT * before * after):
            return False
        turned += math.atan2(cross, ux * wx + uy * wy)
    return turned < 3.0 * math.pi


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
