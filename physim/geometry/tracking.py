"""Projections (3) of all robots on their own paths and on s*, followed from step to step.

A projection looks at most a window along the path: two circumscribed radii of the robot, at least
1 m. That is more than a robot moves in a step, and less than the way between two branches of a
path that passes near itself.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.path import track
from physim.geometry.shapes import FloatArray, Polylines

SHORTEST_WINDOW = 1.0
"""[m] A projection may move at least this far along the path between two steps."""


class Tracking:
    """Stations of N robots along the way, from their start poses (N, 3) on.

    ``radius`` (N,) [m] are the circumscribed radii. At the start the nearest point of the whole
    path is taken.
    """

    def __init__(
        self, paths: Polylines, reference: Polylines, radius: FloatArray, start: FloatArray
    ) -> None:
        n = len(start)
        self._paths, self._reference = paths, reference
        self._windows = np.maximum(SHORTEST_WINDOW, 2.0 * radius)
        self.station = np.zeros(n)
        """(N,) [m] along the own path"""
        self.deviation = np.zeros(n)
        """(N,) [m] from the own path, left positive"""
        self.reference_station = np.zeros(n)
        """(N,) [m] along s*"""
        self._project(start, np.full(n, np.inf))

    def follow(self, pose: FloatArray) -> None:
        """Follow the robots to their poses (N, 3) one step later."""
        self._project(pose, self._windows)

    def course(self, poses: FloatArray) -> FloatArray:
        """Follow the robots over poses (K, N, 3) of consecutive steps.

        Returns (K, N, 3): station, deviation and reference station [m] at each.
        """
        found = np.empty(poses.shape)
        track_course(
            self._paths, self._reference, poses, self._windows,
            self.station, self.deviation, self.reference_station, found,
        )  # fmt: skip
        return found

    def _project(self, pose: FloatArray, windows: FloatArray) -> None:
        track_all(
            self._paths, self._reference, pose, windows,
            self.station, self.deviation, self.reference_station,
        )  # fmt: skip


@compiled
def track_all(
    paths: Polylines,
    reference: Polylines,
    pose: FloatArray,
    windows: FloatArray,
    station: FloatArray,
    deviation: FloatArray,
    reference_station: FloatArray,
) -> None:
    """Move every robot's projections on its own path and on s* along with its pose, in place."""
    for i in range(len(pose)):
        x, y = pose[i, 0], pose[i, 1]
        station[i], deviation[i] = track(paths, i, x, y, station[i], windows[i])
        reference_station[i], _ = track(reference, 0, x, y, reference_station[i], windows[i])


@compiled
def track_course(
    paths: Polylines,
    reference: Polylines,
    poses: FloatArray,
    windows: FloatArray,
    station: FloatArray,
    deviation: FloatArray,
    reference_station: FloatArray,
    out: FloatArray,
) -> None:
    """Run `track_all` over poses (K, N, 3), one after the other; ``out`` (K, N, 3) takes all."""
    for k in range(len(poses)):
        track_all(paths, reference, poses[k], windows, station, deviation, reference_station)
        out[k, :, 0] = station
        out[k, :, 1] = deviation
        out[k, :, 2] = reference_station
