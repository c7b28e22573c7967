"""Walls near a robot: a grid of lists, and the parts within range.

The list of a cell of the grid holds every part that comes within ``reach`` of any point of the
cell, in the order of the walls, so one look-up answers for a whole neighbourhood.
"""

from __future__ import annotations

from math import floor
from typing import NamedTuple

import numpy as np
import shapely

from physim.compiled import compiled
from physim.geometry.safe_point import point_part
from physim.geometry.shapes import FloatArray, IntArray, Shapes

CELLS_SEEN = 5.0
"""Cells of the grid over which a robot sees at most, to each side"""


class WallGrid(NamedTuple):
    """Grid over the walls: cell c = row * columns + column has ``part[start[c]:start[c + 1]]``."""

    origin_x: float
    origin_y: float
    cell: float
    """[m] side of a cell"""
    columns: int
    rows: int
    start: IntArray
    """(columns * rows + 1,)"""
    part: IntArray
    reach: float
    """[m]"""
    every: IntArray
    """every part, for places outside the grid"""


def build_wall_grid(walls: Shapes, reach: float, cell: float) -> WallGrid:
    """Sort the parts of ``walls`` into a grid of cells of side ``cell`` [m].

    Cells grow where the world is large, so that there are at most about a million of them, and
    where robots see far, so that lists are not those of their neighbours over and over.
    """
    every = np.arange(len(walls.part_start) - 1, dtype=np.int64)
    low, high = walls.vertices.min(axis=0) - cell, walls.vertices.max(axis=0) + cell
    seen = min(reach, float((high - low).max()))
    cell = max(cell, seen / CELLS_SEEN, float(np.sqrt(np.prod(high - low) / 1e6)))
    columns, rows = (int(n) for n in np.ceil((high - low) / cell))
    x0 = low[0] + cell * np.arange(columns)
    y0 = low[1] + cell * np.arange(rows)
    boxes = shapely.box(
        np.tile(x0, rows),
        np.repeat(y0, columns),
        np.tile(x0 + cell, rows),
        np.repeat(y0 + cell, columns),
    )
    shapes = [_shape(walls, int(part)) for part in every]
    # a hair wider than reach: rounding must not drop a part that just comes within it
    near = shapely.STRtree(shapes).query(boxes, predicate="dwithin", distance=reach * (1.0 + 1e-9))
    order = np.lexsort((near[1], near[0]))
    counts = np.bincount(near[0], minlength=columns * rows)
    start = np.concatenate(([0], np.cumsum(counts))).astype(np.int64)
    part = np.ascontiguousarray(near[1][order], dtype=np.int64)
    return WallGrid(float(low[0]), float(low[1]), cell, columns, rows, start, part, reach, every)


@compiled
def parts_near(wall_grid: WallGrid, x: float, y: float) -> IntArray:
    """Parts that may be within ``reach`` of a place, increasing; all of them outside the grid."""
    column = floor((x - wall_grid.origin_x) / wall_grid.cell)
    row = floor((y - wall_grid.origin_y) / wall_grid.cell)
    if column < 0 or row < 0 or column >= wall_grid.columns or row >= wall_grid.rows:
        return wall_grid.every
    c = row * wall_grid.columns + column
    return wall_grid.part[wall_grid.start[c] : wall_grid.start[c + 1]]


def _shape(walls: Shapes, part: int) -> shapely.Geometry:
    corners: FloatArray = walls.vertices[walls.part_start[part] : walls.part_start[part + 1]]
    return shapely.LineString(corners) if len(corners) == 2 else shapely.Polygon(corners)


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
