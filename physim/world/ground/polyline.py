"""Polylines by arc length: places at stations, stations of places, stretches, crossings.

A station is the arc length [m] from the first point. For worlds that are read, checked or imported;
what a run looks up at every step is in `physim.geometry.path`.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import shapely
from numpy.typing import ArrayLike

from physim.geometry.shapes import FloatArray, IntArray
from physim.tolerances import LENGTH


class Polyline:
    """A polyline of n points, of which no two neighbours are equal; it does not change."""

    def __init__(self, points: ArrayLike) -> None:
        """Points (n, 2) [m]."""
        self.points: FloatArray = np.asarray(points, dtype=np.float64)
        step = np.diff(self.points, axis=0)
        size = np.hypot(*step.T)
        self.station: FloatArray = np.concatenate(([0.0], np.cumsum(size)))
        """(n,) [m] of each point"""
        self.direction: FloatArray = step / size[:, None]
        """(n - 1, 2) unit vector of each segment"""

    @property
    def length(self) -> float:
        """[m]."""
        return float(self.station[-1])

    @cached_property
    def shape(self) -> shapely.LineString:
        """The same as a shapely line."""
        return shapely.LineString(self.points)

    def is_ring(self, within: float = LENGTH) -> bool:
        """Whether it ends where it begins, or as near as ``within`` [m]."""
        return float(np.hypot(*(self.points[0] - self.points[-1]))) <= within

    def at(self, stations: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Places (K, 2) [m] at stations (K,) and unit directions (K, 2) there, or (2,) at one.

        The ends hold beyond them; at a point it is the direction of the segment that begins there.
        """
        wanted = np.clip(np.asarray(stations, dtype=np.float64), 0.0, self.station[-1])
        k = np.searchsorted(self.station, wanted, side="right") - 1
        k = np.clip(k, 0, len(self.direction) - 1)
        direction = self.direction[k]
        return self.points[k] + (wanted - self.station[k])[..., None] * direction, direction

    def chords(self, stations: ArrayLike, window: float) -> FloatArray:
        """Unit directions (K, 2) of the chords over ``window`` [m] about stations, or (2,) at one.

        Of a ring over its joint, of another line as far as it goes.
        """
        wanted = np.asarray(stations, dtype=np.float64)
        low, high = wanted - 0.5 * window, wanted + 0.5 * window
        if self.is_ring() and self.length > window:
            low, high = low % self.length, high % self.length
        chord = self.at(high)[0] - self.at(low)[0]
        size = np.hypot(*chord.T)[..., None]
        return np.where(size > LENGTH, chord / np.maximum(size, LENGTH), self.at(wanted)[1])

    def nearest(self, places: ArrayLike) -> FloatArray:
        """Stations (K,) [m] of the points nearest to places (K, 2), the smallest of equals."""
        at = np.asarray(places, dtype=np.float64).reshape(-1, 2)
        place, segment = self._segments.query_nearest(shapely.points(at))
        k = np.full(len(at), len(self.direction))
        np.minimum.at(k, place, segment)
        return self._foot(at, k)

    def within(
        self, places: ArrayLike, reach: ArrayLike
    ) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
        """All segments that come as near to places (K, 2) as ``reach`` [m], one or (K,).

        Numbers of places and of segments, the station [m] of the nearest point, how far it is [m].
        """
        at = np.asarray(places, dtype=np.float64).reshape(-1, 2)
        place, k = self._segments.query(shapely.points(at), predicate="dwithin", distance=reach)
        station = self._foot(at[place], k)
        foot = self.points[k] + (station - self.station[k])[:, None] * self.direction[k]
        return place, k, station, np.hypot(*(at[place] - foot).T)

    def stretch(self, first: float, last: float) -> FloatArray:
        """Points (m, 2) [m] of the part from one station to a later one."""
        inner = (self.station > first + LENGTH) & (self.station < last - LENGTH)
        begin, end = self.at(np.array([first, last]))[0]
        return np.vstack([begin, self.points[inner], end])

    def crossings(self) -> list[tuple[int, int, FloatArray]]:
        """Segments i < j that meet elsewhere than at the joint between them, and where (2,) [m].

        Of a stretch that both share its middle.
        """
        if len(self.points) < 3 or self.shape.is_simple:
            return []
        pieces = self._segments.geometries
        i, j = self._segments.query(pieces, predicate="intersects")
        apart = (j > i) & ~((i == 0) & (j == len(pieces) - 1) & self.is_ring())
        i, j = i[apart], j[apart]
        common = shapely.intersection(pieces[i], pieces[j])
        inner = (j > i + 1) | (shapely.length(common) > 0.0)
        places = shapely.get_coordinates(shapely.centroid(common[inner]))
        return list(zip(i[inner].tolist(), j[inner].tolist(), places, strict=True))

    @cached_property
    def _segments(self) -> shapely.STRtree:
        ends = np.stack([self.points[:-1], self.points[1:]], axis=1)
        return shapely.STRtree(shapely.linestrings(ends))

    def _foot(self, places: FloatArray, k: IntArray) -> FloatArray:
        """Stations (K,) [m] of the points of segments (K,) nearest to places (K, 2)."""
        along = ((places - self.points[k]) * self.direction[k]).sum(axis=1)
        station = np.clip(self.station[k] + along, self.station[k], self.station[k + 1])
        return np.asarray(station)
