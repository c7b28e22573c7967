"""Who is within range of whom: one query for many, over places sorted along an axis."""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, IntArray

MARGIN = 1e-9
"""[m], and share of the range: a window is wider by both, so that its rounding cannot matter."""


def window_along(values: FloatArray, about: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    """First and one past the last (M,) of sorted ``values`` that may be within ``reach`` [m]."""
    wide = reach * (1.0 + MARGIN) + MARGIN
    low = np.searchsorted(values, about - wide, side="left")
    return low, np.searchsorted(values, about + wide, side="right")


def sorted_places(pose: FloatArray) -> tuple[IntArray, int]:
    """Rows of ``pose`` (N, 3) in order along the longer side of where they are, and that axis."""
    extent = np.ptp(pose[:, :2], axis=0)
    axis = int(extent[1] > extent[0])
    return np.argsort(pose[:, axis], kind="stable"), axis


@compiled
def rows_in_range(
    pose: FloatArray, order: IntArray, low: IntArray, high: IntArray, own: IntArray, reach: float
) -> tuple[IntArray, IntArray]:
    """Rows of ``pose`` that are within ``reach`` [m] of row ``own[k]``, which is not among them.

    Looked at are the rows ``order[low[k]:high[k]]``. Returns where those of each k begin (M + 1,),
    and the rows, in the order looked at.
    """
    start = np.zeros(len(own) + 1, dtype=np.int64)
    found = np.zeros(0, dtype=np.int64)
    for fills in (False, True):  # the first time they are counted
        count = 0
        for k in range(len(own)):
            x, y = pose[own[k], 0], pose[own[k], 1]
            for at in range(low[k], high[k]):
                row = order[at]
                dx, dy = pose[row, 0] - x, pose[row, 1] - y
                if row != own[k] and dx * dx + dy * dy <= reach * reach:
                    if fills:
                        found[count] = row
                    count += 1
            start[k + 1] = count
        if not fills:
            found = np.empty(count, dtype=np.int64)
    return start, found
