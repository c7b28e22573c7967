"""Which wall parts are within range of a place."""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.safe_point import point_part
from physim.geometry.shapes import IntArray, Shapes


@compiled
def parts_in_range(walls: Shapes, parts: IntArray, x: float, y: float, reach: float) -> IntArray:
    """Those of ``parts`` that come within ``reach`` [m] of a point, in the same order."""
    found = np.empty(len(parts), dtype=np.int64)
    count = 0
    for part in parts:
        if point_part(walls, part, x, y) <= reach:
            found[count] = part
            count += 1
    return found[:count]
