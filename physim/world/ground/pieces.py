"""Parts of walls as pieces: which join at their ends, and on which side of them robots may be."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from physim.geometry.shapes import IntArray, Shapes, part_bodies, read_only
from physim.tolerances import LENGTH
from physim.world.ground.area import Area

BOTH, LEFT, RIGHT, OUTSIDE = range(4)
"""Sides of a piece on which robots may be"""
ASIDE = 1e3 * LENGTH
"""[m] how far beside a segment it is asked whether robots may be there: far above rounding"""


class Pieces(NamedTuple):
    """What the P parts of walls are to each other; nothing may be written to.

    ``joins`` (P, 2): which part joins at the first and at the last end of a boundary's segment; -1:
    none, as of all parts of obstacles. ``free`` (P,): where robots may be: 0 on both sides, 1 left
    or 2 right of the way from the first end of a segment to its last, 3 outside a solid part.
    """

    joins: IntArray
    free: IntArray


def pieces_of(walls: Shapes, area: Area) -> Pieces:
    """Pieces that ``walls`` are made of. At an end where several join it is one of the same
    boundary, else the first."""
    joins = np.full((len(walls.part_start) - 1, 2), -1, dtype=np.int64)
    free = np.full(len(joins), OUTSIDE, dtype=np.int64)
    segment = np.flatnonzero(np.diff(walls.part_start) == 2)
    if not len(segment):
        return Pieces(read_only(joins), read_only(free))
    first = walls.vertices[walls.part_start[segment]]
    last = walls.vertices[walls.part_start[segment] + 1]

    at: dict[tuple[float, float], list[int]] = {}
    for ends in (first, last):
        for part, point in zip(segment.tolist(), ends.tolist(), strict=True):
            at.setdefault((point[0], point[1]), []).append(part)
    body = part_bodies(walls)
    for k, ends in enumerate((first, last)):
        for part, point in zip(segment.tolist(), ends.tolist(), strict=True):
            others = [one for one in at[point[0], point[1]] if one != part]
            joins[part, k] = min(others, key=lambda one: (body[one] != body[part], one), default=-1)

    way = last - first
    beside = ASIDE * np.stack((-way[:, 1], way[:, 0]), axis=1) / np.hypot(*way.T)[:, None]
    near, far = first + 0.1 * way, last - 0.1 * way  # clear of what joins at the ends
    shapely.prepare(area.polygon)
    is_left, is_right = (
        shapely.intersects(
            area.polygon, shapely.linestrings(np.stack((near + off, far + off), axis=1))
        )
        for off in (beside, -beside)
    )
    free[segment] = np.where(is_left == is_right, BOTH, np.where(is_left, LEFT, RIGHT))
    return Pieces(read_only(joins), read_only(free))
