"""A path on which many places are looked up at once."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, IntArray

JOINED = 1.0
"""[m] A path whose ends are nearer than this is closed."""


def is_ring(path: FloatArray) -> bool:
    """Whether a path (n, 2) [m] ends where it begins."""
    return float(np.hypot(*(path[0] - path[-1]))) < JOINED


class Way:
    """Places on a path (n, 2) [m] by station, and stations by place; numpy and a tree."""

    def __init__(self, path: FloatArray) -> None:
        self.points, self.step = path, np.diff(path, axis=0)
        self.length = np.hypot(*self.step.T)
        self.station = np.concatenate(([0.0], np.cumsum(self.length)))
        self._tree = shapely.STRtree(shapely.linestrings(np.stack([path[:-1], path[1:]], axis=1)))

    def at(self, stations: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places (K, 2) at stations (K,) [m] and unit directions (K, 2) of the path there.

        The ends hold beyond them.
        """
        stations = np.clip(stations, 0.0, self.station[-1])
        found = np.searchsorted(self.station, stations, side="right") - 1
        k = np.clip(found, 0, len(self.step) - 1)
        direction = self.step[k] / self.length[k, None]
        return self.points[k] + (stations - self.station[k])[:, None] * direction, direction

    def nearest(self, places: FloatArray) -> FloatArray:
        """Stations (K,) [m] of the points of the path nearest to places (K, 2).

        The smaller station of equally near ones.
        """
        place, segment = self._tree.query_nearest(shapely.points(places))
        k = np.full(len(places), len(self.step))
        np.minimum.at(k, place, segment)
        along = ((places - self.points[k]) * self.step[k]).sum(axis=1) / self.length[k]
        return np.asarray(self.station[k] + np.clip(along, 0.0, self.length[k]))

    def within(
        self, places: FloatArray, reach: FloatArray
    ) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
        """All segments that come as near to places (K, 2) as ``reach`` (K,) [m].

        Numbers of places and of segments, the station [m] of the nearest point, how far it is [m].
        """
        points = shapely.points(places)
        place, k = self._tree.query(points, predicate="dwithin", distance=reach)
        along = ((places[place] - self.points[k]) * self.step[k]).sum(axis=1) / self.length[k]
        along = np.clip(along, 0.0, self.length[k])
        foot = self.points[k] + (along / self.length[k])[:, None] * self.step[k]
        return place, k, self.station[k] + along, np.hypot(*(places[place] - foot).T)

    def beside(
        self, outlines: NDArray[np.object_], places: FloatArray, reach: float
    ) -> tuple[IntArray, FloatArray, FloatArray]:
        """Where the path comes as near to the ``outlines`` of bodies at places (K, 2) as ``reach``.

        Numbers of bodies, the station [m] nearest to the place on that segment, how far the segment
        is from the outline [m].
        """
        body, k = self._tree.query(outlines, predicate="dwithin", distance=reach)
        along = ((places[body] - self.points[k]) * self.step[k]).sum(axis=1) / self.length[k]
        away = shapely.distance(outlines[body], self._tree.geometries[k])
        return body, self.station[k] + np.clip(along, 0.0, self.length[k]), away
