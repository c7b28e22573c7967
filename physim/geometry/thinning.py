"""Straight walls without the points along them (shapely; not for the hot path).

Walls that come from a scanner or a drawing may have a point every millimetre. Each piece between
two of them would be a segment of its own for the engine, for the distances and for the areas.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH

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
    kept = shapely.LineString(line).simplify(LENGTH, preserve_topology=False)
    return np.ascontiguousarray(shapely.get_coordinates(kept))
