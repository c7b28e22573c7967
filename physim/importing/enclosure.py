"""The area that drawn lines enclose, around the reference path; lines away from it are dropped."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress
from operator import not_
from pathlib import Path
from typing import Any

import shapely

from physim.geometry.shapes import FloatArray
from physim.importing.drawing import Drawing, listed, place, refused
from physim.importing.gaps import faces_of, loose_ends

NEAR = 1e-6
"""[m] A line this near the area bounds it."""


def enclose(path: Path, drawing: Drawing, inside: tuple[float, float] | None) -> None:
    """Find the area of a drawing; drop and list the lines that do not bound it.

    The area is the one that `chosen_area` takes. Raises ImportSourceError when nothing is enclosed,
    or neither the reference path nor, without one, the point ``inside``.
    """
    if not drawing.boundaries:
        raise refused(path, "no boundary found; a world needs lines that enclose an area")
    faces = faces_of(drawing.boundaries)
    if not faces:
        raise refused(path, "the boundaries enclose no area; " + _open_ends(drawing.boundaries))
    face = chosen_area(faces, drawing, inside)
    if drawing.reference is not None:
        if face.intersection(shapely.LineString(drawing.reference)).length <= 0.0:
            raise refused(path, "no area that the boundaries enclose contains the path")
    elif inside is not None and not face.contains(shapely.Point(inside)):
        raise refused(path, f"--from {place(inside)}: in no area that the boundaries enclose")
    lines, rings = drawing.boundaries, drawing.obstacles
    near = [face.distance(shapely.LineString(line)) <= NEAR for line in lines]
    solid = [face.intersects(shapely.Polygon(ring)) for ring in rings]
    drawing.changes += listed(list(compress(lines, map(not_, near))), _dropped_boundary)
    drawing.changes += listed(list(compress(rings, map(not_, solid))), _dropped_obstacle)
    drawing.boundaries = list(compress(lines, near))
    drawing.obstacles = list(compress(rings, solid))
    free = face.difference(shapely.union_all([shapely.Polygon(r) for r in drawing.obstacles]))
    if free.is_empty:
        raise refused(path, "the obstacles leave no place for robots; they cover the whole area")
    drawing.area = chosen_area(shapely.get_parts(free), drawing, inside)


def chosen_area(areas: Sequence[Any], drawing: Drawing, inside: tuple[float, float] | None) -> Any:
    """The shapely polygon that is meant for the robots.

    The one that holds the most of the reference path, else the point ``inside`` or is nearest to
    it, else the most robots, else the largest.
    """
    if drawing.reference is not None:
        line = shapely.LineString(drawing.reference)
        return max(areas, key=lambda area: (area.intersection(line).length, area.area))
    if inside is not None:
        point = shapely.Point(inside)
        return min(areas, key=lambda area: (area.distance(point), -area.area))
    robots = [shapely.MultiPoint(one.outline).convex_hull.centroid for one in drawing.robots]
    return max(areas, key=lambda area: (sum(area.contains(r) for r in robots), area.area))


def _dropped_boundary(points: FloatArray) -> str:
    length = shapely.LineString(points).length
    return (
        f"boundary of {length:.2f} m from {place(points[0])} to {place(points[-1])}: away from the "
        "area of the robots, dropped"
    )


def _dropped_obstacle(ring: FloatArray) -> str:
    polygon = shapely.Polygon(ring)
    return (
        f"obstacle of {polygon.area:.3f} m² at {place(polygon.centroid.coords[0])}: away from the "
        "area of the robots, dropped"
    )


def _open_ends(boundaries: list[FloatArray]) -> str:
    """Say which ends of lines lie nearest to each other without meeting."""
    ends, gaps = loose_ends(boundaries)
    if not gaps:
        return "draw them closed"
    gap, i, j = gaps[0]
    return f"the nearest ends, {place(ends[i])} and {place(ends[j])}, are {gap:.3g} m apart"
