"""Projections (3) of all robots on their own paths and on s*, followed from step to step.

A projection looks at most a window along the path: two circumscribed radii of the robot, at least
1 m. That is more than a robot moves in a step, and less than the way between two branches of a
path that passes near itself.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.path import track
from physim.geometry.shapes import FloatArray, Polylines, joined_polylines, read_only

SHORTEST_WINDOW = 1.0
"""[m] A projection may move at least this far along the path between two steps."""


class Tracking:
    """Stations of N robots along the way, from their start poses (N, 3) on.

    ``radius`` (N,) [m] are the circumscribed radii. At the start the nearest point of the whole
    path is taken. What was handed out never changes: every sample has arrays of its own.
    """

    def __init__(
        self, paths: Polylines, reference: Polylines, radius: FloatArray, start: FloatArray
    ) -> None:
        self.ways = joined_polylines(paths, reference)
        """the N own paths, s* behind them"""
        self.windows = np.maximum(SHORTEST_WINDOW, 2.0 * radius)
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
        track_course(self.ways, poses, self.windows, self.stations, found)
        if len(found):
            self.stations = read_only(found[-1].copy())
        return found.transpose(0, 2, 1)

    def _projected(self, pose: FloatArray, windows: FloatArray, before: FloatArray) -> FloatArray:
        after = np.empty(before.shape)
        track_all(self.ways, pose, windows, before, after)
        return read_only(after)


@compiled
def track_all(
    ways: Polylines, pose: FloatArray, windows: FloatArray, before: FloatArray, after: FloatArray
) -> None:
    """Move every robot's projections on its own path and on s* along with its pose.

    ``ways`` are the N own paths and s*; ``before`` and ``after`` (3, N): station, deviation,
    reference station.
    """
    robots = len(pose)
    for i in range(robots):
        x, y = pose[i, 0], pose[i, 1]
        after[0, i], after[1, i] = track(ways, i, x, y, before[0, i], windows[i])
        after[2, i], _ = track(ways, robots, x, y, before[2, i], windows[i])


@compiled
def track_course(
    ways: Polylines, poses: FloatArray, windows: FloatArray, before: FloatArray, out: FloatArray
) -> None:
    """Run `track_all` over poses (K, N, 3), one after the other; ``out`` (K, 3, N) takes all."""
    for k in range(len(poses)):
        if k == 0:
            track_all(ways, poses[k], windows, before, out[k])
        else:
            track_all(ways, poses[k], windows, out[k - 1], out[k])


def project_near(lines: Polylines, k: int, x: float, y: float, near: float) -> float:
    """Station [m] of the point of path k next to (x, y), within `SHORTEST_WINDOW` of ``near``."""
    return float(track(lines, k, x, y, near, SHORTEST_WINDOW)[0])
