"""Stations along a polyline: points, directions, stretches and clearances, many at once."""

from __future__ import annotations

from math import atan2
from typing import Any

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray

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


def clearances(points: FloatArray, area: Any) -> FloatArray:
    """(k,) [m] distance of points to the edge of an area; negative outside it."""
    shapely.prepare(area)
    edge = area.boundary
    shapely.prepare(edge)
    at = shapely.points(points)
    distance = shapely.distance(edge, at)
    return np.asarray(np.where(shapely.covers(area, at), distance, -distance))
