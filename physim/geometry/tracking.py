"""Stations of many robots, followed from step to step along their own paths and along s*.

What `physim.geometry.path.track` finds, to the last bit, and faster:
what does not change from step to step is worked out once, the search for a segment begins where the
last one ended, and a segment that is plainly farther than another is left alone.
"""

from __future__ import annotations

from math import hypot
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.path import CORNER, SHORTEST_WINDOW
from physim.geometry.shapes import FloatArray, IntArray, Polylines, joined_polylines, read_only

MORE = 1.0 + 1e-9
"""[-] A square larger by this is one of a larger distance, whatever rounding does to both."""
TINY = 1e-290
"""[m^2] below which squares are no longer known to a share of themselves"""


class Legs(NamedTuple):
    """Segments of polylines, each with what its projections need."""

    start: IntArray
    """(K + 1,) polyline k has the rows ``start[k]:start[k + 1]``, the last of which is its end"""
    row: FloatArray
    """(V, 6) x, y [m] of the first point, unit direction tx, ty, station [m] and length [m]"""


def legs_of(lines: Polylines) -> Legs:
    """Segments of polylines; the row of a last point has its place and station alone."""
    row = np.zeros((len(lines.points), 6))
    row[:, :2], row[:, 4] = lines.points, lines.station
    inner = np.ones(len(row), dtype=np.bool_)
    inner[lines.start[1:] - 1] = False
    (a,) = inner.nonzero()
    row[a, 5] = lines.station[a + 1] - lines.station[a]
    row[a, 2:4] = (lines.points[a + 1] - lines.points[a]) / row[a, 5, None]
    return Legs(lines.start, row)


class Tracking:
    """Stations of N robots along the way, from their start poses (N, 3) on.

    ``radius`` (N,) [m] are the circumscribed radii. At the start the nearest point of the whole
    path is taken. What was handed out never changes: every sample has arrays of its own.
    """

    def __init__(
        self, paths: Polylines, reference: Polylines, radius: FloatArray, start: FloatArray
    ) -> None:
        self.legs = legs_of(joined_polylines(paths, reference))
        """of the N own paths, s* behind them"""
        self.windows = np.maximum(SHORTEST_WINDOW, 2.0 * radius)
        robots = len(start)
        self.last = np.stack((self.legs.start[:robots], np.full(robots, self.legs.start[robots])))
        """(2, N) the rows of ``legs`` at which the last searches ended: no result depends on it"""
        everywhere, nowhere = np.full(len(start), np.inf), read_only(np.zeros((3, len(start))))
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
        track_course(*self.legs, self.last, poses, self.windows, self.stations, found)
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
        track_all(*self.legs, self.last, pose, windows, before, after)
        return read_only(after)


@compiled
def track_leg(
    row: FloatArray, first: int, end: int, near: int, x: float, y: float, low: float, high: float
) -> tuple[float, float, float, bool, int]:
    """`project` of (x, y) on the polyline of the rows ``first`` to ``end``, in parts.

    Station, the two coordinates of the way from there to (x, y), whether that is to the left, and
    the segment that holds ``low``, the search for which begins at row ``near``.
    """
    length = row[end, 4]
    low, high = min(max(low, 0.0), length), min(max(high, 0.0), length)
    best, station, bx, by, left = np.inf, low, np.inf, 0.0, True
    a = near
    while a < end - 1 and row[a + 1, 4] <= low:
        a += 1
    while a > first and row[a, 4] > low:
        a -= 1
    near = a
    if a > first and row[a, 4] >= low:
        a -= 1
    while a < end and row[a, 4] <= high:
        s0, tx, ty = row[a, 4], row[a, 2], row[a, 3]
        dx, dy = x - row[a, 0], y - row[a, 1]
        along = min(max(dx * tx + dy * ty, max(low - s0, 0.0)), min(high - s0, row[a, 5]))
        ox, oy = dx - along * tx, dy - along * ty
        square = ox * ox + oy * oy
        if square * MORE + TINY < best or (
            square <= best * MORE + TINY and hypot(ox, oy) < hypot(bx, by)
        ):
            best, bx, by, left = square, ox, oy, tx * dy - ty * dx >= 0.0
            if along >= row[a, 5] and a + 1 < end:
                left = (tx + row[a + 1, 2]) * oy - (ty + row[a + 1, 3]) * ox >= 0.0
            elif along <= 0.0 and a > first:
                left = (tx + row[a - 1, 2]) * oy - (ty + row[a - 1, 3]) * ox >= 0.0
            station = min(max(s0 + along, low), high)
        a += 1
    return station, bx, by, left, near


@compiled
def track_line(
    row: FloatArray,
    first: int,
    end: int,
    near: int,
    x: float,
    y: float,
    before: float,
    window: float,
) -> tuple[float, float, bool, int]:
    """`track` on the polyline of the rows ``first`` to ``end``: station, distance, whether left.

    And the segment at which the next search begins.
    """
    low, high = before - window, before + window
    station, ox, oy, left, near = track_leg(row, first, end, near, x, y, low, high)
    gap = hypot(ox, oy)
    wide = CORNER * gap
    if wide <= window:
        return station, gap, left, near
    goes_on = near > first and before - wide < row[near, 4]
    goes_on = goes_on or (near + 1 < end and before + wide > row[near + 1, 4])
    if goes_on or not low < station < high:  # else all that is looked at is one segment, and known
        low, high = before - wide, before + wide
        station, ox, oy, left, near = track_leg(row, first, end, near, x, y, low, high)
        gap = hypot(ox, oy)
    return station, gap, left, near


@compiled
def track_all(
    start: IntArray,
    row: FloatArray,
    last: IntArray,
    pose: FloatArray,
    windows: FloatArray,
    before: FloatArray,
    after: FloatArray,
) -> None:
    """Move every robot's projections on its own path and on s* along with its pose.

    ``start`` and ``row`` are `Legs` of the N own paths and s*; ``before`` and ``after`` (3, N):
    station, deviation, reference station. ``last`` (2, N) rows are where searches begin and end.
    """
    robots = len(pose)
    for i in range(robots):
        x, y, window = pose[i, 0], pose[i, 1], windows[i]
        after[0, i], gap, left, last[0, i] = track_line(
            row, start[i], start[i + 1] - 1, last[0, i], x, y, before[0, i], window
        )
        after[1, i] = gap if left else -gap
        after[2, i], _, _, last[1, i] = track_line(
            row, start[robots], start[robots + 1] - 1, last[1, i], x, y, before[2, i], window
        )


@compiled
def track_course(
    start: IntArray,
    row: FloatArray,
    last: IntArray,
    poses: FloatArray,
    windows: FloatArray,
    before: FloatArray,
    out: FloatArray,
) -> None:
    """Run `track_all` over poses (K, N, 3), one after the other; ``out`` (K, 3, N) takes all."""
    for k in range(len(poses)):
        if k == 0:
            track_all(start, row, last, poses[k], windows, before, out[k])
        else:
            track_all(start, row, last, poses[k], windows, out[k - 1], out[k])
