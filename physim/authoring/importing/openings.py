"""Where walls that enclose nothing are open: at which ends of lines, or between which sides."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import shapely
from scipy.spatial import cKDTree

from physim.authoring.importing.drawing import Drawing, place
from physim.authoring.importing.joining import loose_ends, noded
from physim.geometry.shapes import FloatArray

MOST_ENDS = 2_000
"""Loose ends among which the one to mend is looked for"""
MOST_POINTS = 3_000
"""Points of walls among whose sides an opening is looked for"""
CLOSED = 1e-6
"""[m] what is open by less is closed"""
ROUNDS = 12
"""Halvings by which the width of an opening is found, to more digits than are told"""


def open_ends(drawing: Drawing) -> tuple[str, FloatArray]:
    """Say where lines that enclose nothing are open, and a point (2,) [m] of the one to mend.

    That is at the nearest two ends that touch no line; where an end lies nearer to the course of
    another line, that is said instead.
    """
    ends = _of_walls(drawing, loose_ends(drawing.boundaries))
    if not 2 <= len(ends) <= MOST_ENDS:
        return "draw them closed", drawing.boundaries[0][0]
    gaps, others = cKDTree(ends).query(ends, k=2)
    k = int(np.argmin(gaps[:, 1]))
    gap, a, b = float(gaps[k, 1]), ends[k], ends[int(others[k, 1])]
    edges = shapely.get_parts(noded(drawing.boundaries))
    points = shapely.points(ends)
    at, near = shapely.STRtree(edges).query(points, predicate="dwithin", distance=gap)
    away = shapely.distance(points[at], edges[near])
    is_other = away > 0.0  # its own edge is where it is
    at, near, away = at[is_other], near[is_other], away[is_other]
    if len(away) and float(away.min()) < gap:
        k = int(np.argmin(away))
        end, wall = ends[at[k]], edges[near[k]]
        beside = shapely.get_coordinates(shapely.shortest_line(points[at[k]], wall))[1]
        which = drawing.named(beside, "boundary")
        said = f"the end at {place(end)} stops {away[k]:.3g} m short of the line at {place(beside)}"
        return said + which, end
    which = drawing.named(b, "boundary")
    return f"the nearest ends, {place(a)} and {place(b)}{which}, are {gap:.3g} m apart", a


def _of_walls(drawing: Drawing, ends: FloatArray) -> FloatArray:
    """Those of some loose ends (n, 2) [m] that are no ends of partitions, which stand on a wall.

    All where there are no two others.
    """
    edges = shapely.get_parts(noded(drawing.boundaries))
    nodes = shapely.get_coordinates([shapely.get_point(edges, k) for k in (0, -1)]).tolist()
    times = Counter(map(tuple, nodes))
    other = {tuple(line[k]): tuple(line[-1 - k]) for line in drawing.boundaries for k in (0, -1)}
    walls = np.array([times[other[tuple(end.tolist())]] < 3 for end in ends], dtype=bool)
    return ends[walls] if walls.sum() > 1 else ends


def opening(walls: Any, inside: Any = None) -> str:
    """Say where a place that shapely walls leave open is so, and how wide; empty if not known.

    The place is that about a shapely point ``inside``, else the first that closes as the walls
    grow thicker, which leaves a square metre.
    """
    if shapely.get_num_coordinates(walls) > MOST_POINTS or walls.is_empty:
        return ""
    x0, y0, x1, y1 = walls.bounds
    low, high = 0.0, 0.25 * max(x1 - x0, y1 - y0)
    grown = 0.001
    while grown < high and _closed(walls, grown, inside) is None:
        low, grown = grown, 2.0 * grown
    high = min(grown, high)
    found = _closed(walls, high, inside)
    if found is None:
        return ""
    for _ in range(ROUNDS):
        middle = 0.5 * (low + high)
        closed = _closed(walls, middle, inside)
        low, high, found = (middle, high, found) if closed is None else (low, middle, closed)
    if high < CLOSED:
        return ""
    within, outside = found
    neck = shapely.shortest_line(within, outside)
    at = shapely.get_coordinates(neck).mean(axis=0)
    return f"the walls leave it open at {place(at)}, {2.0 * high:.3g} m wide"


def _closed(walls: Any, grown: float, inside: Any) -> tuple[Any, Any] | None:
    """What walls thicker by ``grown`` [m] on each side enclose, and what is beyond them."""
    thick = shapely.buffer(walls, grown, quad_segs=4)
    holes = [shapely.Polygon(ring) for part in shapely.get_parts(thick) for ring in part.interiors]
    if inside is None:
        found = [one for one in holes if one.area > 1.0]
        hole = max(found, key=lambda one: float(one.area), default=None)
    else:  # which the walls may have grown over
        found = [one for one in holes if one.distance(inside) <= grown]
        hole = min(found, key=lambda one: float(one.distance(inside)), default=None)
    if hole is None:
        return None
    x0, y0, x1, y1 = thick.bounds
    around = shapely.box(x0 - 1.0, y0 - 1.0, x1 + 1.0, y1 + 1.0)
    return hole, around - shapely.union_all([thick, *holes])
