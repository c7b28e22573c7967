"""Paths: arc length, points at a station, and projections (3) that follow the robots.

A station is the arc length [m] from the first waypoint. The kernels work on `Polylines`; `Path`
is the same for one polyline and for reading by people.

A projection does not jump between branches: from step to step it looks at most a window along
the path, two circumscribed radii of the robot, at least 1 m. That is more than a robot moves in a
step, and less than the way between two branches of a path that passes near itself. Of a robot
away from the path it looks as far as the inside of a corner asks for (`track`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, tan

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, Polylines, locked, pack_polylines

SHARPEST_TURN = 2.6
"""[rad] Beyond this (150 degrees) a mitred corner of a road would reach four half-widths out."""
CORNER = 2.0 * tan(0.5 * SHARPEST_TURN)
"""[-] way along a path over the distance from it, between the two points nearest to a robot on the
inside of its sharpest turn"""


@compiled
def path_length(lines: Polylines, k: int) -> float:
    """Length [m] of polyline k."""
    return float(lines.station[lines.start[k + 1] - 1])


@compiled
def segment_at(lines: Polylines, k: int, station: float) -> int:
    """Index of the first point of the segment of polyline k that holds a station (clamped)."""
    low, high = lines.start[k], lines.start[k + 1] - 2
    while low < high:
        middle = (low + high + 1) // 2
        if lines.station[middle] <= station:
            low = middle
        else:
            high = middle - 1
    return int(low)


@compiled
def point_at(lines: Polylines, k: int, station: float) -> tuple[float, float, float, float]:
    """Point at a station of polyline k and the unit direction there: x, y, tx, ty (2).

    Before the first waypoint it is the first, past the last it is the last.
    """
    a = segment_at(lines, k, station)
    length = lines.station[a + 1] - lines.station[a]
    tx = (lines.points[a + 1, 0] - lines.points[a, 0]) / length
    ty = (lines.points[a + 1, 1] - lines.points[a, 1]) / length
    along = min(max(station - lines.station[a], 0.0), length)
    return lines.points[a, 0] + along * tx, lines.points[a, 1] + along * ty, tx, ty


@compiled
def left_of_both(lines: Polylines, a: int, b: int, ox: float, oy: float) -> bool:
    """Whether (ox, oy) from the waypoint between segments a and b is left of both together."""
    p, s = lines.points, lines.station
    one, other = s[a + 1] - s[a], s[b + 1] - s[b]
    tx = (p[a + 1, 0] - p[a, 0]) / one + (p[b + 1, 0] - p[b, 0]) / other
    ty = (p[a + 1, 1] - p[a, 1]) / one + (p[b + 1, 1] - p[b, 1]) / other
    return bool(tx * oy - ty * ox >= 0.0)


@compiled
def project(
    lines: Polylines, k: int, x: float, y: float, low: float, high: float
) -> tuple[float, float]:
    """Station of the point of polyline k nearest to (x, y) with low <= station <= high.

    Returns the station and the signed deviation [m], positive when (x, y) is left of the path.
    Of equally near points the one with the smaller station is taken. Next to a waypoint both its
    legs say where left is: outside of a turn of more than 90 degrees one of them alone may not.
    """
    first = lines.start[k]
    end = lines.station[lines.start[k + 1] - 1]
    low, high = min(max(low, 0.0), end), min(max(high, 0.0), end)
    best, station, deviation = np.inf, low, 0.0
    a = segment_at(lines, k, low)
    if a > first and lines.station[a] >= low:
        a -= 1
    while a < lines.start[k + 1] - 1 and lines.station[a] <= high:
        s0, s1 = lines.station[a], lines.station[a + 1]
        length = s1 - s0
        tx = (lines.points[a + 1, 0] - lines.points[a, 0]) / length
        ty = (lines.points[a + 1, 1] - lines.points[a, 1]) / length
        dx, dy = x - lines.points[a, 0], y - lines.points[a, 1]
        along = min(max(dx * tx + dy * ty, max(low - s0, 0.0)), min(high - s0, length))
        ox, oy = dx - along * tx, dy - along * ty
        gap = hypot(ox, oy)
        if gap < best:
            best = gap
            station = min(max(s0 + along, low), high)  # rounding must not leave the stretch
            left = tx * dy - ty * dx >= 0.0
            if along >= length and a + 2 < lines.start[k + 1]:
                left = left_of_both(lines, a, a + 1, ox, oy)
            elif along <= 0.0 and a > first:
                left = left_of_both(lines, a, a - 1, ox, oy)
            deviation = gap if left else -gap
        a += 1
    return station, deviation


@compiled
def track(
    lines: Polylines, k: int, x: float, y: float, previous: float, window: float
) -> tuple[float, float]:
    """Projection (3) that follows the robot: nearest point within ``window`` of the last station.

    ``window`` [m] counts along the path and must exceed what the robot can move between two
    calls. A path that passes near itself does not attract the projection to the other branch as
    long as the way there along the path is longer than the window.

    On the inside of a turn, ``d`` from both legs, the nearest point is 2 d tan(turn / 2) further on
    all at once: within what the robot moves the projection would stay on the first leg for good. So
    as much as that is looked at where it is more, for the sharpest turn of a road.
    """
    station, deviation = project(lines, k, x, y, previous - window, previous + window)
    wide = CORNER * abs(deviation)
    if wide > window:
        return project(lines, k, x, y, previous - wide, previous + wide)
    return station, deviation


@dataclass(frozen=True, init=False, eq=False)
class Path:
    """One polyline of waypoints with its arc length; it cannot be changed."""

    lines: Polylines
    outside: FloatArray
    """(M, 2) [m] stretches, from station to station, that lie outside the accessible area"""

    def __init__(
        self, points: Sequence[Sequence[float]] | FloatArray, outside: FloatArray | None = None
    ) -> None:
        """Waypoints (n, 2) [m] and stretches outside; the arrays kept are read-only."""
        object.__setattr__(self, "lines", locked(pack_polylines([points])))
        object.__setattr__(
            self, "outside", locked(np.zeros((0, 2)) if outside is None else outside)
        )

    @property
    def points(self) -> FloatArray:
        """(n, 2) [m] waypoints."""
        return self.lines.points

    @property
    def length(self) -> float:
        """[m]."""
        return path_length(self.lines, 0)

    def point(self, station: float) -> FloatArray:
        """(2,) [m] point at a station; the ends hold beyond them."""
        return np.array(point_at(self.lines, 0, station)[:2])

    def direction(self, station: float) -> FloatArray:
        """(2,) unit vector along the path at a station."""
        return np.array(point_at(self.lines, 0, station)[2:])

    def project(
        self, x: float, y: float, near: float | None = None, window: float = 2.0
    ) -> tuple[float, float]:
        """Station [m] of the nearest point and the signed deviation [m], left positive.

        With ``near``, only stations about it are looked at, as `track` does within ``window``.
        """
        if near is None:
            return project(self.lines, 0, x, y, 0.0, self.length)
        return track(self.lines, 0, x, y, near, window)

    def target(self, station: float, look_ahead: float) -> FloatArray:
        """(2,) [m] the point ``look_ahead`` further along, the last waypoint at most (3)."""
        return self.point(station + look_ahead)


SHORTEST_WINDOW = 1.0
"""[m] A projection may move at least this far along the path between two steps."""


def project_near(lines: Polylines, k: int, x: float, y: float, near: float) -> float:
    """Station [m] of the point of path k next to (x, y), by `track` from ``near`` on."""
    return float(track(lines, k, x, y, near, SHORTEST_WINDOW)[0])
