"""Where bodies on timed paths are: a closed form of time.

Between two waypoints the twist is constant in the body's frame: a straight line where the heading
stays, an arc where it turns. Before the first time a body stands at its first waypoint.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from physim.compiled import compiled
from physim.geometry.motion import chord_factor
from physim.geometry.shapes import FloatArray, IntArray, Rows3, Rows7
from physim.tolerances import LENGTH

ONCE, LOOP, TO_AND_FRO = range(3)
REPEATS = ("once", "loop", "to_and_fro")
"""What follows the last waypoint, by these numbers"""


class TimedPaths(NamedTuple):
    """Timed paths of M bodies, each a run of rows, one a waypoint."""

    start: IntArray
    """(M + 1,) path m has the rows ``start[m]:start[m + 1]``"""
    row: Rows7
    """(V, 7) time [s], x, y [m] and heading [rad] of each waypoint, and of the way that begins
    there: speed [m/s], direction of the velocity at its beginning [rad], omega [rad/s]; 0 at last
    waypoints"""
    repeat: IntArray
    """(M,) number in `REPEATS`"""
    many: int
    """M"""


def timed_paths(
    poses: Sequence[ArrayLike], times: Sequence[ArrayLike], repeat: Sequence[str]
) -> TimedPaths:
    """Pack paths: ``poses`` (n, 3) [m, m, rad] and increasing ``times`` (n,) [s] of each."""
    start, rows = [0], [np.zeros((0, 7))]
    for pose, time in zip(poses, times, strict=True):
        row = np.zeros((len(np.asarray(pose)), 7))
        row[:, 0], row[:, 1:4] = time, pose
        lasts, (dx, dy, turn) = np.diff(row[:, 0]), np.diff(row[:, 1:4], axis=0).T
        chord = np.array([chord_factor(0.5 * one) for one in turn.tolist()])
        way = np.hypot(dx, dy)
        row[:-1, 4] = np.where(way > LENGTH, way, 0.0) / (chord * lasts)
        row[:-1, 5] = np.arctan2(dy, dx) - 0.5 * turn
        row[:-1, 6] = turn / lasts
        rows.append(row)
        start.append(start[-1] + len(row))
    numbers = np.array([REPEATS.index(one) for one in repeat], dtype=np.int64)
    return TimedPaths(np.array(start), np.concatenate(rows), numbers, len(numbers))


@compiled
def put_path_velocities(
    paths: TimedPaths, time: float, which: IntArray, pose: Rows3, dt: float, velocity: Rows3
) -> None:
    """Write the velocities (N, 3) that bring bodies ``which`` (M,) to where they are at ``time``.

    They are at ``pose`` (N, 3) a step of ``dt`` [s] before: vx, vy [m/s], omega [rad/s].
    """
    there = np.empty((paths.many, 3))
    put_timed_poses(paths, time, there)
    for m in range(paths.many):
        i = which[m]
        for k in range(3):
            velocity[i, k] = (there[m, k] - pose[i, k]) / dt


def timed_poses(paths: TimedPaths, time: float) -> FloatArray:
    """Poses (M, 3) x, y [m], heading [rad, unwrapped] at a time [s]."""
    out = np.empty((paths.many, 3))
    put_timed_poses(paths, time, out)
    return out


@compiled
def put_timed_poses(paths: TimedPaths, time: float, out: Rows3) -> None:
    """Write `timed_poses` into ``out`` (M, 3)."""
    row = paths.row
    for m in range(paths.many):
        first, last = paths.start[m], paths.start[m + 1] - 1
        begin, end = row[first, 0], row[last, 0]
        t, turned = time, 0.0
        if paths.repeat[m] != ONCE and time > begin:
            rounds = math.floor((time - begin) / (end - begin))
            t = time - rounds * (end - begin)
            if paths.repeat[m] == LOOP:
                turned = rounds * (row[last, 3] - row[first, 3])
            elif rounds - 2.0 * math.floor(0.5 * rounds) > 0.5:  # on the way back
                t = begin + end - t
        t = min(max(t, begin), end)
        k = first
        while k < last and row[k + 1, 0] <= t:
            k += 1
        after = t - row[k, 0]
        half = 0.5 * row[k, 6] * after
        length = row[k, 4] * after * chord_factor(half)
        out[m, 0] = row[k, 1] + length * math.cos(row[k, 5] + half)
        out[m, 1] = row[k, 2] + length * math.sin(row[k, 5] + half)
        out[m, 2] = row[k, 3] + row[k, 6] * after + turned
