"""Lines that meet in so many places that whatever is done with them takes minutes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray

AT_ONCE = 2_000_000
"""Pairs of segments that are looked at together, which bounds memory."""


def meet_more_often(segments: FloatArray, most: int, by_boxes: bool = False) -> bool:
    """Whether more than ``most`` pairs of segments (n, 2, 2) [m] share a point, ends included.

    Ends when that is known. ``by_boxes`` takes the boxes about them instead, which overlap where
    segments meet, and elsewhere too.
    """
    lines = shapely.linestrings(segments)
    tree = shapely.STRtree(lines)
    block = max(1, AT_ONCE // max(1, len(lines)))
    met = 0
    for first in range(0, len(lines), block):
        some = lines[first : first + block]
        pairs = tree.query(some, predicate=None if by_boxes else "intersects")
        met += int((pairs[0] + first != pairs[1]).sum())
        if met > 2 * most:
            return True
    return False


def segments_of(lines: Sequence[FloatArray]) -> FloatArray:
    """All segments (n, 2, 2) of polylines (k, 2)."""
    parts = [np.stack([line[:-1], line[1:]], axis=1) for line in lines if len(line) > 1]
    return np.concatenate(parts) if parts else np.empty((0, 2, 2))
