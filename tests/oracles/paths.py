"""Distance along paths, (2), the target (3), and the projection that is continuous in time."""

from __future__ import annotations

import numpy as np


def lengths(points):
    """Arc length (n,) at every waypoint."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def point_at(points, station):
    """Point (2,) of a path at a station [m], its ends beyond them, and the direction (2,) there."""
    station_of = lengths(points)
    station = min(max(station, 0.0), station_of[-1])
    x, y = (np.interp(station, station_of, column) for column in points.T)
    segment = min(int(np.searchsorted(station_of, station, side="right")) - 1, len(points) - 2)
    step = points[segment + 1] - points[segment]
    return np.array([x, y]), step / np.hypot(*step)


def target(points, station, look_ahead):
    """Target (3): ``look_ahead`` further along than the projection, the last waypoint at most."""
    return point_at(points, station + look_ahead)


def nearest_station(points, xy, low=-np.inf, high=np.inf):
    """Station in [low, high] of the nearest point of a path, and the deviation, left positive.

    Segment by segment: the foot of the perpendicular, held within the segment and the stretch.
    """
    station_of = lengths(points)
    best = (np.inf, 0.0, 0.0)
    for a, b, begin, end in zip(points, points[1:], station_of, station_of[1:], strict=False):
        first, last = max(begin, low), min(end, high)
        if first > last:
            continue
        along = (b - a) / (end - begin)
        station = min(max(begin + (xy - a) @ along, first), last)
        offset = xy - (a + (station - begin) * along)
        left = along[0] * offset[1] - along[1] * offset[0]
        gap = np.hypot(*offset)
        if gap < best[0]:
            best = (gap, station, np.copysign(gap, left))
    return best[1], best[2]


def followed_station(points, xy, previous, window):
    """Projection (3) continuous in time: nearest point within ``window`` of the last station."""
    end = lengths(points)[-1]
    previous = min(max(previous, 0.0), end)
    return nearest_station(points, xy, previous - window, previous + window)
