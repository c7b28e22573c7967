"""Ends of drawn walls: on the lines that they touch, and joined where they nearly meet."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from scipy.spatial import cKDTree

from physim.authoring.importing.drawing import DIGITS, place
from physim.authoring.importing.lines import is_closed
from physim.geometry.shapes import FloatArray

NEARLY = 0.01
"""[-] Ends nearer than this share of the drawing's extent are taken to meet."""
ROUNDED = 1.5 * 10.0**-DIGITS
"""[m] A corner that lies on a line stays so near it when all are rounded: half a diagonal twice."""
OUTSIDE = 0.25
"""[-] share of the length about a place that lines beyond it, enclosing nothing, have at most"""
ROUND = 4.0
"""[-] times as long as the gap between its own ends a line goes round something"""
MOST_ROUNDS = 5
"""Times that lines are drawn to corners"""
NEIGHBOURS = 8
"""Ends among which the nearest of another line is looked for"""


def faces_of(lines: list[FloatArray]) -> list[Any]:
    """Shapely polygons of all areas that lines enclose."""
    return faces_and_loose(lines)[0]


def faces_and_loose(lines: list[FloatArray]) -> tuple[list[Any], list[Any]]:
    """Shapely polygons of all areas that lines enclose, and the lines that enclose nothing."""
    faces, cuts, dangles, _ = shapely.polygonize_full([noded(lines)])
    loose = [*shapely.get_parts(cuts), *shapely.get_parts(dangles)]
    return list(shapely.get_parts(faces)), loose


def noded(lines: list[FloatArray]) -> Any:
    """All lines as one shapely geometry, whose parts meet at their ends alone."""
    return shapely.union_all([shapely.LineString(line) for line in lines])


def knit(lines: list[FloatArray], of_one: Sequence[int] | None = None) -> None:
    """Let lines go through the corners and ends of others that lie on them, give or take rounding.

    A wall that ends at the side of another one parts from it when the ends of both are rounded,
    unless they lie along an axis. Where the other crosses the side anyway, nothing is to be done.
    A side that is drawn to one end may leave another behind it, so that is done again. Changes
    ``lines``, closed ones stay closed. ``of_one`` are numbers of what each is a line of: to itself
    nothing is knit.
    """
    for _ in range(MOST_ROUNDS):
        if not _knit_once(lines, of_one):
            return


def _knit_once(lines: list[FloatArray], of_one: Sequence[int] | None) -> bool:
    """Whether a line was changed by drawing it to corners that lie on it."""
    if len(lines) < 2:
        return False
    points = np.vstack(lines)
    of_line = np.arange(len(lines)) if of_one is None else np.asarray(of_one)
    of_point = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    of_side = np.repeat(np.arange(len(lines)), [len(line) - 1 for line in lines])
    first = np.concatenate([line[:-1] for line in lines])
    last = np.concatenate([line[1:] for line in lines])
    sides = shapely.linestrings(np.stack([first, last], axis=1))
    corners = shapely.points(points)
    at, side = shapely.STRtree(sides).query(corners, predicate="dwithin", distance=ROUNDED)
    is_other = of_line[of_point[at]] != of_line[of_side[side]]
    at, side = at[is_other], side[is_other]
    falls_short = np.ones(len(at), bool)
    for step in (-1, 1):  # the sides before and after the corner
        near = np.clip(at + step, 0, len(points) - 1)
        near = np.where(of_point[near] == of_point[at], near, at)
        edge = points[near] - points[at]
        share = np.minimum(4.0 * ROUNDED / np.maximum(np.hypot(*edge.T), ROUNDED), 1.0)
        ends = points[at] + share[:, None] * edge  # what crosses farther off is of no help here
        edges = shapely.linestrings(np.stack([points[at], ends], axis=1))
        falls_short &= ~shapely.intersects(edges, sides[side])
    at, side = at[falls_short], side[falls_short]
    apart = shapely.distance(corners[at], sides[side])
    nearest = np.lexsort((apart, of_side[side], at))
    _, once = np.unique(np.stack([at, of_side[side]])[:, nearest], axis=1, return_index=True)
    at, side = at[nearest][once], side[nearest][once]
    begin = np.cumsum([0, *(len(line) - 1 for line in lines)])
    more: dict[int, list[tuple[int, float, FloatArray]]] = {}
    for k, s in zip(at, side, strict=True):
        along = float((points[k] - first[s]) @ (last[s] - first[s]))
        more.setdefault(int(of_side[s]), []).append((int(s - begin[of_side[s]]), along, points[k]))
    for k, added in more.items():
        added.sort(key=lambda one: one[:2])
        where = [side + 1 for side, _, _ in added]
        line = np.insert(lines[k], where, [point for _, _, point in added], axis=0)
        is_kept = np.concatenate(([True], (np.diff(line, axis=0) != 0.0).any(axis=1)))
        lines[k] = line[is_kept]
    return bool(more)


def loose_ends(lines: list[FloatArray]) -> FloatArray:
    """(n, 2) [m] ends of lines, as drawn, at which no other, and no other part of the same, is."""
    edges = shapely.get_parts(noded(lines))
    nodes = shapely.get_coordinates([shapely.get_point(edges, k) for k in (0, -1)])
    times = Counter(map(tuple, nodes.tolist()))
    ends = [line[k] for line in lines for k in (0, -1)]
    return np.array([end for end in ends if times[tuple(end.tolist())] == 1]).reshape(-1, 2)


def join_ends(lines: list[FloatArray]) -> list[str]:
    """Close walls that enclose nothing; says what was done. Changes ``lines``.

    Open lines that enclose a place already are left as they are, and so are those within a closed
    one: they may leave a passage. What they enclose is none if far more of them stands about it.
    """
    knit(lines)
    rings = [face for line in lines if is_closed(line) for face in faces_of([line])]
    within = shapely.union_all([shapely.Polygon(ring.exterior) for ring in rings])
    shapely.prepare(within)
    walls = [
        line
        for line in lines
        if (line[0] != line[-1]).any() and not within.covers(shapely.LineString(line))
    ]
    if not walls:
        return []
    near = NEARLY * float(np.ptp(np.vstack(lines), axis=0).max())
    joints, changes = _bridged(walls, near, within)
    faces, loose = faces_and_loose(walls)
    if faces:
        largest = max(faces, key=lambda one: float(one.area))
        is_place = beyond_of(largest, loose) <= OUTSIDE * largest.exterior.length
        if is_place or not joints or _largest(walls + joints) <= largest.area:
            return []
        lines += joints
        return changes
    caps, told = _caps(walls + joints, rings)
    lines += joints + caps
    return changes + told


def beyond_of(face: Any, lines: Sequence[Any]) -> float:
    """Length [m] of shapely lines beyond what the outline of a shapely face encloses."""
    within = shapely.buffer(shapely.Polygon(face.exterior), ROUNDED)
    return float(shapely.union_all(lines).difference(within).length)


def _largest(lines: list[FloatArray]) -> float:
    return max(float(face.area) for face in faces_of(lines))


def _caps(walls: list[FloatArray], rings: list[Any]) -> tuple[list[FloatArray], list[str]]:
    """Caps that close two open walls at their ends, and what is said of them.

    Not where a closed line lies elsewhere, or is larger: that may be the place.
    """
    chains = shapely.get_parts(shapely.line_merge(noded(walls)))
    ends = loose_ends(walls)
    if len(chains) != 2 or len(ends) != 4:
        return [], []
    of_first = shapely.distance(chains[0], shapely.points(ends)) == 0.0
    first, second = ends[of_first == of_first[0]], ends[of_first != of_first[0]]
    straight = np.hypot(*(first[0] - second[0])) + np.hypot(*(first[-1] - second[-1]))
    crossed = np.hypot(*(first[0] - second[-1])) + np.hypot(*(first[-1] - second[0]))
    if crossed < straight:
        second = second[::-1]
    caps = [np.array(cap) for cap in ((first[0], second[0]), (first[-1], second[-1]))]
    between = shapely.union_all(faces_of([*walls, *caps]))
    if any(not ring.intersects(between) or ring.area > between.area for ring in rings):
        return [], []
    return caps, [f"two open walls closed by a cap from {place(a)} to {place(b)}" for a, b in caps]


def _bridged(
    walls: list[FloatArray], near: float, within: Any
) -> tuple[list[FloatArray], list[str]]:
    """Bridges from each loose end to the nearest other one within ``near`` [m], and what is said.

    Not to one of the same line, where that is hardly longer than the gap, and not from one inside
    a closed line.
    """
    ends = [end for end in loose_ends(walls) if not within.contains_properly(shapely.Point(end))]
    if len(ends) < 2:
        return [], []
    own = {}  # of each end of a chain of lines, the other one, and its length
    for chain in shapely.get_parts(shapely.line_merge(noded(walls))):
        a, b = (tuple(shapely.get_coordinates(chain)[k]) for k in (0, -1))
        own[a], own[b] = (b, chain.length), (a, chain.length)
    tree = cKDTree(ends)
    pairs: dict[tuple[int, int], float] = {}
    for i, end in enumerate(ends):
        other, length = own[tuple(end)]
        gaps, others = tree.query(end, k=min(NEIGHBOURS, len(ends)), distance_upper_bound=near)
        for gap, j in zip(gaps, others, strict=True):
            if np.isinf(gap):
                break
            if j != i and not (tuple(ends[j]) == other and length < ROUND * gap):
                pairs[min(i, int(j)), max(i, int(j))] = float(gap)
                break
    bridges = [np.array([ends[i], ends[j]]) for i, j in pairs]
    return bridges, [
        f"wall ends {gap:.3f} m apart at {place(ends[i])} joined" for (i, _), gap in pairs.items()
    ]
