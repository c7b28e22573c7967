"""Joints of polylines: where one ends on another, though rounding lays it beside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH

REACH = 2.0 * LENGTH
"""[m] that a point lies from a line at most to be on it: as far as points that were thinned out"""


def joined(lines: Sequence[FloatArray]) -> list[FloatArray]:
    """Polylines (n, 2) [m] with a point more wherever a point of any of them lies on a segment.

    A point between the two of a slanted segment has no digits that lie on it exactly, so that the
    two would not touch. Lines bend by `REACH` at most; where all points are shared they stay as
    they are.
    """
    points = np.concatenate(lines)
    starts = np.cumsum([0, *map(len, lines)])
    first = np.delete(np.arange(len(points)), starts[1:] - 1)
    ends = np.stack([points[first], points[first + 1]], axis=1)
    tree = shapely.STRtree(shapely.linestrings(ends))
    which, segment = tree.query(shapely.points(points), predicate="dwithin", distance=REACH)
    place = points[which]
    beside = ~(place[:, None] == ends[segment]).all(axis=2).any(axis=1)
    place, segment = place[beside], segment[beside]
    if not len(place):
        return list(lines)
    along = ((place - ends[segment, 0]) * (ends[segment, 1] - ends[segment, 0])).sum(axis=1)
    order = np.lexsort((along, segment))
    at = first[segment[order]] + 1
    together = np.insert(points, at, place[order], axis=0)
    more = np.searchsorted(np.sort(at), starts[1:-1])
    return list(np.split(together, starts[1:-1] + more))


__all__ = ["joined"]
