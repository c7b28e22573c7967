"""Straight walls without the points along them (shapely; not for the hot path).

Walls that come from a scanner or a drawing may have a point every millimetre. Each piece between
two of them would be a segment of its own for the engine, for the distances and for the areas.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray, IntArray
from physim.tolerances import LENGTH

LONGEST_RUN = 30_000
"""Points that are looked at together; those at its ends stay"""
MANY = 1_000
"""Points up to which the walls of a world are taken as they are drawn."""


def thinned(lines: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Polylines (n, 2) [m] by name; the points along straight stretches left out where all
    together have more than `MANY`.

    The ends stay, and so does every point farther than ``LENGTH`` from the straight line between
    the two that are kept beside it: no wall moves by more, however many points it loses.
    """
    if sum(map(len, lines.values())) <= MANY:
        return dict(lines)
    return {name: _straightened(line) for name, line in lines.items()}


def _straightened(line: FloatArray) -> FloatArray:
    """Without the points along straight stretches, which are looked for between corners."""
    return simplified(line, LENGTH, _corners(line))


def simplified(line: FloatArray, most: float, kept: Sequence[int] | IntArray = ()) -> FloatArray:
    """A polyline (n, 2) [m] of fewer points, of which none that was left out lies farther than
    ``most`` from it; the points at the indices ``kept``, and one in `LONGEST_RUN`, stay.

    Of a whole line GEOS looks for the farthest point again and again, each time within the call
    before: of 100,000 corners it takes half a minute and all of the stack.
    """
    every = np.arange(0, len(line), LONGEST_RUN)
    cuts = np.unique(np.concatenate((every, [len(line) - 1], np.asarray(kept, dtype=np.int64))))
    lengths = np.diff(cuts) + 1  # of the runs from one cut to the next, both included
    run = np.repeat(np.arange(len(lengths)), lengths)
    place = np.arange(len(run)) - run  # a point at a cut is in two runs
    runs = shapely.linestrings(line[place], indices=run)
    points, run = shapely.get_coordinates(
        shapely.simplify(runs, most, preserve_topology=False), return_index=True
    )
    first = np.concatenate(([True], run[1:] == run[:-1]))
    return np.ascontiguousarray(points[first])


def _corners(line: FloatArray) -> IntArray:
    """Points that lie farther than ``LENGTH`` from the segment between those beside them."""
    beside = shapely.linestrings(np.stack((line[:-2], line[2:]), axis=1))
    return 1 + np.flatnonzero(shapely.distance(shapely.points(line[1:-1]), beside) > LENGTH)
