"""Walls of a corridor that cross: its legs run into each other, or a bend folds.

In a bend tighter than half the width a wall crosses itself. So legs run into each other only where
the way along the road, from one side of a crossing to the other, is longer than in any bend. In a
mitred corner of the angle theta and the width w it is w tan(theta / 2); a bend takes up to pi w / 2
more, a chicane up to 2 w.
"""

from __future__ import annotations

import numpy as np
import shapely

from physim.errors import Fault, place_text
from physim.geometry.path import SHARPEST_TURN
from physim.geometry.shapes import FloatArray
from physim.world.ground.corridor import SIDES, corridor_boundaries
from physim.world.ground.polyline import Polyline

SHORT = 0.01
"""Share of the least width up to which legs are taken together, which bounds the work"""
SLIGHT = 1.0e-4
"""Share of the width by which walls may cross, which taking legs together may feign"""
BEND = 2.0
"""Widths along the road within which any two walls may cross; the mitre of a corner is beside it,
where one can be drawn so: not in a hairpin"""


def wall_crossing(centreline: FloatArray, width: FloatArray, end_margin: float) -> Fault | None:
    """Fault of legs that run into each other, an error, or else of a bend that folds, a warning.

    ``width`` (n,) [m] at each point of ``centreline`` (n, 2), which is prolonged by ``end_margin``
    [m] at both ends. Exact but for `SHORT` and `SLIGHT`. Raises ValueError where the centreline
    turns too sharply to have walls.
    """
    walls = corridor_boundaries(centreline, (1.0 - SLIGHT) * width, end_margin)
    left, right = (walls[side] for side in SIDES)
    line = 0.5 * (left + right)
    station = Polyline(line).station
    is_kept = np.diff(station // (SHORT * float(width.min())), prepend=-1.0) > 0.0
    is_kept[-1] = True
    kept = np.flatnonzero(is_kept)
    way = Polyline(line[kept])
    ring = np.vstack([left[kept], right[kept][::-1], left[:1]])
    if shapely.LinearRing(ring).is_simple:
        return None
    pieces = shapely.linestrings(np.stack([ring[:-1], ring[1:]], axis=1))
    legs = np.arange(len(way.direction))
    leg = np.concatenate([legs, legs[-1:], legs[::-1], legs[:1]])
    one, other = shapely.STRtree(pieces).query(pieces, predicate="intersects")
    is_joint = np.abs(one - other) % (len(pieces) - 2) == 1
    ahead = (leg[one] < leg[other]) & ~is_joint
    one, other = one[ahead], other[ahead]
    order = np.lexsort((leg[other], leg[one]))
    one, other = one[order], other[order]
    i, j = leg[one], leg[other]
    wide = np.concatenate([width[:1], width, width[-1:]])[kept]
    widest = np.maximum(wide[:-1], wide[1:])
    turn = np.arccos(np.clip((way.direction[i] * way.direction[j]).sum(axis=1), -1.0, 1.0))
    mitre = np.where(turn <= SHARPEST_TURN, np.tan(0.5 * np.minimum(turn, SHARPEST_TURN)), 0.0)
    most = np.maximum(widest[i], widest[j]) * (BEND + mitre)
    for k in np.flatnonzero(way.station[j + 1] - way.station[i] > most):  # else surely one bend
        met = _met(pieces[one[k]], pieces[other[k]])
        begin, end = (
            way.station[n] + max((met - way.points[n]) @ way.direction[n], 0.0)
            for n in (i[k], j[k])
        )
        if min(end, way.station[j[k] + 1]) - min(begin, way.station[i[k] + 1]) > most[k]:
            last = len(centreline) - 2
            first, second = (min(max(int(kept[n]) - 1, 0), last) for n in (i[k], j[k]))
            return Fault(
                ("corridor", "centreline"),
                f"the corridor runs into itself at {place_text(met[0], met[1], 4)}: the leg from "
                f"[{first}] to [{first + 1}] and the leg from [{second}] to [{second + 1}] have "
                "less than the width between them; separate them, or draw boundaries instead, "
                "which may close on themselves",
            )
    if not len(one):
        return None
    return Fault(
        ("corridor",),
        f"its walls cross at {place_text(*_met(pieces[one[0]], pieces[other[0]]))}: the bend is "
        "tighter than half the width, so the corridor is narrower there than written; widen the "
        "bend, or put the points of the centreline further apart",
        "warning",
    )


def _met(one: shapely.LineString, other: shapely.LineString) -> FloatArray:
    """A point (2,) [m] of both."""
    return np.asarray(shapely.get_coordinates(shapely.shortest_line(one, other))[0])
