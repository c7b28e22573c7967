"""Polygons and lines of a source, with a role each or none: what each is in a drawing.

An outer ring is a wall, holes are solid; a line without a role is the path, unless another has that
role, and a polygon without one says where robots may go.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import (
    DIGITS,
    LARGEST,
    Drawing,
    DrawnRobot,
    grid_origin,
    is_long,
    listed,
    moved_to,
    place,
    refused,
    rounded,
)
from physim.authoring.importing.joining import OUTSIDE, beyond_of, join_ends, knit
from physim.authoring.importing.options import Options
from physim.authoring.importing.outlines import drop_marks
from physim.authoring.importing.path_pieces import take_paths
from physim.authoring.importing.places import OTHERS, chosen_area
from physim.authoring.importing.roles import nearest_role
from physim.authoring.importing.walls import is_thick, made_valid, polygons_of, take_walls
from physim.authoring.importing.work import check_work, lines_of
from physim.errors import plural
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray

HEIGHTS = "third coordinates (height) left out"
MEASURES = "measures (M) of points left out"
MOST_GEOMETRIES = 10_000


@dataclass(frozen=True)
class Part:
    """A shapely polygon or line, its role ("" if none is said) and name, and where it stands.

    ``layer`` is the name of its layer, where that says no role.
    """

    shape: Any
    role: str = ""
    name: str = ""
    line: int | None = None
    layer: str = ""


def drawing_of(path: Path, kind: str, parts: list[Part], options: Options) -> Drawing:
    """Give every part of a source its place in a drawing [m]; raises ImportSourceError."""
    drawing = Drawing(kind=f"{kind} polygons")
    drawing.facts.append(f"{options.unit:g} m per unit")
    if not parts:
        raise refused(path, "holds no polygon and no line")
    check_count(path, parts)
    origin = grid_origin(shapely.get_coordinates([part.shape for part in parts]) * options.unit)
    drawing.facts += moved_to(origin)
    shapes = [_scaled(path, part, options.unit, origin, drawing) for part in parts]
    check_work(path, [line for shape in shapes for line in lines_of(shape)])
    found = _sorted(path, drawing, parts, shapes)
    drop_marks(drawing)
    take_paths(drawing, found.paths)
    take_walls(drawing, found.walls)
    drawing.changes += listed(found.unused)
    if found.polygons:
        _take_area(path, drawing, found.polygons, options)
    elif not drawing.boundaries:
        layers = sorted({part.layer for part in parts if part.layer})
        named = f'; the layer "{escaped(layers[0])[:40]}" is no role' if layers else ""
        near = nearest_role(layers[0]) if layers else ""
        message = "holds no polygon; one says where robots may go"
        raise refused(path, f"{message}{named}{near}", parts[0].line if layers else None)
    else:
        drawing.changes += join_ends(drawing.boundaries)
    return drawing


@dataclass(frozen=True)
class _Polygon:
    """A polygon where robots may be allowed [m], the part it is of, and how that was repaired."""

    shape: Any
    part: Part
    repair: str


@dataclass(frozen=True)
class _Sorted:
    """Parts by what they are: walls, pieces of paths by name, and what is said of those unused."""

    polygons: list[_Polygon] = field(default_factory=list)
    walls: list[Any] = field(default_factory=list)
    paths: list[tuple[str, FloatArray]] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)


def _sorted(path: Path, drawing: Drawing, parts: list[Part], shapes: list[Any]) -> _Sorted:
    """Parts, whose shapes are in metres, by what they are; robots and obstacles in the drawing."""
    found = _Sorted()
    has_path = any(part.role == "path" for part in parts)
    for part, shape in zip(parts, shapes, strict=True):
        if part.role in ("robot", "obstacle") and shape.geom_type == "Polygon" and shape.interiors:
            at = place(_ring(shape)[0])
            found.unused.append(f"{part.role} at {at}: solid, its holes filled")
        if shape.geom_type in ("LineString", "LinearRing"):
            line = rounded(shapely.get_coordinates(shape))
            if has_path and not part.role:
                told = f"line from {place(line[0])}: no role, left out; a path has one"
                found.unused.append(told)
            else:
                _line(drawing, part, line, found)
        elif shape.geom_type != "Polygon":
            at = place(shapely.get_coordinates(shape)[0])
            found.unused.append(f"{shape.geom_type} at {at}: holds no lines, left out")
        elif part.role == "robot":
            drawing.robots.append(DrawnRobot(_ring(shape), part.name))
        elif part.role == "obstacle":
            drawing.obstacles.append(_ring(shape))
        elif part.role == "wall":
            found.walls.extend([shape] if is_thick(shape) else [])
            for line in [] if is_thick(shape) else lines_of(shape):
                _line(drawing, part, rounded(line), found)
        else:
            whole, repair = _valid(path, shape, part.line, drawing)
            found.polygons.extend(_Polygon(one, part, repair) for one in whole)
    return found


def _take_area(path: Path, drawing: Drawing, polygons: list[_Polygon], options: Options) -> None:
    """Take the polygon that is meant for the robots, of those with a role if there are any."""
    some = [one for one in polygons if one.part.role] or polygons
    chosen = chosen_area([one.shape for one in some], drawing, options.origin)
    taken = next(one for one in polygons if one.shape is chosen)
    drawing.repairs += filter(None, [taken.repair])
    if len(polygons) > 1:
        drawing.repairs.append(
            f"{plural(len(polygons), 'polygon')}, each an area of its own; dissolve those that "
            "are one place"
        )
    if not taken.part.role:
        _check_place(path, drawing, taken.part, chosen, options)
    drawing.within = shapely.Polygon(chosen.exterior, [*filter(is_long, chosen.interiors)])
    drawing.changes += listed([one.shape for one in polygons if one is not taken], _left_out)
    drawing.add_outline(chosen)
    knit(drawing.boundaries)


def _check_place(path: Path, drawing: Drawing, part: Part, polygon: Any, options: Options) -> None:
    """Refuse a polygon without a role as the place, where walls that have one lie beyond it.

    It may be a table in a room. Not where the path, a robot or --from is in it.
    """
    said = [shapely.Point(options.origin)] if options.origin is not None else []
    said += [shapely.Polygon(one.outline).centroid for one in drawing.robots]
    said += [shapely.LineString(drawing.reference)] if drawing.reference is not None else []
    if any(polygon.intersects(one) for one in said):
        return
    solid = [one.boundary for one in drawing.solids]
    every = [shapely.LineString(line) for line in drawing.boundaries]
    outlines = beyond_of(polygon, solid)
    lines = beyond_of(polygon, every) - outlines
    if max(lines / OUTSIDE, outlines / OTHERS) > polygon.exterior.length:
        at = place(polygon.representative_point().coords[0])
        raise refused(
            path,
            f"the polygon of {polygon.area:.3g} m² about {at} has no role, and there are walls "
            "beyond it: it has the role boundary if robots may go in it alone, obstacle if not",
            part.line,
        )


def check_count(path: Path, parts: list[Part]) -> None:
    """Refuse more geometries than are read."""
    if len(parts) > MOST_GEOMETRIES:
        raise refused(path, f"more than {MOST_GEOMETRIES} geometries")


def _scaled(path: Path, part: Part, scale: float, origin: FloatArray, drawing: Drawing) -> Any:
    """Shape of a part in metres from an origin, without heights.

    Raises ImportSourceError for what is too far.
    """
    flat_part = shapely.force_2d(part.shape)
    shape = shapely.transform(flat_part, lambda points: points * scale - origin)
    points = shapely.get_coordinates(shape)
    if not np.isfinite(points).all():
        raise refused(path, "a coordinate is not a finite number", part.line)
    if np.abs(points).max() > LARGEST:
        raise refused(
            path,
            f"a coordinate of {np.abs(points).max():g} m is beyond {LARGEST:g} m; check "
            "--scale, or leave out what lies far away",
            part.line,
        )
    for is_there, told in ((part.shape.has_z, HEIGHTS), (part.shape.has_m, MEASURES)):
        if is_there and told not in drawing.changes:
            drawing.changes.append(told)
    return shape


def _left_out(polygon: Any) -> str:
    at = place(polygon.representative_point().coords[0])
    return f"polygon of {polygon.area:.3f} m² at {at}: not the area of the robots, left out"


def _ring(shape: Any) -> FloatArray:
    """Corners (n, 2) [m] of a polygon's outline, the first not repeated; one of a mere grain."""
    points = rounded(shapely.get_coordinates(shape.exterior))
    return points[:-1] if len(points) > 1 else points


def _line(drawing: Drawing, part: Part, points: FloatArray, found: _Sorted) -> None:
    """A wall, or a piece of a path; only what has that role has the name of a robot."""
    if len(points) < 2:
        found.unused.append(f"line of no length at {place(points[0])}: left out")
    elif part.role in ("boundary", "wall"):
        drawing.boundaries.append(points)
    else:
        found.paths.append((part.name if part.role == "path" else "", points))


def _valid(path: Path, shape: Any, line: int | None, drawing: Drawing) -> tuple[list[Any], str]:
    """Polygon on the millimetre grid, in parts where it has necks narrower than that.

    And how one was repaired that crosses itself, which is reported; else empty.
    """
    drawn, repair = shape, ""
    if not shape.is_valid:
        reason = shapely.is_valid_reason(shape)
        shape = made_valid(shape)
        if not (parts := polygons_of(shape)):
            raise refused(path, f"a polygon encloses no area ({reason})", line)
        repair = f"polygon repaired ({reason}): {plural(len(parts), 'part')}"
        drawing.changes.append(repair)
    whole = polygons_of(shapely.set_precision(shape, 10.0**-DIGITS))
    if not whole:
        raise refused(path, "a polygon is smaller than a millimetre; check --scale", line)
    if (walls := _lost_walls(drawn, whole)) is not None:
        drawing.changes.append(walls)
    if shape.geom_type == "Polygon" and len(whole) > 1:
        drawing.changes.append(
            f"polygon in {len(whole)} parts: what lies between them is narrower than a millimetre"
        )
    return whole, repair


def _lost_walls(drawn: Any, whole: list[Any]) -> str | None:
    """What is to be said of lines of a polygon that are none of what became of it, but within it.

    By the corners and middles of its lines, farther from all that is left than rounding moves them.
    """
    lines = lines_of(drawn)
    points = np.vstack([one for line in lines for one in (line, (line[1:] + line[:-1]) / 2.0)])
    within = points[shapely.contains_xy(shapely.MultiPolygon(whole), points)]
    sides = shapely.STRtree(_sides([line for one in whole for line in lines_of(one)]))
    _, away = sides.query_nearest(shapely.points(within), return_distance=True, all_matches=False)
    lost = within[away > 2.0 * 10.0**-DIGITS]
    if not len(lost):
        return None
    return f"walls thinner than a millimetre: left out, the first at {place(lost[0])}"


def _sides(lines: list[FloatArray]) -> Any:
    return np.concatenate([shapely.linestrings(np.stack([a[:-1], a[1:]], axis=1)) for a in lines])
