"""Polylines: stations along them, loops cut off, and lanes of robots beside a reference path.

A sideways line crosses itself in a tight bend; the loop is cut off where it crosses. A lane is
drawn in towards the reference path where it has too little room.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import atan2
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import rounded
from physim.authoring.importing.work import MANY
from physim.geometry.corridor import offset_polyline
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


def samples(length: float, step: float) -> FloatArray:
    """(k,) [m] stations from 0 to ``length``, about ``step`` apart, at most 5000."""
    count = int(min(max(np.ceil(length / step), 1), MOST_SAMPLES))
    return np.linspace(0.0, length, count + 1)


def points_at(line: FloatArray, at: FloatArray | float) -> FloatArray:
    """(k, 2) points at stations, or (2,) at one; the ends hold beyond them."""
    own = stations(line)
    return np.stack([np.interp(at, own, line[:, k]) for k in (0, 1)], axis=-1)


def directions_at(line: FloatArray, at: FloatArray | float, window: float) -> FloatArray:
    """(k, 2) unit directions of the chord over ``window`` [m] about each station, or (2,)."""
    end = length_of(line)
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
    loop. Raises CrossingError where a loop is longer, loops within it that were cut off before
    included: otherwise two stretches side by side would be eaten up, a loop at a time.
    """
    whole = stations(line)
    cut: list[tuple[FloatArray, float]] = []
    for _ in range(MOST_ROUNDS):
        loops = _loops(line)
        if not loops:
            return line, cut
        pieces, kept, at = [], [], 0
        for first, last, point in sorted(loops, key=lambda loop: (loop[0], -loop[1])):
            ends = np.hypot(*(line[[first + 1, last]] - point).T).sum()
            length = float(whole[last] - whole[first + 1] + ends)
            if first < at or length > longest:
                continue
            pieces += [line[at : first + 1], point[None]]
            kept += [whole[at : first + 1], whole[first : first + 1]]
            cut.append((point, length))
            at = last + 1
        if not pieces:
            raise CrossingError(loops[0][2])
        line, whole = np.vstack([*pieces, line[at:]]), np.concatenate([*kept, whole[at:]])
        is_new = np.concatenate(([True], np.hypot(*np.diff(line, axis=0).T) > 1e-9))
        line, whole = line[is_new], whole[is_new]
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


SLOPE = 0.2
"""[-] How fast a lane may draw in, across over along."""
MOST_SAMPLES, FEWEST_SAMPLES = 8_000, 200
"""Places along a path at which offsets are tried, of all lanes, and of one"""
FRACTIONS = 41
"""Steps in which a lane's offset is tried, from nothing to all of it."""


@dataclass(frozen=True)
class Lane:
    """Path of a lane (n, 2) [m]; ``offset`` [m], left positive, where it holds throughout."""

    line: FloatArray
    offset: float
    is_plain: bool
    narrowest: float
    """[m] least offset along it on its own side; negative: that far over on the other"""

    @property
    def plain_offset(self) -> float | None:
        """Offset [m] by which a world can name it; None where its points are needed."""
        return self.offset if self.is_plain else None

    def narrowing(self) -> str:
        """Say how far it is drawn in; empty where it is not, to the centimetre."""
        if f"{self.narrowest:.2f}" == f"{abs(self.offset):.2f}":
            return ""
        where = "where the corridor is narrow or bends tightly"
        if self.narrowest < 0.0:
            return f"is drawn over to {-self.narrowest:.2f} m on its other side {where}"
        return f"is drawn in to {self.narrowest:.2f} m {where}"


def lane(
    reference: FloatArray, offset: float, outline: Outline, room: float, size: float, lanes: int
) -> Lane:
    """Lane ``offset`` [m] beside the reference path with clearance ``room`` [m] where there is.

    Where there is not, it is drawn in towards the reference path, and, where that has not the room
    either, over to its other side. It is one of so many ``lanes``, which share the work.
    """
    if offset == 0.0:
        return Lane(reference, 0.0, True, 0.0)
    plain = _plain(reference, offset, outline, room)
    if plain is not None:
        return Lane(plain, offset, True, abs(offset))
    length = length_of(reference)
    at = samples(length, max(0.5 * size, length / max(MOST_SAMPLES // lanes, FEWEST_SAMPLES)))
    base = points_at(reference, at)
    direction = directions_at(reference, at, 2.0 * abs(offset))
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    share = _shares(base, offset * normal, outline, room)
    share = _gentle(share, at, SLOPE / abs(offset))
    line = base + (share * offset)[:, None] * normal
    if (reference[0] == reference[-1]).all():
        line = line[:-1]  # a lap is no loop to be cut off
    try:
        line = without_loops(line, float("inf"))[0]
    except CrossingError:  # too many loops: no lane of its own
        return Lane(reference, offset, False, 0.0)
    simple = shapely.simplify(shapely.LineString(line), 0.02 * size)
    return Lane(
        rounded(shapely.get_coordinates(simple)), offset, False, abs(offset) * float(share.min())
    )


def _shares(base: FloatArray, across: FloatArray, outline: Outline, room: float) -> FloatArray:
    """(k,) [-] share of ``across`` (k, 2) [m] at which each of the points ``base`` has the room.

    The largest that the reference path reaches without coming nearer to a wall than it is itself;
    negative where only its other side has room. Where neither has, the share with the most.
    """
    share, best = _outward(base, across, outline, room)
    tight = np.flatnonzero(best < room)
    if tight.size:
        back = -across[tight] * (room / np.hypot(*across[tight].T))[:, None]
        other, gained = _outward(base[tight], back, outline, room, farthest=False)
        wider = gained > best[tight]
        moved = -other * room / np.hypot(*across[tight].T)
        share[tight] = np.where(wider, moved, share[tight])
    return share


def _outward(
    base: FloatArray, across: FloatArray, outline: Outline, room: float, farthest: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Share of ``across`` and the clearance there [m], capped at ``room``.

    The farthest share with the room, or the first.
    """
    share = np.zeros(len(base))
    best = np.minimum(outline.clearances(base), room)
    reached, need = share.copy(), best.copy()
    for fraction in np.linspace(0.0, 1.0, FRACTIONS)[1:]:
        gap = np.minimum(outline.clearances(base + fraction * across), room)
        held = (reached >= fraction - 1.5 / FRACTIONS) & (gap >= need)
        reached = np.where(held, fraction, reached)
        better = held & ((gap > best) | (farthest & (gap >= room)))
        share, best = np.where(better, fraction, share), np.where(better, gap, best)
    return share, best


def _plain(
    reference: FloatArray, offset: float, outline: Outline, room: float
) -> FloatArray | None:
    """The mitred offset line, where it neither folds nor comes too near a wall; None otherwise."""
    try:
        line = offset_polyline(reference, np.full(len(reference), offset))
    except ValueError:
        return None
    along = (np.diff(line, axis=0) * np.diff(reference, axis=0)).sum(axis=1)
    if (along <= 0.0).any() or not shapely.LineString(line).is_simple:
        return None
    at = samples(length_of(line), 0.25 * room)
    return line if (outline.clearances(points_at(line, at)) >= room - 1e-6).all() else None


def _gentle(share: FloatArray, at: FloatArray, slope: float) -> FloatArray:
    """Largest function below ``share`` that changes by at most ``slope`` [1/m]."""
    low = share.copy()
    for k in range(1, len(low)):
        low[k] = min(low[k], low[k - 1] + slope * (at[k] - at[k - 1]))
    for k in range(len(low) - 2, -1, -1):
        low[k] = min(low[k], low[k + 1] + slope * (at[k + 1] - at[k]))
    return low
