"""A line split where it leaves an area and comes back.

Straight piece by straight piece: of a line as a whole shapely works out every crossing with itself,
of which a drawing by a stranger may have thousands of millions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray

Cut = Callable[[NDArray[np.object_], shapely.Geometry], NDArray[np.object_]]


def split_at(line: FloatArray, area: shapely.Geometry) -> tuple[list[FloatArray], list[FloatArray]]:
    """Pieces (n, 2) of a line (m, 2) inside of an area, and outside, each as long as it goes."""
    pieces = np.stack((line[:-1], line[1:]), axis=1)
    pieces = pieces[(pieces[:, 0] != pieces[:, 1]).any(axis=1)]
    lines = shapely.linestrings(pieces)
    shapely.prepare(area)
    inside, outside = shapely.covers(area, lines), shapely.disjoint(area, lines)
    across = ~inside & ~outside
    return (
        _chained(pieces, inside, *_cut(pieces, lines, across, area, shapely.intersection)),
        _chained(pieces, outside, *_cut(pieces, lines, across, area, shapely.difference)),
    )


def _cut(
    pieces: FloatArray,
    lines: NDArray[np.object_],
    across: NDArray[np.bool_],
    area: shapely.Geometry,
    cut: Cut,
) -> tuple[FloatArray, NDArray[np.int64]]:
    """What a cut leaves of the pieces across: (s, 2, 2) in the order of the line, and of which."""
    parts, index = shapely.get_parts(cut(lines[across], area), return_index=True)
    long = shapely.length(parts) > 0.0
    parts, which = parts[long], np.flatnonzero(across)[index[long]]
    ends = np.stack([shapely.get_coordinates(shapely.get_point(parts, k)) for k in (0, -1)], axis=1)
    along = pieces[which, 1] - pieces[which, 0]
    far = ((ends - pieces[which, :1]) * along[:, None]).sum(axis=2)
    back = far[:, 0] > far[:, 1]
    ends[back] = ends[back, ::-1]
    order = np.lexsort((far.min(axis=1), which))
    return ends[order], which[order]


def _chained(
    pieces: FloatArray,
    whole: NDArray[np.bool_],
    parts: FloatArray,
    which: NDArray[np.int64],
) -> list[FloatArray]:
    """Whole pieces and parts of others, joined where one begins as the one before ends."""
    order = np.argsort(np.concatenate((np.flatnonzero(whole), which)), kind="stable")
    every = np.concatenate((pieces[whole], parts))[order]
    apart = (every[1:, 0] != every[:-1, 1]).any(axis=1)
    runs = np.split(every, np.flatnonzero(apart) + 1)
    return [np.concatenate((run[:, 0], run[-1:, 1])) for run in runs if len(run)]
