"""Corridors whose legs run into each other: walls of one would stand in the other.

Leg k of a corridor lies between its two walls, from one point of the centreline to the next,
mitred at both: where nothing folds over, four corners of a convex shape. In a bend that is tighter
than half the width a wall folds over, and legs there overlap; this is told as a fold. So two legs
run into each other only where the way along the road, from where the one is overlapped to where
the other is, is longer than in any bend. In a mitred corner of the angle theta and the width w it
is w tan(theta / 2); a bend takes up to pi w / 2 more, a chicane up to 2 w.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from physim.errors import place_text
from physim.geometry.corridor import SIDES, corridor_boundaries
from physim.geometry.path import SHARPEST_TURN
from physim.geometry.polygon import least_width
from physim.geometry.shapes import FloatArray, IntArray

SHORT = 0.01
"""Share of the least width up to which legs are taken together, which bounds the work"""
SLIGHT = 1.0e-4
"""Share of the width by which legs may overlap, which taking them together may feign"""
BEND = 2.0
"""Widths along the road within which any two legs may overlap; the mitre of a corner is beside it,
where one can be drawn so: not in a hairpin"""
AT_ONCE = 1_000_000
"""Pairs of legs that are looked at together, which bounds memory"""
CLOSELY = 1_000
"""Pairs of them whose overlaps are worked out together, before it is seen whether one is enough"""


@dataclass(frozen=True)
class _Legs:
    """Legs of a corridor, n of them."""

    first: IntArray
    """(n,) number of the point of the walls at which each begins"""
    begin: FloatArray
    """(n, 2) [m] where it begins on the centreline"""
    ahead: FloatArray
    """(n, 2) unit vector to where it ends"""
    station: FloatArray
    """(n + 1,) [m] along the road where each begins, and where the last one ends"""
    width: FloatArray
    """(n,) [m] the greater one of its ends"""
    shape: Any
    """(n,) convex polygons"""

    def along(self, legs: IntArray, places: FloatArray) -> FloatArray:
        """Stations (k,) [m] of the points of legs (k,) that are nearest to places (k, 2)."""
        on: FloatArray = ((places - self.begin[legs]) * self.ahead[legs]).sum(axis=1)
        begin = self.station[legs]
        return begin + np.clip(on, 0.0, self.station[legs + 1] - begin)


def self_overlap(centreline: FloatArray, width: FloatArray, end_margin: float) -> str:
    """How two legs of a corridor run into each other; empty where none do.

    ``width`` (n,) [m] at each point of ``centreline`` (n, 2), which is prolonged by ``end_margin``
    [m] at both ends. Exact but for `SHORT` and `SLIGHT`: legs may overlap by the latter. Raises
    ValueError where the centreline turns too sharply to have walls.
    """
    walls = corridor_boundaries(centreline, width, end_margin)
    whole = np.concatenate([width[:1], width, width[-1:]])
    left, right = (walls[side] for side in SIDES)
    found = legs_that_meet(whole, left, right)
    if found is None:
        return ""
    first, second = (min(max(k - 1, 0), len(centreline) - 2) for k in found[:2])
    return (
        f"the corridor runs into itself at {place_text(*found[2], 4)}: the leg from [{first}] to "
        f"[{first + 1}] and the leg from [{second}] to [{second + 1}] have less than the width "
        "between them; separate them, or draw boundaries instead, which may close on themselves"
    )


def legs_that_meet(
    width: FloatArray, left: FloatArray, right: FloatArray, bend: float = BEND
) -> tuple[int, int, tuple[float, float]] | None:
    """The first two legs of a road that run into each other; None where none do.

    ``left`` and ``right`` (n, 2) [m] are its walls, points opposite each other, ``width`` (n,) [m]
    between them; legs less than ``bend`` widths from each other along the road may overlap.
    Returns the numbers of the points at which the legs begin, and where they meet.
    """
    legs = _legs(width, left, right)
    for i, j in _near(legs):
        if found := _in_earnest(legs, i, j, bend):
            return int(legs.first[found[0]]), int(legs.first[found[1]]), found[2]
    return None


def _legs(width: FloatArray, left: FloatArray, right: FloatArray) -> _Legs:
    line = 0.5 * (left + right)
    station = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    kept = _spread(station, SHORT * float(width.min()))
    line, left, right, width = line[kept], left[kept], right[kept], width[kept]
    corners = np.stack([left[:-1], left[1:], right[1:], right[:-1]], axis=1)
    chord = np.diff(line, axis=0)
    return _Legs(
        kept[:-1],
        line[:-1],
        chord / np.maximum(np.hypot(*chord.T), np.finfo(float).tiny)[:, None],
        station[kept],
        np.maximum(width[:-1], width[1:]),
        shapely.convex_hull(shapely.polygons(corners)),
    )


def _spread(station: FloatArray, apart: float) -> IntArray:
    """Numbers of the first point, of those that far [m] from the one before, and of the last."""
    kept, last = [0], len(station) - 1
    if np.diff(station).min() >= apart:
        return np.arange(last + 1)
    while kept[-1] < last:
        k = int(np.searchsorted(station, station[kept[-1]] + apart))
        kept.append(min(max(k, kept[-1] + 1), last))
    return np.array(kept)


def _near(legs: _Legs) -> Iterator[tuple[IntArray, IntArray]]:
    """Pairs of legs in order that share a point though the way between them is long enough."""
    tree, count = shapely.STRtree(legs.shape), len(legs.shape)
    block = max(1, AT_ONCE // count)
    for first in range(0, count, block):
        i, j = tree.query(legs.shape[first : first + block], predicate="intersects")
        i += first
        most = legs.station[j + 1] - legs.station[i]
        far = (j > i + 1) & (most > BEND * np.maximum(legs.width[i], legs.width[j]))
        i, j = i[far], j[far]
        order = np.lexsort((j, i))
        for k in range(0, len(i), CLOSELY):
            yield i[order[k : k + CLOSELY]], j[order[k : k + CLOSELY]]


def _in_earnest(
    legs: _Legs, i: IntArray, j: IntArray, bend: float
) -> tuple[int, int, tuple[float, float]] | None:
    """The first of pairs of legs (k,) that run into each other, and where they do."""
    common = shapely.intersection(legs.shape[i], legs.shape[j])
    corners, pair = shapely.get_coordinates(common, return_index=True)
    way = np.zeros(len(i))
    np.maximum.at(way, pair, legs.along(j[pair], corners) - legs.along(i[pair], corners))
    turn = np.arccos(np.clip((legs.ahead[i] * legs.ahead[j]).sum(axis=1), -1.0, 1.0))
    width = np.maximum(legs.width[i], legs.width[j])
    mitre = np.where(turn <= SHARPEST_TURN, np.tan(0.5 * np.minimum(turn, SHARPEST_TURN)), 0.0)
    bound = width * (bend + mitre)
    far = np.flatnonzero((way > bound) & (shapely.area(common) > 0.0))
    for k in far.tolist():
        if least_width(shapely.get_coordinates(common[k])) > SLIGHT * width[k]:
            at = common[k].representative_point()
            return int(i[k]), int(j[k]), (at.x, at.y)
    return None
