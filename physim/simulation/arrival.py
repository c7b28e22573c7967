"""Arrival, judged from the motion alone: at the stop station, and standing.

A robot has arrived at a sample when its station along its own path is at least the stop station
less the world's tolerance, and no sample of the last `STILL_TIME` shows it farther from where it is
than `still_distances`: 1 cm, less where the robot itself is small. Before that much time has passed
nobody has arrived. What a controller says of itself does not matter. A run is finished when all
have arrived.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled, direct
from physim.geometry.shapes import FloatArray, IntArray, read_only
from physim.geometry.tracking import Tracking, track_all

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


class Arrivals:
    """Judges the robots at every sample of a run, from sample 0 on.

    ``least`` (N,) [m] are the stations from which on they may have arrived, ``pose`` (N, 3) where
    they stand at sample 0, and ``near`` (N,) [m] their `still_distances`. Values handed out never
    change.
    """

    def __init__(self, least: FloatArray, near: FloatArray, dt: float, pose: FloatArray) -> None:
        self.least, self.near = least, near
        self.trail = np.zeros((still_steps(dt) + 1, len(least), 2))
        """(W + 1, N, 2) places of the last samples, sample k in row k % (W + 1)"""
        self.trail[0] = pose[:, :2]
        self.arrived: NDArray[np.bool_] = read_only(np.zeros(len(least), dtype=np.bool_))
        """(N,) who has arrived at the present sample"""
        self.all = False
        """whether all have"""
        self._follow_and_judge = direct(follow_and_judge)

    def follow(self, tracking: Tracking, step: int, pose: FloatArray) -> None:
        """Judge the sample after the last one, to which ``tracking`` follows."""
        stations, arrived = np.empty((3, len(pose))), np.empty(len(pose), np.bool_)
        self.all = self._follow_and_judge(
            *tracking.legs, tracking.last, pose, tracking.windows, tracking.stations, stations,
            step, self.least, self.near, self.trail, arrived,
        )  # fmt: skip
        tracking.stations, self.arrived = read_only(stations), read_only(arrived)

    def restore(self, trail: FloatArray, arrived: NDArray[np.bool_]) -> None:
        """Go to a sample whose ``trail`` and ``arrived`` are known; the trail is copied."""
        self.trail, self.arrived = trail.copy(), read_only(arrived)
        self.all = bool(arrived.all())


@compiled
def follow_and_judge(
    start: IntArray,
    row: FloatArray,
    last: IntArray,
    pose: FloatArray,
    windows: FloatArray,
    before: FloatArray,
    after: FloatArray,
    step: int,
    least: FloatArray,
    near: FloatArray,
    trail: FloatArray,
    arrived: NDArray[np.bool_],
) -> bool:
    """`track_all` and `note_arrivals` in one call, since every step makes both.

    ``start`` and ``row`` are those of the legs: one by one they are handed over in a third of the
    time.
    """
    track_all(start, row, last, pose, windows, before, after)
    return note_arrivals(step, pose, after[0], least, near, trail, arrived)


@compiled
def note_arrivals(
    step: int,
    pose: FloatArray,
    station: FloatArray,
    least: FloatArray,
    near: FloatArray,
    trail: FloatArray,
    arrived: NDArray[np.bool_],
) -> bool:
    """Judge the robots at ``pose`` (N, 3), sample ``step``, into ``arrived`` (N,): are all there?

    ``least`` (N,) [m] are the stations from which on they may have arrived, ``near`` (N,) [m] how
    far they may have moved. ``trail`` (W + 1, N, 2) holds the places of the last W + 1 samples,
    sample k in row k % (W + 1); this one is added.
    """
    length = len(trail)
    row = step % length
    everybody = True
    for i in range(len(pose)):
        x, y = pose[i, 0], pose[i, 1]
        trail[row, i, 0], trail[row, i, 1] = x, y
        still = station[i] >= least[i] and step + 1 >= length
        k = 1  # the oldest first: of a robot that moves it is the farthest
        while still and k < length:
            dx, dy = trail[(row + k) % length, i, 0] - x, trail[(row + k) % length, i, 1] - y
            still = dx * dx + dy * dy <= near[i] * near[i]
            k += 1
        arrived[i] = still
        everybody = everybody and still
    return everybody


def arrivals(
    pose: FloatArray, station: FloatArray, least: FloatArray, near: FloatArray, dt: float
) -> NDArray[np.bool_]:
    """(K, N) who has arrived at each of K consecutive samples from 0 on: `note_arrivals` in numpy.

    ``pose`` (K, N, 3), ``station`` (K, N) [m].
    """
    window = still_steps(dt)
    place = pose[:, :, :2]
    found = station >= least
    found[:window] = False
    for k in range(1, min(window + 1, len(pose))):
        apart = np.square(place[k:] - place[:-k]).sum(axis=2)
        found[k:] &= apart <= near * near
    return np.asarray(found)


def since(arrived: NDArray[np.bool_]) -> IntArray:
    """(N,) sample from which on each robot has arrived to the end of (K, N); -1 where it has not.

    One that moves on has not arrived: its last stretch counts.
    """
    samples = len(arrived)
    away = np.where(~arrived, np.arange(samples)[:, None], -1).max(axis=0, initial=-1)
    return np.where(away + 1 < samples, away + 1, -1)
