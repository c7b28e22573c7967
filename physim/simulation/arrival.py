"""Arrival, judged from the motion alone: at the stop, and standing.

A robot has arrived at a sample when its reference point is within the world's tolerance of its stop
along its path, before or past it, and no farther beside it than at its start or half its width,
whichever is more, and when no sample of the last `STILL_TIME` shows it farther from where it is
than `still_distances`: 1 cm, less where the robot itself is small. Before that much time has passed
nobody has arrived. What a controller says of itself does not matter. One that is pushed away has
not arrived any more. A run is finished when all have arrived at one sample.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.geometry.path import Tracking, track_all
from physim.geometry.shapes import (
    Flags,
    FloatArray,
    IntArray,
    Polylines,
    Rows2,
    Rows3,
    Rows4,
    Shapes,
    read_only,
)
from physim.tolerances import LENGTH

if TYPE_CHECKING:
    from physim.world.scene import Scene

STILL_TIME = 0.5
"""[s]"""
STILL_DISTANCE = 0.01
"""[m] that a robot which stands may have moved, at most"""
STILL_SHARE = 0.05
"""of its radius, where that is less: a robot of 3 cm drives at 1 cm/s"""


def still_distances(radius: FloatArray) -> FloatArray:
    """(N,) [m] that robots which stand may have moved; ``radius`` (N,) [m] of the footprints."""
    return np.minimum(STILL_DISTANCE, STILL_SHARE * radius)


def still_steps(dt: float) -> int:
    """Steps that make up `STILL_TIME`, rounded up."""
    return int(np.ceil(STILL_TIME / dt - 1e-9))


def most_beside(shapes: Shapes, deviation: FloatArray) -> FloatArray:
    """(N,) [m] that robots which arrive may be beside their stops.

    ``shapes`` begin with the N footprints; ``deviation`` (N,) [m] from their paths at the start.
    """
    y, first = shapes.vertices[:, 1], shapes.part_start[shapes.body_start[:-1]]
    width = np.maximum.reduceat(y, first) - np.minimum.reduceat(y, first)
    width = width[: len(deviation)]
    return np.maximum(np.abs(deviation), 0.5 * width)


class Arrivals:
    """Judges the robots at every sample of a run, from sample 0 on.

    ``tracking`` is at the start of the run. Values handed out never change.
    """

    def __init__(self, scene: Scene, tracking: Tracking) -> None:
        stop, tolerance = scene.stop_station, scene.arrival_tolerance
        beside = most_beside(scene.shapes, tracking.deviation) + LENGTH
        near = still_distances(scene.shapes.radius[: scene.robots])
        bounds = stop - tolerance, stop + tolerance, beside**2, near**2
        self.bounds = np.stack(bounds, axis=1)
        """(N, 4) least and greatest station [m], squares of how far beside and how far moved"""
        self.lines = tracking.lines
        self.trail = np.zeros((still_steps(scene.dt) + 1, scene.robots, 2))
        """(W + 1, N, 2) places of the last samples, sample k in row k % (W + 1)"""
        self.trail[0] = scene.start[:, :2]
        self.arrived: NDArray[np.bool_] = read_only(np.zeros(scene.robots, dtype=np.bool_))
        """(N,) who has arrived at the present sample"""
        self.all = False
        """whether all have"""

    def follow(self, tracking: Tracking, step: int, pose: FloatArray) -> None:
        """Judge the sample after the last one, to which ``tracking`` follows; robots stand first in
        ``pose``."""
        robots = len(self.arrived)
        stations, arrived = np.empty((3, robots)), np.empty(robots, np.bool_)
        self.all = judge_arrivals(
            self.lines, robots, tracking.last.reshape(-1), pose, tracking.windows,
            tracking.stations.reshape(-1), stations.reshape(-1), step, self.bounds,
            self.trail.reshape(-1, 2), len(self.trail), arrived,
        )  # fmt: skip
        tracking.stations, self.arrived = read_only(stations), read_only(arrived)

    def restore(self, trail: FloatArray, arrived: NDArray[np.bool_]) -> None:
        """Go to a sample whose ``trail`` and ``arrived`` are known; the trail is copied."""
        self.trail, self.arrived = trail.copy(), read_only(arrived)
        self.all = bool(arrived.all())


@compiled
def judge_arrivals(
    lines: Polylines,
    robots: int,
    last: IntArray,
    pose: Rows3,
    windows: FloatArray,
    before: FloatArray,
    stations: FloatArray,
    step: int,
    bounds: Rows4,
    trail: Rows2,
    length: int,
    arrived: Flags,
) -> bool:
    """Follow the robots to ``pose`` (N, 3), sample ``step``, by `track_all`: are all there?

    Writes ``stations`` (3 N,) and who has ``arrived`` (N,). Stations end with the path: past that
    the path goes straight on. This sample is added to ``trail`` of so many samples; it and
    ``bounds`` are those of `Arrivals`.
    """
    track_all(lines, robots, last, pose, windows, before, stations)
    row, now, everybody = lines.row, step % length, True
    for i in range(robots):
        x, y = pose[i, 0], pose[i, 1]
        trail[robots * now + i, 0], trail[robots * now + i, 1] = x, y
        along, beside = stations[i], stations[robots + i]
        end, past = lines.start[i + 1] - 1, 0.0
        if along >= row[end, 4] - LENGTH:
            past = (x - row[end, 0]) * row[end - 1, 2] + (y - row[end, 1]) * row[end - 1, 3]
            past = max(past, 0.0)
        still = bounds[i, 0] <= along + past <= bounds[i, 1] and step + 1 >= length
        still = still and beside * beside - past * past <= bounds[i, 2]
        k = 1  # the oldest first: of a robot that moves it is the farthest
        while still and k < length:
            then = robots * ((now + k) % length) + i
            dx, dy = trail[then, 0] - x, trail[then, 1] - y
            still = dx * dx + dy * dy <= bounds[i, 3]
            k += 1
        arrived[i] = still
        everybody = everybody and still
    return everybody


def later_since(before: IntArray, first: int, arrived: NDArray[np.bool_]) -> IntArray:
    """(N,) sample from which on each robot has arrived to the end of a block; -1 where it has not.

    The block ``arrived`` (B, N) begins at sample ``first``, and ``before`` (N,) is the same for
    what comes before it. One that moves on has not arrived: its last stretch counts.
    """
    size = len(arrived)
    away = np.where(~arrived, np.arange(size)[:, None], -1).max(axis=0, initial=-1)
    found = np.where(away + 1 < size, first + away + 1, -1)
    return np.where((away < 0) & (before >= 0), before, found)
