"""The area that drawn lines enclose, around the reference path; lines away from it are dropped."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.ops import polygonize, unary_union

from physim.geometry.shapes import FloatArray
from physim.importing.drawing import Drawing, listed, place, refused

NEAR = 1e-6
"""[m] A line this near the area bounds it."""


def enclose(path: Path, drawing: Drawing, inside: FloatArray | None = None) -> None:
    """Find the area of a drawing; drop and list the lines that do not bound it.

    The area is the face that holds the most of the reference path, else the point ``inside``,
    else the most robots, else the largest. Raises ImportSourceError when nothing is enclosed.
    """
    if not drawing.boundaries:
        raise refused(path, "no boundary found; a world needs lines that close an area")
    lines = [shapely.LineString(line) for line in drawing.boundaries]
    faces = list(polygonize(unary_union(lines)))
    if not faces:
        raise refused(path, "the boundaries enclose no area; " + _open_ends(drawing.boundaries))
    face = _chosen(path, faces, drawing, inside)
    outline = face.boundary
    kept, dropped = [], []
    for line, points in zip(lines, drawing.boundaries, strict=True):
        if outline.distance(line) <= NEAR or face.intersects(line):
            kept.append(points)
        else:
            dropped.append(
                f"boundary of {line.length:.2f} m from {place(points[0])} to {place(points[-1])}: "
                "away from the area of the robots, dropped"
            )
    drawing.boundaries = kept
    solid, away = [], []
    for ring in drawing.obstacles:
        polygon = shapely.Polygon(ring)
        if face.intersects(polygon):
            solid.append(ring)
        else:
            away.append(
                f"obstacle of {polygon.area:.3f} m² at {place(polygon.centroid.coords[0])}: away "
                "from the area of the robots, dropped"
            )
    drawing.obstacles = solid
    drawing.changes += listed(dropped) + listed(away)
    free = face.difference(unary_union([shapely.Polygon(ring) for ring in solid]))
    if free.is_empty:
        raise refused(path, "the obstacles leave no place for robots; they cover the whole area")
    drawing.area = _largest(free, drawing.reference, inside)


def _chosen(path: Path, faces: list[Any], drawing: Drawing, inside: FloatArray | None) -> Any:
    if drawing.reference is not None:
        line = shapely.LineString(drawing.reference)
        face = max(faces, key=lambda f: float(f.intersection(line).length))
        if face.intersection(line).length <= 0.0:
            raise refused(path, "no area that the boundaries enclose contains the path")
        return face
    if inside is not None:
        holding = [f for f in faces if f.contains(shapely.Point(inside))]
        if not holding:
            raise refused(path, f"--from {place(inside)}: in no area that the boundaries enclose")
        return holding[0]
    robots = [shapely.Polygon(robot.outline).centroid for robot in drawing.robots]
    return max(faces, key=lambda f: (sum(f.contains(r) for r in robots), f.area))


def _largest(free: Any, reference: FloatArray | None, inside: FloatArray | None) -> Any:
    """The part that the path or point is in; a drawing may be cut in two by its obstacles."""
    parts = shapely.get_parts(free)
    if reference is not None:
        line = shapely.LineString(reference)
        return max(parts, key=lambda p: float(p.intersection(line).length))
    if inside is not None:
        return min(parts, key=lambda p: (float(p.distance(shapely.Point(inside))), -p.area))
    return max(parts, key=lambda p: float(p.area))


def _open_ends(boundaries: list[FloatArray]) -> str:
    """Say which ends of lines lie nearest to each other without meeting."""
    ends = [p for line in boundaries if (line[0] != line[-1]).any() for p in (line[0], line[-1])]
    if len(ends) < 2:
        return "draw them closed"
    points = np.array(ends)
    gap = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    np.fill_diagonal(gap, np.inf)
    i, j = (int(k) for k in np.unravel_index(int(np.argmin(gap)), gap.shape))
    return (
        f"the nearest ends, {place(points[i])} and {place(points[j])}, are {gap[i, j]:.3g} m apart"
    )
