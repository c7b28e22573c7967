"""The closest pair of robots of each picture, found without looking at all pairs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray, IntArray

FEW = 64
"""Robots up to which all pairs are looked at; of more a grid finds those that are near."""
TOGETHER = 4
"""Pairs whose distances are worked out in one go, at first; each time twice as many."""


class Pair(NamedTuple):
    """Two robots, their distance [m] (0 when they touch or overlap) and the points (2, 2) [m]."""

    a: int
    b: int
    distance: float
    points: FloatArray


def as_recorded(pair: Pair, clearance: FloatArray) -> tuple[int, int, float]:
    """The two robots and their distance [m]; of those that touch the two with the greatest depth.

    ``clearance`` (N,) [m] is that of each robot to its nearest in the record, negative = depth.
    """
    if pair.distance > 0.0:
        return pair.a, pair.b, pair.distance
    a, b = sorted(np.argsort(clearance, kind="stable")[:2].tolist())
    return a, b, min(float(clearance.min()), 0.0)


class Closest:
    """Finds the closest pair of N robots at their poses."""

    def __init__(self, footprints: Sequence[Sequence[FloatArray]], reach: FloatArray) -> None:
        """``footprints``: convex parts of the robots, in their frames; ``reach`` (N,) [m].

        The reach is the radius of a disc around the reference point that holds the robot.
        """
        self._reach = reach
        parts = [part for body in footprints for part in body]
        self._closed = [np.concatenate((part, part[:1])) for part in parts]
        self._body = np.repeat(np.arange(len(footprints)), [len(body) for body in footprints])
        self._first = np.searchsorted(self._body, np.arange(len(footprints) + 1))
        self._all = np.triu_indices(len(footprints) if len(footprints) <= FEW else 0, 1)

    def pair(self, pose: FloatArray) -> Pair | None:
        """Return the closest pair at ``pose`` (N, 3), of equal ones the first; None for one robot.

        Pairs are taken in the order of a lower bound, the distance of their enclosing discs, so
        far fewer than all are worked out.
        """
        if len(pose) < 2:
            return None
        a, b, bound = self._near(pose)
        best, found, line = np.inf, 0, np.zeros((2, 2))
        first, count = 0, TOGETHER
        while first < len(a) and bound[first] <= best:
            pairs = np.stack((a[first : first + count], b[first : first + count]))
            one, other = self._shapes(pose, pairs.ravel()).reshape(pairs.shape)
            distance = shapely.distance(one, other)
            k = int(np.argmin(distance))
            if distance[k] < best:
                best, found = float(distance[k]), first + k
                line = shapely.get_coordinates(shapely.shortest_line(one[k], other[k]))
            first, count = first + count, 2 * count
        return Pair(int(a[found]), int(b[found]), best, line)

    def _near(self, pose: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
        """Pairs (M,) among which the closest is, a < b, by their bounds (M,) [m], least first.

        A pair cannot be the closest if its discs are farther apart than the farthest points of
        the discs of another pair.
        """
        a, b = self._all
        if len(pose) > FEW:
            order = np.argsort(pose[:, 0], kind="stable")
            most = self._bounds(pose, order[:-1], order[1:])[1].min()
            a, b = pairs_within(pose[:, :2], float(most + 2.0 * self._reach.max()))
        least, most = self._bounds(pose, a, b)
        kept = np.flatnonzero(least <= most.min())
        a, b, least = a[kept], b[kept], least[kept]
        order = np.lexsort((b, a, least))
        return a[order], b[order], least[order]

    def _bounds(self, pose: FloatArray, a: IntArray, b: IntArray) -> tuple[FloatArray, FloatArray]:
        """Least and greatest distance (M,) [m] that pairs of robots may have."""
        x, y = pose[:, 0].copy(), pose[:, 1].copy()
        x, y = x[a] - x[b], y[a] - y[b]
        gap, reach = np.sqrt(x * x + y * y), self._reach[a] + self._reach[b]
        return gap - reach, gap + reach

    def _shapes(self, pose: FloatArray, robots: IntArray) -> Any:
        """Shapes (M,) of robots in the world."""
        rows, owner = [], []
        for k, robot in enumerate(robots.tolist()):
            for row in range(self._first[robot], self._first[robot + 1]):
                rows.append(row)
                owner.append(k)
        counts = [len(self._closed[row]) for row in rows]
        x, y = np.concatenate([self._closed[row] for row in rows]).T
        x0, y0, angle = pose[np.repeat(robots[owner], counts)].T
        cos, sin = np.cos(angle), np.sin(angle)
        points = np.stack((cos * x - sin * y + x0, sin * x + cos * y + y0), axis=1)
        rings = shapely.linearrings(points, indices=np.repeat(np.arange(len(rows)), counts))
        polygons = shapely.polygons(rings)
        whole = len(rows) == len(robots)
        return polygons if whole else shapely.geometrycollections(polygons, indices=owner)


def pairs_within(places: FloatArray, distance: float) -> tuple[IntArray, IntArray]:
    """Return pairs a < b of places (N, 2) that hold all those at most ``distance`` > 0 apart.

    Places are sorted into square cells of that size: a partner is in the same cell or in one of
    the eight around it, of which four are looked at from either side.
    """
    cell = np.floor((places - places.min(axis=0)) / distance).astype(np.int64)
    row = int(cell[:, 1].max()) + 2  # one stays empty, so that rows do not run into each other
    key = cell[:, 0] * row + cell[:, 1]
    order = np.argsort(key, kind="stable")
    key, own = key[order], np.arange(len(key))
    first = np.concatenate((own + 1, np.searchsorted(key, key + row - 1, side="left")))
    end = np.searchsorted(key, np.concatenate((key + 1, key + row + 1)), side="right")
    count = end - first
    before = np.repeat(np.cumsum(count) - count, count)
    one = order[np.repeat(np.concatenate((own, own)), count)]
    other = order[np.repeat(first, count) + np.arange(len(before)) - before]
    return np.minimum(one, other), np.maximum(one, other)
