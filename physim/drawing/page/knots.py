"""Poses of a run by few of its samples: the knots between which robots move on arcs.

A robot under one command moves on an arc, so between two knots it is drawn on the arc that leads
from the one to the other with the turn of the heading, and a knot is needed where commands change
or contacts hold a robot up. Knots are added where a recorded sample would be missed by more than a
tolerance, until there is none; what is left over is below a pixel.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.geometry.shapes import FloatArray, IntArray

HALF_TURN = np.pi
"""[rad] Beyond this turn between two knots, and below `NO_TURN`, robots are drawn on the chord."""
NO_TURN = 1e-3


class Knots(NamedTuple):
    """Chosen samples of N robots, robot by robot, M in all."""

    counts: IntArray
    """(N,) how many each robot has; at least one"""
    row: IntArray
    """(M,) which sample"""
    pose: IntArray
    """(M, 3) x, y and heading, in quanta"""


def find_knots(
    pose: FloatArray, time: FloatArray, quanta: FloatArray, tolerance: float, reach: FloatArray
) -> Knots:
    """Choose among samples (K, N, 3) at ``time`` (K,).

    ``quanta`` (3,) are what x, y [m] and heading [rad] are rounded to; no point of a robot is then
    off by more than ``tolerance`` [m], if it lies within ``reach`` (N,) [m], at any sample.
    """
    found = [
        _knots_of(np.asarray(pose[:, i]), time, quanta, tolerance, float(reach[i]))
        for i in range(pose.shape[1])
    ]
    rows = np.concatenate(found) if found else np.zeros(0, np.int64)
    count = np.array([len(one) for one in found], dtype=np.int64)
    robot = np.repeat(np.arange(len(found)), count)
    return Knots(count, rows, np.rint(pose[rows, robot] / quanta).astype(np.int64))


def _knots_of(
    pose: FloatArray, time: FloatArray, quanta: FloatArray, tolerance: float, reach: float
) -> IntArray:
    """Rows of the knots of one robot, of samples (K, 3)."""
    rounded = np.rint(pose / quanta) * quanta
    samples = len(pose)
    is_knot = np.zeros(samples, dtype=bool)
    is_knot[[0, -1]] = True
    open_rows = np.arange(samples)  # in intervals that may still be missed by too much
    while len(open_rows):
        knots = np.flatnonzero(is_knot)
        if len(knots) < 2:
            break
        k = np.minimum(np.searchsorted(knots, open_rows, side="right") - 1, len(knots) - 2)
        first, last = knots[k], knots[k + 1]
        guess = between(
            rounded[first], rounded[last],
            (time[open_rows] - time[first]) / (time[last] - time[first]),
        )  # fmt: skip
        error = np.hypot(*(guess - pose[open_rows])[:, :2].T)
        error += reach * np.abs(guess[:, 2] - pose[open_rows, 2])
        error[is_knot[open_rows]] = 0.0
        starts = np.flatnonzero(np.diff(k, prepend=-1))
        worst = np.maximum.reduceat(error, starts)
        missed = np.repeat(worst > tolerance, np.diff(starts, append=len(k)))
        at_worst = missed & (error == np.repeat(worst, np.diff(starts, append=len(k))))
        is_knot[open_rows[at_worst]] = True
        open_rows = open_rows[missed]
    return np.flatnonzero(is_knot)


def between(first: FloatArray, last: FloatArray, share: FloatArray) -> FloatArray:
    """Poses (n, 3) at a ``share`` (n,) of the way between knots (n, 3), as they are drawn."""
    turn = last[:, 2] - first[:, 2]
    is_arc = (np.abs(turn) > NO_TURN) & (np.abs(turn) < HALF_TURN)
    half = np.where(is_arc, turn, 1.0) / 2.0
    length = np.where(is_arc, np.sin(half * share) / np.sin(half), share)
    side = np.where(is_arc, half * (share - 1.0), 0.0)
    c, s = length * np.cos(side), length * np.sin(side)
    dx, dy = (last - first)[:, :2].T
    x = first[:, 0] + c * dx - s * dy
    y = first[:, 1] + s * dx + c * dy
    return np.column_stack((x, y, first[:, 2] + turn * share))
