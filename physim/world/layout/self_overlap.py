"""Corridors that run into themselves: walls of one leg would stand in another.

Where a bend is tighter than half the width a wall crosses itself too; this is told as a fold. So
two legs run into each other only where the way along the road, from one to the other side of a
crossing of walls, is longer than in any bend. In a mitred corner of the angle theta and the width w
it is w tan(theta / 2); a bend takes up to pi w / 2 more, a chicane up to 2 w.
"""

from __future__ import annotations

import numpy as np
import shapely

from physim.errors import place_text
from physim.geometry.arc_length import Polyline
from physim.geometry.corridor import SIDES, corridor_boundaries
from physim.geometry.path import SHARPEST_TURN
from physim.geometry.shapes import FloatArray, IntArray

SHORT = 0.01
"""Share of the least width up to which legs are taken together, which bounds the work"""
SLIGHT = 1.0e-4
"""Share of the width by which legs may overlap, which taking them together may feign"""
BEND = 2.0
"""Widths along the road within which any two walls may cross; the mitre of a corner is beside it,
where one can be drawn so: not in a hairpin"""
CLOSELY = 10_000
"""Crossings that are looked at together, before it is seen whether one of them is enough"""


def self_overlap(centreline: FloatArray, width: FloatArray, end_margin: float) -> str:
    """How two legs of a corridor run into each other; empty where none do.

    ``width`` (n,) [m] at each point of ``centreline`` (n, 2), which is prolonged by ``end_margin``
    [m] at both ends. Exact but for `SHORT` and `SLIGHT`: legs may overlap by the latter. Raises
    ValueError where the centreline turns too sharply to have walls.
    """
    walls = corridor_boundaries(centreline, (1.0 - SLIGHT) * width, end_margin)
    left, right = (walls[side] for side in SIDES)
    line, wide = 0.5 * (left + right), np.concatenate([width[:1], width, width[-1:]])
    kept = _spread(Polyline(line).station, SHORT * float(width.min()))
    left, right, way = left[kept], right[kept], Polyline(line[kept])
    ring = shapely.LinearRing(np.vstack([left, right[::-1]]))
    if ring.is_simple:
        return ""
    corners = shapely.get_coordinates(ring)
    pieces = shapely.linestrings(np.stack([corners[:-1], corners[1:]], axis=1))
    legs = np.arange(len(way.direction))
    leg = np.concatenate([legs, legs[-1:], legs[::-1], legs[:1]])
    one, other = shapely.STRtree(pieces).query(pieces, predicate="intersects")
    one, other = one[leg[one] < leg[other]], other[leg[one] < leg[other]]
    order = np.lexsort((leg[other], leg[one]))
    widest = np.maximum(wide[kept][:-1], wide[kept][1:])
    for k in range(0, len(order), CLOSELY):
        a, b = one[order[k : k + CLOSELY]], other[order[k : k + CLOSELY]]
        i, j = leg[a], leg[b]
        met = shapely.shortest_line(pieces[a], pieces[b])  # of no length
        place = shapely.get_coordinates(met)[::2]
        begin, end = (
            np.clip(
                way.station[n] + ((place - way.points[n]) * way.direction[n]).sum(axis=1),
                way.station[n],
                way.station[n + 1],
            )
            for n in (i, j)
        )
        turn = np.arccos(np.clip((way.direction[i] * way.direction[j]).sum(axis=1), -1.0, 1.0))
        mitre = np.where(turn <= SHARPEST_TURN, np.tan(0.5 * np.minimum(turn, SHARPEST_TURN)), 0.0)
        far = np.flatnonzero(end - begin > np.maximum(widest[i], widest[j]) * (BEND + mitre))
        if len(far):
            first, second = (
                min(max(int(kept[n[far[0]]]) - 1, 0), len(centreline) - 2) for n in (i, j)
            )
            x, y = place[far[0]].tolist()
            return (
                f"the corridor runs into itself at {place_text(x, y, 4)}: the leg from "
                f"[{first}] to [{first + 1}] and the leg from [{second}] to [{second + 1}] have "
                "less than the width between them; separate them, or draw boundaries instead, "
                "which may close on themselves"
            )
    return ""


def _spread(station: FloatArray, apart: float) -> IntArray:
    """Numbers of the first point, of those that far [m] from the one before, and of the last."""
    kept, last = [0], len(station) - 1
    if np.diff(station).min() >= apart:
        return np.arange(last + 1)
    while kept[-1] < last:
        k = int(np.searchsorted(station, station[kept[-1]] + apart))
        kept.append(min(max(k, kept[-1] + 1), last))
    return np.array(kept)
