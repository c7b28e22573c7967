"""The formation as it will be measured: where robots are along the reference path at their stops.

A run follows the station of a robot along the reference path from step to step, from the nearest
point of all at the start. Where paths come back beside themselves, end elsewhere or leave out a
part of the reference path, what is measured at the stops may be far from what is wanted there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from physim.geometry.shapes import FloatArray, pack_polylines
from physim.geometry.tracking import Tracking

STEP = 0.25
"""[m] from place to place, of which a projection looks as far as a metre"""
MOST_PLACES = 20_000_000
"""Places of all robots that are followed: seconds"""
AT_ONCE = 500_000
"""of them at a time, which bounds memory"""
MOST_SETTLING = 1_000
"""Steps that robots stand at their stops at most"""
MOST_OFF = 0.05
"""[-] share of the reference path that the formation error at the stops may be, untold: that of
lanes beside bends is less"""


def measured(
    paths: list[FloatArray],
    reference: FloatArray,
    start: FloatArray,
    radius: FloatArray,
    stops: FloatArray,
) -> tuple[FloatArray, FloatArray] | None:
    """Stations (N,) [m] on ``reference`` (n, 2) at which robots are measured at their stops.

    And how far (N,) [m] each comes back along it on its way at most. The robots are those of
    `Drive`. None where the ways are too long to be followed.
    """
    drive = Drive.of(paths, reference, start, radius, stops, MOST_PLACES)
    if drive is None:
        return None
    foremost, back = drive.tracking.reference_station, np.zeros(len(paths))
    at_last = np.zeros((1, len(paths), 3))
    for poses, course in drive.blocks():
        at_last = poses[-1:]
        ahead = np.maximum.accumulate(np.concatenate([foremost[None], course]))
        back = np.maximum(back, (ahead[1:] - course).max(axis=0))
        foremost = ahead[-1]
    for _ in range(MOST_SETTLING):  # a projection moves on while its robot stands
        before = drive.tracking.reference_station
        drive.tracking.course(at_last)
        if np.array_equal(before, drive.tracking.reference_station):
            break
    return drive.tracking.reference_station, back


@dataclass(frozen=True)
class Drive:
    """N robots, each along its own path (n, 2) [m] from its start to its stop, alone.

    All are at the same share of their ways at a time, and their stations on the reference path are
    followed as in a run.
    """

    tracking: Tracking
    lines: list[tuple[FloatArray, FloatArray]]
    """stations and points of each path"""
    begin: FloatArray
    """(N,) [m] stations on their own paths at the start"""
    end: FloatArray
    """(N,) [m] at the stop"""
    beside: FloatArray
    """(N, 2) [m] from the path to the start"""
    count: int
    """places of each robot, `STEP` apart or nearer"""

    @classmethod
    def of(
        cls,
        paths: list[FloatArray],
        reference: FloatArray,
        start: FloatArray,
        radius: FloatArray,
        stops: FloatArray,
        most: int,
    ) -> Drive | None:
        """From poses ``start`` (N, 3) [m, rad] to the stations ``stops`` (N,) [m].

        ``radius`` (N,) [m] are the circumscribed ones. None where that takes more than ``most``
        places in all.
        """
        if float(stops.max()) / STEP * len(paths) > most:
            return None  # before so much is packed
        packed = pack_polylines(paths)
        tracking = Tracking(packed, pack_polylines([reference]), radius, start)
        own = np.split(packed.station, packed.start[1:-1])
        lines = list(zip(own, paths, strict=True))
        begin = tracking.station
        end = np.maximum(stops, begin)
        beside = start[:, :2] - _places(lines, begin[None])[0]
        farthest = max(float((end - begin).max()), float(np.hypot(*beside.T).max()))
        count = int(np.ceil(farthest / STEP)) + 1
        if count * len(paths) > most:
            return None
        return cls(tracking, lines, begin, end, beside, count)

    def blocks(self) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Poses (K, N, 3), without headings, of some places on, and stations (K, N) [m] on s*."""
        block = max(1, AT_ONCE // len(self.lines))
        away = np.hypot(*self.beside.T)
        for first in range(0, self.count, block):
            step = np.arange(first, min(first + block, self.count))[:, None] + 1
            places = _places(self.lines, self.begin + step / self.count * (self.end - self.begin))
            left = np.maximum(1.0 - step * STEP / np.maximum(away, STEP), 0.0)  # until on its path
            poses = np.zeros((*places.shape[:2], 3))
            poses[:, :, :2] = places + left[..., None] * self.beside
            yield poses, self.tracking.course(poses)[:, :, 2]


def _places(lines: list[tuple[FloatArray, FloatArray]], at: FloatArray) -> FloatArray:
    """Places (K, N, 2) [m] of paths, each with its stations, at stations (K, N) [m]."""
    return np.stack(
        [
            np.stack([np.interp(some, own, path[:, k]) for k in (0, 1)], axis=-1)
            for (own, path), some in zip(lines, at.T, strict=True)
        ],
        axis=1,
    )
