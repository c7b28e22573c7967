"""Polylines: stations along them, distances to them, and loops cut off."""

from __future__ import annotations

from collections.abc import Iterable
from math import atan2
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.work import MANY
from physim.geometry.shapes import FloatArray, IntArray

MOST_SAMPLES = 5000

Pose = tuple[float, float, float]
"""x, y [m] and heading [rad]"""


def stations(line: FloatArray) -> FloatArray:
    """(n,) [m] arc length at each point."""
    return np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))


def length_of(line: FloatArray) -> float:
    """Length [m] of a polyline."""
    return float(stations(line)[-1])


def is_closed(line: FloatArray) -> bool:
    """Whether a polyline ends where it begins."""
    return bool((line[0] == line[-1]).all())


def samples(length: float, step: float) -> FloatArray:
    """(k,) [m] stations from 0 to ``length``, about ``step`` apart, at most 5000."""
    count = int(min(max(np.ceil(length / step), 1), MOST_SAMPLES))
    return np.linspace(0.0, length, count + 1)


def points_at(line: FloatArray, at: FloatArray | float) -> FloatArray:
    """(k, 2) points at stations, or (2,) at one; the ends hold beyond them."""
    own = stations(line)
    return np.stack([np.interp(at, own, line[:, k]) for k in (0, 1)], axis=-1)


def directions_at(line: FloatArray, at: FloatArray | float, window: float) -> FloatArray:
    """(k, 2) unit directions of the chord over ``window`` [m] about each station, or (2,).

    Of a closed line over its joint, of another as far as it goes.
    """
    end = length_of(line)
    if is_closed(line) and end > window:
        before, after = stretch(line, end - window, end), stretch(line, 0.0, window)
        line, at, end = np.vstack([before[:-1], line, after[1:]]), at + window, end + 2.0 * window
    low, high = np.clip(at - window / 2.0, 0.0, end), np.clip(at + window / 2.0, 0.0, end)
    chord = points_at(line, high) - points_at(line, low)
    size = np.hypot(*chord.T)
    fallback = line[-1] - line[0] + np.array([1e-300, 0.0])
    chord = np.where((size > 1e-12)[..., None], chord, fallback)
    return np.asarray(chord / np.hypot(*chord.T)[..., None])


def pose_at(line: FloatArray, station: float, window: float) -> Pose:
    """Pose on a polyline, heading along the chord over ``window`` [m] about the station."""
    x, y = points_at(line, station)
    tx, ty = directions_at(line, station, window)
    return float(x), float(y), atan2(ty, tx)


def station_of(line: FloatArray, point: FloatArray) -> float:
    """Station [m] of the point of a polyline that is nearest to ``point`` (2,)."""
    return float(shapely.LineString(line).project(shapely.Point(point)))


def stretch(line: FloatArray, first: float, last: float) -> FloatArray:
    """Part of a polyline from one station to another."""
    own = stations(line)
    inner = line[(own > first + 1e-9) & (own < last - 1e-9)]
    ends = points_at(line, np.array([first, last]))
    return np.vstack([ends[:1], inner, ends[1:]])


class Outline:
    """A shapely area whose edge is asked for distances many times.

    The segments of an edge of many points are put into a tree: an edge as a whole takes up to a
    time in proportion to its points for each distance.
    """

    def __init__(self, area: Any) -> None:
        self.area, self.edge = area, area.boundary
        shapely.prepare(self.area)
        shapely.prepare(self.edge)
        lines = map(shapely.get_coordinates, shapely.get_parts(self.edge))
        self._tree = _tree(lines) if shapely.get_num_coordinates(area) > MANY else None

    def clearances(self, points: FloatArray) -> FloatArray:
        """(k,) [m] distance of points to the edge; negative outside the area."""
        at = shapely.points(points)
        distance = self.distances(at)
        return np.asarray(np.where(shapely.covers(self.area, at), distance, -distance))

    def crossed(self, lines: Any) -> IntArray:
        """Numbers of the shapely lines that meet the edge."""
        if self._tree is None:
            return np.flatnonzero(shapely.intersects(self.edge, lines))
        return np.unique(self._tree.query(lines, predicate="intersects")[0])

    def distances(self, shapes: Any) -> FloatArray:
        """(k,) [m] distance of shapely shapes to the edge."""
        if self._tree is None:
            return np.asarray(shapely.distance(self.edge, shapes))
        return _nearest(self._tree, shapes)


def _tree(lines: Iterable[FloatArray]) -> shapely.STRtree:
    ends = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
    return shapely.STRtree(shapely.linestrings(ends))


def _nearest(tree: shapely.STRtree, shapes: Any) -> FloatArray:
    _, found = tree.query_nearest(shapes, return_distance=True, all_matches=False)
    return np.asarray(found)


def distances_to(line: FloatArray, points: FloatArray) -> FloatArray:
    """(k,) [m] distance of points (k, 2) to a polyline (n, 2)."""
    at = shapely.points(points)
    if len(line) > MANY:
        return _nearest(_tree([line]), at)
    whole = shapely.LineString(line)
    shapely.prepare(whole)
    return np.asarray(shapely.distance(whole, at))


def clearances(points: FloatArray, area: Any) -> FloatArray:
    """(k,) [m] distance of points to the edge of an area; negative outside it."""
    return Outline(area).clearances(points)


MOST_ROUNDS = 20
"""Times that a line is looked over; one that still crosses itself then is no road."""


LAP = np.pi + 0.1
"""[rad] by which a line turns that goes round itself, and does not just turn back"""


class CrossingError(ValueError):
    """A line that crosses itself far along it: no bend, but a crossing. ``point`` (2,) [m]."""

    def __init__(self, point: FloatArray) -> None:
        super().__init__("the line crosses itself")
        self.point = point


def without_loops(
    line: FloatArray, longest: float, courses: FloatArray | None = None
) -> tuple[FloatArray, list[tuple[FloatArray, float]]]:
    """Cut off every loop of a polyline (n, 2) whose length [m] is at most ``longest``.

    Returns the line, which no longer crosses itself, and the crossing point and length of each
    loop. Raises CrossingError where a loop is longer, loops within it that were cut off before
    included: otherwise two stretches side by side would be eaten up, a loop at a time.

    ``courses`` (n,) [rad], without jumps, are those of a line that this one lies beside: where they
    turn by more than half a turn in a loop, it goes round itself, and the loop stays.
    """
    whole = stations(line)
    line = line.copy()
    courses = np.zeros(len(line)) if courses is None else courses
    cut: list[tuple[FloatArray, float]] = []
    for _ in range(MOST_ROUNDS):
        turns = [(i, j, abs(courses[j] - courses[i]), point) for i, j, point in crossings(line)]
        loops = [(i, j, point) for i, j, turn, point in turns if turn < LAP]
        if not loops:
            return line, cut
        kept, at = [], 0
        for first, last, point in sorted(loops, key=lambda loop: (loop[0], -loop[1])):
            ends = np.hypot(*(line[[first + 1, last]] - point).T).sum()
            length = float(whole[last] - whole[first + 1] + ends)
            if first < at or length > longest:
                continue
            line[first + 1] = point  # the loop's first point becomes the crossing
            whole[first + 1] = whole[first]
            kept.append(np.arange(at, first + 2))
            cut.append((point, length))
            at = last + 1
        if not kept:
            raise CrossingError(loops[0][2])
        left = np.concatenate([*kept, np.arange(at, len(line))])
        is_new = np.concatenate(([True], np.hypot(*np.diff(line[left], axis=0).T) > 1e-9))
        line, whole, courses = line[left[is_new]], whole[left[is_new]], courses[left[is_new]]
    raise CrossingError(line[0])


def crossings(line: FloatArray) -> list[tuple[int, int, FloatArray]]:
    """Segments i < j of a polyline (n, 2), not neighbours, that cross, and where (2,) [m]."""
    if len(line) < 3 or shapely.LineString(line).is_simple:
        return []
    segments = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    i, j = shapely.STRtree(segments).query(segments, predicate="intersects")
    ring = is_closed(line)
    apart = (j - i >= 2) & ~((i == 0) & (j == len(segments) - 1) & ring)
    i, j = i[apart], j[apart]
    common = shapely.intersection(segments[i], segments[j])
    return [
        (int(a), int(b), np.asarray(shapely.get_coordinates(c)[0]))
        for a, b, c in zip(i, j, common, strict=True)
    ]
