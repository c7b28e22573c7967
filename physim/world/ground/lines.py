"""Polylines as points: fewer of them, more where they touch, how often they meet; placed outlines.

Walls that come from a scanner or a drawing may have a point every millimetre. Each piece between
two of them would be a segment of its own for the engine, for the distances and for the areas.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from physim.geometry.shapes import FloatArray, IntArray
from physim.tolerances import LENGTH

LONGEST_RUN = 30_000
"""Points that are looked at together; those at its ends stay"""
MANY = 1_000
"""Points up to which the walls of a world are taken as they are drawn."""
REACH = 2.0 * LENGTH
"""[m] that a point lies from a line at most to be on it: as far as points that were thinned out"""
AT_ONCE = 2_000_000
"""Pairs of segments that are looked at together, which bounds memory."""


def thinned(lines: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Polylines (n, 2) [m] by name; the points along straight stretches left out where all
    together have more than `MANY`.

    The ends stay, and so does every point farther than ``LENGTH`` from the straight line between
    the two that are kept beside it: no wall moves by more, however many points it loses.
    """
    if sum(map(len, lines.values())) <= MANY:
        return dict(lines)
    found = {}
    for name, line in lines.items():
        beside = shapely.linestrings(np.stack((line[:-2], line[2:]), axis=1))
        corner = shapely.distance(shapely.points(line[1:-1]), beside) > LENGTH
        found[name] = simplified(line, LENGTH, 1 + np.flatnonzero(corner))
    return found


def simplified(line: FloatArray, most: float, kept: Sequence[int] | IntArray = ()) -> FloatArray:
    """A polyline (n, 2) [m] of fewer points, of which none that was left out lies farther than
    ``most`` from it; the points at the indices ``kept``, and one in `LONGEST_RUN`, stay.

    Of a whole line GEOS looks for the farthest point again and again, each time within the call
    before: of 100,000 corners it takes half a minute and all of the stack.
    """
    is_cut = np.zeros(len(line), dtype=np.bool_)
    is_cut[::LONGEST_RUN] = is_cut[-1] = True
    is_cut[np.asarray(kept, dtype=np.int64)] = True
    cuts = np.flatnonzero(is_cut)
    lengths = np.diff(cuts) + 1  # of the runs from one cut to the next, both included
    run = np.repeat(np.arange(len(lengths)), lengths)
    place = np.arange(len(run)) - run  # a point at a cut is in two runs
    runs = shapely.linestrings(line[place], indices=run)
    points, run = shapely.get_coordinates(
        shapely.simplify(runs, most, preserve_topology=False), return_index=True
    )
    first = np.concatenate(([True], run[1:] == run[:-1]))
    return np.ascontiguousarray(points[first])


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


def meet_more_often(segments: FloatArray, most: int, by_boxes: bool = False) -> bool:
    """Whether more than ``most`` pairs of segments (n, 2, 2) [m] share a point, ends included:
    what is done with lines that do takes minutes.

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


def placed_outlines(footprint: ArrayLike, poses: ArrayLike) -> NDArray[np.object_]:
    """Outlines (B,) in the world frame of a footprint (n, 2) [m] at poses (B, 3) [m, m, rad]."""
    at = np.asarray(poses, dtype=np.float64)
    c, s = np.cos(at[:, 2])[:, None], np.sin(at[:, 2])[:, None]
    x, y = np.asarray(footprint, dtype=np.float64).T
    corners = np.stack([at[:, :1] + c * x - s * y, at[:, 1:2] + s * x + c * y], axis=-1)
    return np.asarray(shapely.polygons(corners))


def placed_outline(footprint: ArrayLike, pose: ArrayLike) -> Any:
    """Outline in the world frame of a footprint (n, 2) [m] at a pose (3,) [m, m, rad]."""
    return placed_outlines(footprint, np.asarray(pose)[None])[0]
