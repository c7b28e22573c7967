"""A reference path through an open place: between two far places, where it is widest.

The place is covered with a grid. The clearance that the group gets is as large as leaves a long
way to go; the route between its two ends is the shortest on the grid when narrow places count as
longer, and is then drawn smooth, without coming nearer to the walls than it must.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree

from physim.authoring.importing.area import Clearance, Place
from physim.authoring.importing.drawing import (
    Drawing,
    Shape,
    place,
    rounded,
)
from physim.authoring.importing.options import Options
from physim.authoring.importing.size import LENGTH, ROOM, room_of
from physim.geometry.shapes import FloatArray
from physim.world.ground.polyline import Polyline

KEPT = 0.9
"""[-] A straight cut keeps this share of the clearance of the stretch it replaces."""
ROUNDS = 60
"""Times that every point moves towards the middle of its neighbours."""
MOST_SAMPLES = 5_000
"""Points of a line that is rounded"""
MOST_CELLS = 80_000
"""Cells of the grid within the area"""
END_ROOM = 1.6
"""[-] times the clearance of the path where it begins and ends, where no place is asked for"""
MANY = 2_000
"""Points from which on an outline is taken coarsely for the search"""
ROUGH = 0.01
"""[-] of the distance of two cells: how coarsely"""
WORTH = 0.6
"""[-] A route this share of the longest is long enough: then a wider one counts more."""
SIZES = (1.0, 0.8, 0.64, 0.5, 0.4, 0.32, 0.25, 0.2, 0.16, 0.125, 0.1, 0.08, 0.06, 0.04, 0.02, 0.01)
"""[-] sizes of the group that are tried, largest first"""


@dataclass(frozen=True)
class _Grid:
    """Nodes (n, 2) [m] inside the area, the clearance of each, and the links between them."""

    nodes: FloatArray
    gaps: FloatArray
    first: Any
    second: Any
    lengths: FloatArray

    def graph(self, room: float, widest: bool) -> Any:
        """Sparse graph of the nodes with clearance ``room``; narrow links longer if ``widest``."""
        fits = self.gaps >= room
        keep = fits[self.first] & fits[self.second]
        weight = self.lengths[keep]
        if widest:
            gap = np.minimum(self.gaps[self.first[keep]], self.gaps[self.second[keep]])
            weight = weight * (1.0 + 4.0 * (room / np.maximum(gap, room)) ** 2)
        size = len(self.nodes)
        return coo_matrix((weight, (self.first[keep], self.second[keep])), (size, size)).tocsr()

    def way(
        self, room: float, begin: tuple[float, float] | None, end: tuple[float, float] | None
    ) -> tuple[int, int, float] | None:
        """Nodes near two places that a route with clearance ``room`` joins, and how long it is [m].

        Where one is not given it is as far as it can be. None where there is no such route.
        """
        fits = np.flatnonzero(self.gaps >= room)
        if not fits.size:
            return None
        graph = self.graph(room, widest=False)
        ends = list[int]()
        for point in (begin, end):
            if point is not None:
                away = np.hypot(*(self.nodes[fits] - point).T)
                if away.min() > 1.5 * room:
                    return None
                ends.append(int(fits[np.argmin(away)]))
        if not ends:  # from far away in the largest part
            labels = connected_components(graph, directed=False)[1]
            largest = np.argmax(np.bincount(labels[fits]))
            ends = [_farthest(graph, int(fits[labels[fits] == largest][0]))[0]]
        if len(ends) == 1:
            other, length = _farthest(graph, ends[0])
            return (other, ends[0], length) if begin is None and end else (ends[0], other, length)
        length = float(dijkstra(graph, directed=False, indices=ends[0])[ends[1]])
        return (ends[0], ends[1], length) if 0.0 < length < np.inf else None


def find_route(drawing: Drawing, where: Place, options: Options, reach: float) -> FloatArray:
    """A path (n, 2) [m] from --from to --to, or far; it says how it was found.

    Lanes go ``reach`` [m] beside it, at size 1. Raises ImportSourceError when --from or --to lies
    outside, or nothing leads from one to the other.
    """
    area = where.area
    step = float(np.sqrt(area.area / MOST_CELLS))
    rough = where.clearance
    if shapely.get_num_coordinates(area) > MANY:
        simple = shapely.simplify(area, ROUGH * step)
        rough = Clearance(simple) if simple.is_valid and simple.area > 0.0 else rough
    grid = _grid(rough, step)
    asked = (options.origin, options.goal)
    begin, end = asked
    if end is not None and not area.covers(shapely.Point(end)):
        x0, y0, x1, y1 = area.bounds
        there = f"x from {x0:g} to {x1:g}, y from {y0:g} to {y1:g}"
        raise drawing.refusal(f"--to {place(end)}: not in the place of the robots, {there}")
    if begin and end and np.hypot(begin[0] - end[0], begin[1] - end[1]) <= step:
        raise drawing.refusal(
            f"--from and --to are the same place, {place(begin)}; a path leads from one place to "
            "another"
        )
    robots = drawing.of("robot") if options.robots is None else []
    rooms = _rooms(options, robots, reach)
    if begin is None and robots:
        begin = _rear(drawing, grid, options, rooms)
    room, a, b = _ends(drawing, grid, options, rooms, begin)
    before = dijkstra(grid.graph(room, True), directed=False, indices=a, return_predecessors=True)[
        1
    ]
    chain = [b]
    while chain[-1] != a:
        chain.append(int(before[chain[-1]]))
    way = Polyline(_smooth(grid.nodes[chain[::-1]], rough, room))
    at = np.linspace(0.0, way.length, int(np.clip(way.length / (0.1 * room), 1, MOST_SAMPLES)) + 1)
    gaps = where.clearance.at(way.at(at)[0])
    wide = at[(gaps >= END_ROOM * room) & (np.minimum(at, way.length - at) < 2.0 * room)]
    first = wide[0] if wide.size and begin is None else 0.0
    last = wide[-1] if wide.size and end is None else way.length
    line = rounded(way.stretch(first, last) if last - first > 0.5 * way.length else way.points)
    drawing.facts.append(
        f"path found from {place(line[0])} to {place(line[-1])}, {Polyline(line).length:.2f} m, at "
        f"least {gaps.min():.2f} m from every boundary (--from, --to)"
    )
    for word, point, there in zip(("--from", "--to"), asked, line[[0, -1]], strict=True):
        if point is not None and (away := float(np.hypot(*(there - point)))) > step:
            drawing.changes.append(
                f"{word} {place(point)}: moved by {away:.2f} m, to {place(there)}, where robots "
                "have room"
            )
    return line


def _rooms(options: Options, robots: Sequence[Shape], reach: float) -> list[float]:
    """Clearances [m] to try, largest first: of the robots asked for or drawn, or of all sizes."""
    if options.robot == "fit":
        return [(ROOM + reach) * size for size in SIZES]
    box = options.robot
    if robots:
        about = [one.geometry.minimum_rotated_rectangle for one in robots]
        sides = [np.diff(shapely.get_coordinates(one)[:3], axis=0) for one in about]
        short, long = np.sort(np.hypot(*np.moveaxis(np.array(sides), 2, 0)), axis=1).max(axis=0)
        box = (float(long), float(short))
    if box is None:
        return [ROOM + reach]
    size = box[0] / LENGTH
    return [room + reach * size for room in (ROOM * size, room_of(box), 0.55 * box[1])]


def _rear(
    drawing: Drawing, grid: _Grid, options: Options, rooms: list[float]
) -> tuple[float, float]:
    """Where of the robots drawn the one stands whose way to the goal is longest.

    Without a goal that is the place farthest from the first of them.
    """
    centres = np.array([one.geometry.centroid.coords[0] for one in drawing.of("robot")])
    room, _, goal = _ends(drawing, grid, options, rooms, (centres[0][0], centres[0][1]))
    away = dijkstra(grid.graph(room, False), directed=False, indices=goal)
    fits = np.flatnonzero(np.isfinite(away))
    x, y = centres[np.argmax(away[fits[cKDTree(grid.nodes[fits]).query(centres)[1]]])]
    return float(x), float(y)


def _ends(
    drawing: Drawing,
    grid: _Grid,
    options: Options,
    rooms: list[float],
    begin: tuple[float, float] | None,
) -> tuple[float, int, int]:
    """The clearance to keep [m], and the nodes at which the path begins and ends.

    Of the clearances tried, largest first, the first that leaves a route between the points asked
    for, or one nearly as long as the smallest does.
    """
    end = options.goal
    is_asked = begin is not None and end is not None
    least = None if is_asked else grid.way(rooms[-1], begin, end)
    enough = 0.0 if least is None else WORTH * least[2]
    for room in rooms:
        found = grid.way(room, begin, end)
        if found is not None and (is_asked or found[2] >= max(enough, 4.0 * room)):
            return room, *found[:2]
    between = f" from {place(begin)} to {place(end)}" if begin and end else ""
    if drawing.of("robot") and options.robots is None:
        how = "; draw smaller robots, or --robots N --robot fit"
    elif options.robot == "fit":
        how = " at their smallest (--robot fit)"
    else:
        how = "; --robot fit, or a smaller --robot LENGTH,WIDTH"
    raise drawing.lack(
        f"no route{between} with {rooms[-1]:.3g} m to the walls, which the robots need{how}"
    )


def _grid(outline: Clearance, step: float) -> _Grid:
    """Square grid of nodes ``step`` [m] apart inside the area, linked to eight neighbours."""
    x0, y0, x1, y1 = outline.area.bounds
    xs, ys = np.arange(x0 + step / 2.0, x1, step), np.arange(y0 + step / 2.0, y1, step)
    gx, gy = np.meshgrid(xs, ys)
    mask = shapely.contains_xy(outline.area, gx, gy)
    index = np.full(mask.shape, -1)
    index[mask] = np.arange(int(mask.sum()))
    nodes = np.stack([gx[mask], gy[mask]], axis=1)
    gaps = outline.at(nodes)
    firsts, seconds, lengths = [], [], []
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = index[: len(ys) - dy, max(-dx, 0) : len(xs) - max(dx, 0)]
        there = index[dy:, max(dx, 0) : len(xs) + min(dx, 0)]
        both = (here >= 0) & (there >= 0)
        firsts.append(here[both])
        seconds.append(there[both])
        lengths.append(np.full(int(both.sum()), step * np.hypot(dx, dy)))
    first, second, length = (np.concatenate(v) for v in (firsts, seconds, lengths))
    clear = gaps[first] + gaps[second] > length  # else there may be a thin wall between them
    narrow = np.flatnonzero(~clear)
    links = shapely.linestrings(np.stack([nodes[first[narrow]], nodes[second[narrow]]], axis=1))
    clear[np.delete(narrow, outline.crossed(links))] = True
    return _Grid(nodes, gaps, first[clear], second[clear], length[clear])


def _farthest(graph: Any, node: int) -> tuple[int, float]:
    """Node farthest from another on the routes of a graph, and how far [m]."""
    away = dijkstra(graph, directed=False, indices=node)
    away = np.where(np.isfinite(away), away, -1.0)
    k = int(np.argmax(away))
    return k, float(away[k])


def _smooth(line: FloatArray, area: Clearance, room: float) -> FloatArray:
    """Straighten and round a line (n, 2) whose points have clearance ``room`` [m] in ``area``.

    One that is too long for points close to each other is straightened alone.
    """
    line = _straightened(line, area, room)
    way = Polyline(line)
    count = int(np.ceil(way.length / (0.3 * room)))
    if count > MOST_SAMPLES:
        return line
    points = way.at(np.linspace(0.0, way.length, count + 1))[0]
    low = np.minimum(area.at(points), room)
    for _ in range(ROUNDS):
        moved = points.copy()
        moved[1:-1] = 0.5 * points[1:-1] + 0.25 * (points[:-2] + points[2:])
        allowed = area.at(moved) >= low
        points = np.where(allowed[:, None], moved, points)
    simple = shapely.simplify(shapely.LineString(points), 0.02 * room)
    return np.asarray(shapely.get_coordinates(simple))


def _straightened(line: FloatArray, area: Clearance, room: float) -> FloatArray:
    """Replace stretches by straight ones that keep away from the walls nearly as well."""
    gaps = area.at(line)
    kept, k = [0], 0
    while k < len(line) - 1:
        reach = len(line) - 1 - k
        while reach > 1:
            j = k + reach
            there = float(gaps[k : j + 1].min())
            wanted = max(KEPT * min(there, 4.0 * room), min(there, room))
            if area.of(shapely.LineString(line[[k, j]])).min() >= wanted:
                break
            reach = reach // 2 if reach > 8 else reach - 1
        k += max(reach, 1)
        kept.append(k)
    return np.asarray(line[kept])
