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
from math import tan

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import (
    FloatArray,
    IntArray,
    Polylines,
    Rows3,
    locked,
    pack_polylines,
    read_only,
)

SHARPEST_TURN = 2.6
"""[rad] Beyond this (150 degrees) a mitred corner of a road would reach four half-widths out."""
CORNER = 2.0 * tan(0.5 * SHARPEST_TURN)
"""[-] way along a path over the distance from it, between the two points nearest to a robot on the
inside of its sharpest turn"""
SHORTEST_WINDOW = 1.0
"""[m] A projection may move at least this far along the path between two steps."""
MORE = 1.0 + 1e-9
"""[-] A square larger by this is one of a larger distance, whatever rounding does to both."""
TINY = 1e-290
"""[m^2] below which squares are no longer known to a share of themselves"""


@compiled
def path_length(lines: Polylines, k: int) -> float:
    """Length [m] of polyline k."""
    return float(lines.row[lines.start[k + 1] - 1, 4])


@compiled
def segment_at(lines: Polylines, k: int, station: float, near: int) -> int:
    """Row of the segment of polyline k that holds a station (clamped), sought from row ``near``.

    A row that does not belong to it stands for its first.
    """
    row, first, last = lines.row, lines.start[k], lines.start[k + 1] - 2
    a = near if first <= near <= last else first
    while a < last and row[a + 1, 4] <= station:
        a += 1
    while a > first and row[a, 4] > station:
        a -= 1
    return int(a)


@compiled
def point_at(lines: Polylines, k: int, station: float) -> tuple[float, float, float, float]:
    """Point at a station of polyline k and the unit direction there: x, y, tx, ty (2).

    Before the first waypoint it is the first, past the last it is the last.
    """
    row, low, high = lines.row, lines.start[k], lines.start[k + 1] - 2
    while low < high:
        middle = (low + high + 1) // 2
        if row[middle, 4] <= station:
            low = middle
        else:
            high = middle - 1
    tx, ty = row[low, 2], row[low, 3]
    along = min(max(station - row[low, 4], 0.0), row[low, 5])
    return row[low, 0] + along * tx, row[low, 1] + along * ty, tx, ty


@compiled
def project(
    lines: Polylines, k: int, x: float, y: float, low: float, high: float, near: int = 0
) -> tuple[float, float, int]:
    """Station of the point of polyline k nearest to (x, y) with low <= station <= high.

    Returns the station, the signed deviation [m], positive when (x, y) is left of the path, and the
    row of the segment that holds ``low``, sought from row ``near`` on. Of equally near points the
    one with the smaller station is taken. Next to a waypoint both its legs say where left is:
    outside of a turn of more than 90 degrees one of them alone may not.
    """
    row, first, end = lines.row, lines.start[k], lines.start[k + 1] - 1
    low, high = min(max(low, 0.0), row[end, 4]), min(max(high, 0.0), row[end, 4])
    best, station, bx, by, is_left = np.inf, low, np.inf, 0.0, True
    near = segment_at(lines, k, low, near)
    a = near
    if a > first and row[a, 4] >= low:
        a -= 1
    while a < end and row[a, 4] <= high:
        tx, ty, s0, length = row[a, 2], row[a, 3], row[a, 4], row[a, 5]
        dx, dy = x - row[a, 0], y - row[a, 1]
        along = min(max(dx * tx + dy * ty, max(low - s0, 0.0)), min(high - s0, length))
        ox, oy = dx - along * tx, dy - along * ty
        square = ox * ox + oy * oy
        if square * MORE + TINY < best or (  # plainly nearer; else the distances themselves decide
            square <= best * MORE + TINY and np.hypot(ox, oy) < np.hypot(bx, by)
        ):
            best, bx, by, is_left = square, ox, oy, tx * dy - ty * dx >= 0.0
            station = min(max(s0 + along, low), high)  # rounding must not leave the stretch
            if along >= length and a + 1 < end:
                is_left = (tx + row[a + 1, 2]) * oy - (ty + row[a + 1, 3]) * ox >= 0.0
            elif along <= 0.0 and a > first:
                is_left = (tx + row[a - 1, 2]) * oy - (ty + row[a - 1, 3]) * ox >= 0.0
        a += 1
    gap = np.hypot(bx, by)
    return station, gap if is_left else -gap, near


@compiled
def track(
    lines: Polylines, k: int, x: float, y: float, previous: float, window: float, near: int = 0
) -> tuple[float, float, int]:
    """Projection (3) that follows the robot: nearest point within ``window`` of the last station.

    What `project` returns; the search begins at row ``near``. ``window`` [m] counts along the path
    and must exceed what the robot can move between two calls. A path that passes near itself does
    not attract the projection to the other branch as long as the way there along the path is longer
    than the window.

    On the inside of a turn, ``d`` from both legs, the nearest point is 2 d tan(turn / 2) further on
    all at once: within what the robot moves the projection would stay on the first leg for good. So
    as much as that is looked at where it is more, for the sharpest turn of a road.
    """
    goes_on = False
    low, high = previous - window, previous + window
    station, deviation, near = project(lines, k, x, y, low, high, near)
    wide = CORNER * abs(deviation)
    if wide > window:
        row, first, last = lines.row, lines.start[k], lines.start[k + 1] - 2
        if near > first and previous - wide < row[near, 4]:
            goes_on = True
        if near < last and previous + wide > row[near + 1, 4]:
            goes_on = True
        if goes_on or not low < station < high:  # else all of it is one segment, and known
            return project(lines, k, x, y, previous - wide, previous + wide, near)
    return station, deviation, near


@compiled
def put_projected(lines: Polylines, pose: Rows3, first: int, end: int, station: FloatArray) -> None:
    """Write the stations (n,) [m] on the first polyline of the points of it next to bodies at
    ``pose`` (n, 3), of those from ``first`` to ``end`` - 1."""
    for i in range(first, end):
        station[i], _, _ = project(lines, 0, pose[i, 0], pose[i, 1], -np.inf, np.inf)


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
            return project(self.lines, 0, x, y, 0.0, self.length)[:2]
        return track(self.lines, 0, x, y, near, window)[:2]

    def target(self, station: float, look_ahead: float) -> FloatArray:
        """(2,) [m] the point ``look_ahead`` further along, the last waypoint at most (3)."""
        return self.point(station + look_ahead)


class Tracking:
    """Stations of N robots along the way, from their start poses (N, 3) on.

    ``radius`` (N,) [m] are the circumscribed radii. At the start the nearest point of the whole
    path is taken. What was handed out never changes: every sample has arrays of its own.
    """

    def __init__(
        self, paths: Polylines, reference: Polylines, radius: FloatArray, start: FloatArray
    ) -> None:
        starts: IntArray = np.concatenate((paths.start, reference.start[1:] + paths.start[-1]))
        self.lines = Polylines(starts, np.concatenate((paths.row, reference.row)))
        """the N own paths, s* behind them"""
        self.windows = np.maximum(SHORTEST_WINDOW, 2.0 * radius)
        robots = len(start)
        self.last = np.zeros((2, robots), dtype=np.int64)
        """(2, N) the rows of ``lines`` at which the last searches ended: no result depends on it"""
        everywhere, nowhere = np.full(robots, np.inf), read_only(np.zeros((3, robots)))
        self.stations: FloatArray = self._projected(start, everywhere, nowhere)
        """(3, N) [m] station on the own path, deviation from it (left positive), station on s*"""

    @property
    def station(self) -> FloatArray:
        """(N,) [m] along the own path."""
        return np.asarray(self.stations[0])

    @property
    def deviation(self) -> FloatArray:
        """(N,) [m] from the own path, left positive."""
        return np.asarray(self.stations[1])

    @property
    def reference_station(self) -> FloatArray:
        """(N,) [m] along s*."""
        return np.asarray(self.stations[2])

    def follow(self, pose: FloatArray) -> None:
        """Follow the robots to their poses (N, 3) one step later."""
        self.stations = self._projected(pose, self.windows, self.stations)

    def course(self, poses: FloatArray) -> FloatArray:
        """Follow the robots over poses (K, N, 3) of consecutive steps.

        Returns (K, N, 3): station, deviation and reference station [m] at each.
        """
        found = np.empty((len(poses), *self.stations.shape))
        robots = len(self.windows)
        track_course(
            self.lines, robots, self.last.reshape(-1), poses.reshape(-1, 3), len(poses),
            self.windows, self.stations.reshape(-1), found.reshape(-1),
        )  # fmt: skip
        if len(found):
            self.stations = read_only(found[-1].copy())
        return found.transpose(0, 2, 1)

    def seek(self, pose: FloatArray, before: FloatArray, ways: FloatArray) -> None:
        """Follow the robots to their poses (N, 3) from stations ``before`` (3, N), some steps ago.

        ``ways`` (N,) [m] is how far they went at most since then: as far again is looked to either
        side.
        """
        self.stations = self._projected(pose, self.windows + 2.0 * ways, before)

    def _projected(self, pose: FloatArray, windows: FloatArray, before: FloatArray) -> FloatArray:
        after = np.empty(before.shape)
        track_all(
            self.lines, len(pose), self.last.reshape(-1), pose, windows, before.reshape(-1),
            after.reshape(-1),
        )  # fmt: skip
        return read_only(after)


@compiled
def track_all(
    lines: Polylines,
    robots: int,
    last: IntArray,
    pose: Rows3,
    windows: FloatArray,
    before: FloatArray,
    after: FloatArray,
) -> None:
    """Move every robot's projections on its own path and on s* along with its pose.

    ``lines`` are the N own paths and s*; ``before`` and ``after`` (3 N,): N stations, deviations,
    reference stations. ``last`` (2 N,) rows are where searches begin and end.
    """
    far = 2 * robots
    for i in range(robots):
        x, y, window = pose[i, 0], pose[i, 1], windows[i]
        after[i], after[robots + i], last[i] = track(lines, i, x, y, before[i], window, last[i])
        after[far + i], _, last[robots + i] = track(
            lines, robots, x, y, before[far + i], window, last[robots + i]
        )


@compiled
def track_course(
    lines: Polylines,
    robots: int,
    last: IntArray,
    poses: Rows3,
    many: int,
    windows: FloatArray,
    before: FloatArray,
    out: FloatArray,
) -> None:
    """Run `track_all` over ``many`` poses of all, (K N, 3); ``out`` (3 N K,) takes its results."""
    for k in range(many):
        found = out[3 * robots * k :]
        earlier = before if k == 0 else out[3 * robots * (k - 1) :]
        track_all(lines, robots, last, poses[robots * k :], windows, earlier, found)
