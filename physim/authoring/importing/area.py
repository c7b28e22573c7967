"""The place of the robots: of the areas that lines enclose, the one that holds their path.

Walls, obstacles and stated places are cut where they meet, and the faces between them found. What
lies in an obstacle, or outside the places that a source states, is none. Nothing is closed that is
open, unless the user asks for it (``--close``).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from scipy.spatial import cKDTree

from physim.authoring.importing.drawing import (
    DIGITS,
    MOST_CORNERS,
    Drawing,
    Shape,
    listed,
    place,
    rounded,
)
from physim.authoring.importing.options import Options
from physim.geometry.shapes import FloatArray, IntArray
from physim.world.ground.area import inner_lines
from physim.world.ground.lines import segments_of

GRID = 10.0**-DIGITS
"""[m] Worlds are written to the millimetre."""
HALF_WALL = 0.5 * GRID
"""[m] half the thickness that a wall within the area is given: the rounding of its points"""
SMALLEST = 1.0
"""[m] extent of a place below which it is refused"""
MOST_OBSTACLES = 3_000
MOST_NAMED = 3
"""Loose ends that a message names"""


class Clearance:
    """Distances to the edge of a shapely area, which are asked for by the ten thousand."""

    def __init__(self, area: Any) -> None:
        self.area = area
        shapely.prepare(area)
        rings = map(shapely.get_coordinates, shapely.get_parts(area.boundary))
        self._edges = shapely.STRtree(shapely.linestrings(segments_of(list(rings))))

    def at(self, points: FloatArray) -> FloatArray:
        """(k,) [m] distance of points (k, 2) to the edge; negative outside the area."""
        places = shapely.points(points)
        distance = self.of(places)
        return np.asarray(np.where(shapely.covers(self.area, places), distance, -distance))

    def of(self, shapes: Any) -> FloatArray:
        """(k,) [m] distance of shapely shapes to the edge."""
        return np.asarray(
            self._edges.query_nearest(shapes, return_distance=True, all_matches=False)[1]
        )

    def crossed(self, lines: Any) -> IntArray:
        """Numbers of the shapely lines that meet the edge."""
        return np.unique(self._edges.query(lines, predicate="intersects")[0])


@dataclass(frozen=True)
class Place:
    """Where robots may go [m]: a shapely ``face``, and ``inner`` walls that stand in it."""

    face: Any
    inner: Any

    @cached_property
    def area(self) -> Any:
        """The face without its inner walls, as a shapely polygon."""
        if self.inner.is_empty:
            return self.face
        walls = shapely.buffer(self.inner, HALF_WALL, cap_style="square")
        return max(shapely.get_parts(self.face.difference(walls)), key=shapely.area)

    @cached_property
    def clearance(self) -> Clearance:
        """Distances to its walls."""
        return Clearance(self.area)

    @cached_property
    def boundaries(self) -> list[FloatArray]:
        """Polylines of the world: outline, walls that stand in it, holes of very many corners."""
        walls = [rounded(shapely.get_coordinates(one)) for one in shapely.get_parts(self.inner)]
        outline = shapely.get_coordinates(self.face.exterior)
        return [outline, *(one for one in walls if len(one) > 1), *self._holes(are_long=True)]

    @cached_property
    def obstacles(self) -> list[FloatArray]:
        """Rings of the world, the first point not repeated."""
        return [ring[:-1] for ring in self._holes(are_long=False)]

    def _holes(self, are_long: bool) -> list[FloatArray]:
        rings = map(shapely.get_coordinates, self.face.interiors)
        return [ring for ring in rings if (len(ring) > MOST_CORNERS + 1) == are_long]


def find_place(drawing: Drawing, options: Options) -> Place:
    """The place in which the path, a robot or --from is, in the millimetres of the world.

    What does not bound it is listed. Raises ImportSourceError where there is none, where it may be
    one of several, and for lines too many or too tangled to work on.
    """
    drawn = drawing.of("boundary", "obstacle")
    solid = shapely.union_all([one.geometry for one in drawing.of("obstacle")])
    within = [one.geometry for one in drawing.of("place")]
    lines = [ring for one in drawing.of("boundary", "obstacle", "place") for ring in _rings(one)]
    if not lines:
        raise drawing.lack("no boundary found; a world needs lines that enclose an area")
    size = np.ptp(np.concatenate(lines), axis=0)
    if size.max() < SMALLEST:
        raise drawing.refusal(
            f"the place is {size[0]:.3g} x {size[1]:.3g} m; --scale M says how many metres a unit "
            "of the source is"
        )
    closed = sum(one.role == "obstacle" or one.geometry.is_closed for one in drawn)
    if closed > MOST_OBSTACLES:
        raise drawing.refusal(
            f"{closed} obstacles and closed walls; at most {MOST_OBSTACLES} are read; leave out "
            "small ones, or draw those that touch as one"
        )
    if options.close is not None:
        bridges = joints([one.points for one in drawing.of("boundary")], options.close)
        drawing.changes += listed(bridges, joint_text)
        lines += bridges
    noded = shapely.union_all([shapely.LineString(line) for line in lines], grid_size=GRID)
    found, cuts, dangles, _ = shapely.polygonize_full([noded])
    faces = list(shapely.get_parts(found))
    if len(within) == len(drawing.of("boundary", "obstacle", "place")) == 1:
        faces = within  # as it was read
    stated = shapely.union_all(within)
    for shape in (solid, stated):
        shapely.prepare(shape)
    free = [
        face
        for face in faces
        if not solid.contains(inside := face.representative_point())
        and (not within or stated.contains(inside))
    ]
    face = _chosen(drawing, options, free, noded)
    shapely.prepare(face)
    away = [one for one in drawn if not face.dwithin(one.geometry, GRID)]
    drawing.changes += listed(
        away,
        lambda one: f"{one.role} {one} at {place(one.points[0])}: away from the place, left out",
    )
    loose = [edge for some in (cuts, dangles) for edge in shapely.get_parts(some)]
    return Place(face, inner_lines(face, loose))


def joints(lines: Sequence[FloatArray], within: float, only_ends: bool = False) -> list[FloatArray]:
    """Straight lines (2, 2) [m] from loose ends of lines to the nearest other one ``within`` [m].

    Where there is none, to the nearest other line, unless ``only_ends``.
    """
    shapes = [shapely.LineString(line) for line in lines]
    ends = _loose(shapely.union_all(shapes, grid_size=GRID))
    found: dict[tuple[int, int], FloatArray] = {}
    to_lines = list[FloatArray]()
    away, other = _nearest_other(ends)
    for k, end in enumerate(ends):
        if away[k] <= within:
            i, j = sorted((k, int(other[k])))
            found[i, j] = np.stack([ends[i], ends[j]])
        elif not only_ends:
            point = shapely.Point(end)
            others = [one for one in shapes if one.distance(point) > 0.0]
            ways = shapely.shortest_line(point, np.array(others, dtype=object))
            ways = ways[shapely.length(ways) <= within]
            if len(ways):
                way = shapely.get_coordinates(ways[int(np.argmin(shapely.length(ways)))])
                to_lines.append(way)
    return [*found.values(), *to_lines]


def joint_text(joint: FloatArray) -> str:
    """What is told of a joint (2, 2) [m]."""
    return f"ends {np.hypot(*(joint[1] - joint[0])):.3f} m apart at {place(joint[0])} joined"


def _loose(noded: Any) -> FloatArray:
    """(n, 2) [m] ends of noded lines at which no other line is, and no other part of the same."""
    edges = shapely.get_parts(noded)
    nodes = shapely.get_coordinates([shapely.get_point(edges, k) for k in (0, -1)])
    times = Counter(map(tuple, nodes.tolist()))
    return np.array([node for node, count in times.items() if count == 1]).reshape(-1, 2)


def _nearest_other(ends: FloatArray) -> tuple[FloatArray, IntArray]:
    """(n,) [m] how far the nearest other of some ends (n, 2) is, and its number."""
    if len(ends) < 2:
        return np.full(len(ends), np.inf), np.zeros(len(ends), dtype=np.int64)
    away, found = cKDTree(ends).query(ends, k=2)
    return away[:, 1], np.asarray(found[:, 1])


def _chosen(drawing: Drawing, options: Options, faces: list[Any], noded: Any) -> Any:
    """The face that holds --from, else the path, else a robot; the only one where none is given."""
    paths = sorted(drawing.of("path"), key=lambda one: one.name != "")
    robots = drawing.of("robot")
    if options.origin is not None:
        point = shapely.Point(options.origin)
        held = [face for face in faces if face.covers(point)]
        shape, what = None, f"--from {place(options.origin)}: is"
    elif paths:
        lengths = [face.intersection(paths[0].geometry).length for face in faces]
        best = int(np.argmax(lengths)) if faces else 0
        held = [faces[best]] if faces and lengths[best] > 0.0 else []
        shape, what = paths[0], "the path is"
    elif robots:
        point = robots[0].geometry.representative_point()
        held = [face for face in faces if face.contains(point)]
        shape, what = robots[0], "the robot is"
    else:
        held, shape, what = faces, None, "there is"
    if not held:
        elsewhere = f"; closed elsewhere: {_areas(faces)}" if faces else ""
        there = "in no closed area" if what != "there is" else "no closed area"
        raise drawing.lack(f"{what} {there}{_where_open(noded)}{elsewhere}", shape)
    is_open = what == "there is" and len(_loose(noded)) > 1  # that may be meant to be closed
    if len(held) > 1 or is_open:
        raise drawing.refusal(
            f"which area is the place: {_areas(held)}? Say --from X,Y, or draw a path or a robot "
            f"in it{_where_open(noded) if is_open else ''}"
        )
    return held[0]


def _areas(faces: Sequence[Any]) -> str:
    """The largest of some faces, and how many more there are."""
    largest = sorted(faces, key=shapely.area, reverse=True)[:MOST_NAMED]
    said = [
        f"{one.area:.3g} m² about {place(one.representative_point().coords[0])}" for one in largest
    ]
    more = len(faces) - len(said)
    return ", ".join(said) + (f" and {more} more" if more else "")


def _where_open(noded: Any) -> str:
    """What may be open: the loose ends nearest to each other, and how to close them."""
    ends = _loose(noded)
    away, other = _nearest_other(ends)
    pairs = {(min(k, int(j)), max(k, int(j))): float(away[k]) for k, j in enumerate(other)}
    if len(ends) < 2:
        return ""
    nearest = sorted(pairs.items(), key=lambda one: one[1])[:MOST_NAMED]
    gaps = [f"{place(ends[i])} and {place(ends[j])}, {gap:.3g} m apart" for (i, j), gap in nearest]
    most = float(np.ceil(100.0 * nearest[-1][1]) / 100.0)
    return f"; loose ends: {'; '.join(gaps)}; close them, or --close {most:g}"


def _rings(shape: Shape) -> list[FloatArray]:
    inner = [] if shape.role == "boundary" else shape.geometry.interiors
    return [shape.points, *map(shapely.get_coordinates, inner)]
