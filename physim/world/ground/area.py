"""The accessible area and its safe part.

The accessible area is the bounded face between the boundaries that contains the reference path,
less the obstacles. A point of it is *safe* when it is at least L from every boundary.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry import LineString, MultiPolygon, Polygon
from shapely.ops import unary_union

from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world.ground.lines import joined, simplified

ROUND_SEGMENTS = 16
"""Segments a quarter circle of the drawn safe area. Its edge errs either way: 0.0012 L by these
chords, and by what shapely drops of the outline before (below 0.01 L; 0.0026 L in ten_robots)."""

MANY = 1_000
"""Points of an outline beyond which it is simplified before it is shrunk."""

SIMPLER = 1e-4
"""How far that moves an outline at most, as a share of the distance by which it is shrunk."""

LONGEST = 60_000
"""Points of an outline beyond which its lines are simplified in runs, for what that costs."""

STRETCH = 8
"""Edges of an outline that are grown together where it still has `MANY` points."""

SMALL = 0.05
"""Extent of such a stretch, as a share of the distance, up to which its convex hull stands for it.
No point of a hull is farther than half of that from a point of the wall, at a right angle or more
to the way out: the safe area loses at most SMALL^2 / 8 = 0.0003 of the distance."""

NEAR_EDGE = 1e-6
"""[m] A line farther than this from the edge lies on one side of it, however its points are
rounded."""


@dataclass(frozen=True)
class Area:
    """The accessible face of a world, world frame [m].

    ``inner`` are the boundaries that stand in it and enclose nothing, such as a wall between two
    rooms that ends at a door: places near them are not safe, but no edge of the polygon.
    """

    polygon: Polygon
    inner: shapely.Geometry = field(default_factory=shapely.MultiLineString)

    @property
    def accessible_rings(self) -> list[FloatArray]:
        """Outer ring first, then holes; each (n, 2), first point not repeated."""
        return _rings(self.polygon)

    def safe_rings(self, safe_distance: float) -> list[FloatArray]:
        """Rings of the points at least ``safe_distance`` from every boundary, for pictures."""
        return _rings(self.shrunk(safe_distance, ROUND_SEGMENTS))

    def shrunk(self, distance: float, round_segments: int) -> Polygon | MultiPolygon:
        """What is at least ``distance`` [m] from every boundary; see `shrunk`."""
        kept = shrunk(self.polygon, distance, round_segments)
        if self.inner.is_empty:
            return kept
        return kept.difference(grown(self.inner, distance, round_segments))

    def outside_stretches(self, points: FloatArray) -> FloatArray:
        """(M, 2) [m] stretches of a path, from station to station, outside the area.

        A path that keeps away from the edge, as most do, costs one look at a tree of the edge;
        any other a time quadratic in its points.
        """
        line, edge = LineString(points), self._edge
        begins_inside = self.polygon.covers(shapely.get_point(line, 0))
        if begins_inside and not shapely.dwithin(edge, line, NEAR_EDGE):
            return np.zeros((0, 2))
        ends = {0.0, line.length}
        if line.is_simple:
            for piece in shapely.get_parts(self.polygon.intersection(line)):
                ends.update(line.project(shapely.points(shapely.get_coordinates(piece))).tolist())
        else:  # where it passes itself a place has several stations: leg by leg
            points = shapely.get_coordinates(line)
            begin = np.cumsum([0.0, *np.hypot(*np.diff(points, axis=0).T)])
            for start, leg in zip(begin, map(LineString, pairwise(points)), strict=False):
                if shapely.dwithin(edge, leg, NEAR_EDGE):
                    cut = shapely.get_coordinates(self.polygon.intersection(leg))
                    found = shapely.line_locate_point(leg, shapely.points(cut))
                    ends.update((start + found).tolist())
        stations = np.array(sorted(ends))
        middle = line.interpolate((stations[:-1] + stations[1:]) / 2.0)
        outside = ~shapely.covers(self.polygon, middle) & (np.diff(stations) > LENGTH)
        return np.stack([stations[:-1][outside], stations[1:][outside]], axis=1)

    @cached_property
    def _edge(self) -> shapely.Geometry:
        """The edge; it and the polygon are prepared for many questions."""
        edge = self.polygon.boundary
        shapely.prepare([self.polygon, edge])
        return edge


def accessible_area(
    boundaries: Sequence[FloatArray], obstacles: Sequence[FloatArray], reference: FloatArray
) -> Area:
    """Find the face that contains the reference path; where boundaries touch, see `joined`.

    Raises ValueError when the boundaries close no face around it.
    """
    noded = unary_union([LineString(line) for line in joined(boundaries)])
    of_faces, cuts, dangles, _ = shapely.polygonize_full([noded])
    faces = list(shapely.get_parts(of_faces))
    if not faces:
        raise ValueError("the boundaries enclose no area")
    line = LineString(reference)
    face = max(faces, key=lambda polygon: float(polygon.intersection(line).length))
    if face.intersection(line).length <= 0.0:
        raise ValueError("no area enclosed by the boundaries contains the reference path")
    free = face.difference(united([Polygon(ring) for ring in obstacles]))
    if free.is_empty:
        raise ValueError("the obstacles leave nothing of the area around the reference path")
    parts = shapely.get_parts(free)
    polygon = max(parts, key=lambda polygon: float(polygon.intersection(line).length))
    loose = [*shapely.get_parts(cuts), *shapely.get_parts(dangles)]
    return Area(polygon, inner_lines(polygon, loose))


def united(solids: Sequence[Polygon]) -> shapely.Geometry:
    """What solids cover together [m], on a grid of ``LENGTH``.

    Without one GEOS (up to 3.14 at least) loses some of those that touch, as in a row of shelves.
    """
    return shapely.union_all(solids, grid_size=LENGTH)


def inner_lines(polygon: Polygon, lines: Sequence[LineString]) -> shapely.Geometry:
    """What of lines runs inside a polygon, beside its edge."""
    near = [line for line in lines if line.intersects(polygon)]
    if not near:
        return shapely.MultiLineString()
    inside = unary_union(near).intersection(polygon).difference(polygon.boundary)
    parts = shapely.get_parts(inside)
    return shapely.multilinestrings(parts[shapely.length(parts) > LENGTH])


def shrunk(shape: Polygon, distance: float, round_segments: int) -> Polygon | MultiPolygon:
    """What of a polygon is at least ``distance`` [m] from its edge; quarter circles are cut into
    ``round_segments``.

    Finely drawn outlines are simplified first. What shapely drops of an outline adds up where its
    points lie close: of a road of 6 m with 5,000 points a wall it lost 8 % at 1 m where the walls
    wound, and everything where they were straight. Where an outline is rough, as a scanner sees a
    wall, the arcs around its points cross each other in pairs: 10 GB for 100,000 points 1.2 mm
    apart. Such a one is grown in stretches, and taken away.
    """
    if shapely.get_num_coordinates(shape) > LONGEST:
        return shape.difference(grown(shape.boundary, distance, round_segments))
    if shapely.get_num_coordinates(shape) > MANY:
        shape = shape.simplify(SIMPLER * distance)
    if shapely.get_num_coordinates(shape) <= MANY:
        return shape.buffer(-distance, quad_segs=round_segments)
    return shape.difference(_grown_in_stretches(shape.boundary, distance, round_segments))


def grown(lines: shapely.Geometry, distance: float, round_segments: int) -> shapely.Geometry:
    """What is nearer than ``distance`` [m] to lines, as `shrunk` takes it away from an edge."""
    if shapely.get_num_coordinates(lines) > MANY:
        every = map(shapely.get_coordinates, shapely.get_parts(lines))
        lines = shapely.multilinestrings([LineString(simplified(one, SIMPLER * distance))
                                          for one in every])  # fmt: skip
    if shapely.get_num_coordinates(lines) <= MANY:
        return lines.buffer(distance, quad_segs=round_segments)
    return _grown_in_stretches(lines, distance, round_segments)


def _grown_in_stretches(
    lines: shapely.Geometry, distance: float, round_segments: int
) -> shapely.Geometry:
    stretches = np.array(
        [
            LineString(points[k : k + STRETCH + 1])
            for points in map(shapely.get_coordinates, shapely.get_parts(lines))
            for k in range(0, len(points) - 1, STRETCH)
        ]
    )
    low_x, low_y, high_x, high_y = shapely.bounds(stretches).T
    small = np.hypot(high_x - low_x, high_y - low_y) <= SMALL * distance
    stretches[small] = shapely.convex_hull(stretches[small])
    return shapely.union_all(shapely.buffer(stretches, distance, quad_segs=round_segments))


def _rings(shape: Polygon | MultiPolygon) -> list[FloatArray]:
    rings = []
    for polygon in shapely.get_parts(shape):
        if polygon.geom_type == "Polygon" and not polygon.is_empty:
            rings += [np.array(r.coords)[:-1] for r in (polygon.exterior, *polygon.interiors)]
    return rings
