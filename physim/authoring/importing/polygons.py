"""Polygons and lines of WKT: an outer ring is a wall, holes are solid, a line is the path.

A polygon is the place where robots may go. Where there are several, the one with the path in it,
that at ``--from``, that with most of the robots, or the largest is taken. Those of GeoJSON
(`physim.authoring.importing.geojson`) may have a role each; geometries are in metres.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import (
    DIGITS,
    LARGEST,
    Drawing,
    DrawnRobot,
    Options,
    is_long,
    listed,
    place,
    refused,
    rounded,
)
from physim.authoring.importing.joining import join_ends
from physim.authoring.importing.path_pieces import take_paths
from physim.authoring.importing.places import chosen_area
from physim.authoring.importing.source import read_text
from physim.authoring.importing.walls import is_thick, made_valid, polygons_of, take_walls
from physim.authoring.importing.work import check_work, depth_of, lines_of
from physim.errors import plural
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray

MOST_GEOMETRIES = 10_000
MOST_DEPTH = 20
"""Geometries within geometries."""
KILOMETRE = 1000.0
DEGREES = (4326, 4258)
"""EPSG codes of degrees that are met most"""
MAYBE_DEGREES = range(4001, 20_000)
"""EPSG codes, the others of degrees among them, and some of metres with places farther away"""
LEAST_CODE = 1024
"""EPSG code of the first system"""
HEIGHTS = "third coordinates (height) left out"
MEASURES = "measures (M) of points left out"


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


def read_wkt(path: Path, options: Options) -> Drawing:
    """Read a WKT file: one geometry, or one a line; ``#`` begins a comment."""
    rows = read_text(path).split("\n")
    texts: list[tuple[int, list[str]]] = []
    opened = 0
    for k, row in enumerate(rows, start=1):
        row = row.split("#", 1)[0].strip().rstrip(";")
        if not row:
            continue
        begins = re.match(r"(SRID\s*=\s*\d+\s*(?:;\s*)?)?[A-Za-z]", row) is not None
        if not texts or (begins and opened <= 0):
            texts.append((k, [row]))
            opened = 0
        else:  # a geometry may go over several lines
            texts[-1][1].append(row)
        opened += row.count("(") - row.count(")")
    if not texts:
        raise refused(path, "holds no geometry; POLYGON ((x y, ...)) is needed")
    parts: list[Part] = []
    srids: dict[str, None] = {}
    for k, rows in texts:
        text = " ".join(rows)
        srid = re.match(r"SRID\s*=\s*(\d+)\s*(?:;\s*)?", text, re.I)
        found = _from_wkt(path, k, text[srid.end() :] if srid else text)
        if srid is not None and (code := srid[1].lstrip("0")[:9]):
            check_codes(path, [int(code)], f"SRID {srid[1]}"[:40], found, options, k)
            srids[f"lengths of its SRID, {srid[1][:30]}, are taken as they are"] = None
        parts += found
    drawing = drawing_of(path, "WKT", parts, options)
    drawing.facts[1:1] = listed([*srids])
    return drawing


def check_codes(
    path: Path,
    codes: Sequence[int],
    named: str,
    parts: list[Part],
    options: Options,
    line: int | None = None,
) -> None:
    """Refuse degrees: known by EPSG codes of the source, or by codes and numbers together.

    With ``--scale`` the user says what a unit is, and the numbers say nothing.
    """
    if {*codes} & {*DEGREES}:
        raise degrees(path, named, line)
    is_known = any(code >= LEAST_CODE for code in codes)
    is_doubtful = not is_known or any(code in MAYBE_DEGREES for code in codes)
    if is_doubtful and options.scale is None and parts:
        points = np.concatenate([shapely.get_coordinates(part.shape) for part in parts])
        if (np.abs(points) <= (180.0, 90.0)).all():
            why = f"{named}, and all within 180 by 90 units; --scale 1 if these are metres"
            raise degrees(path, why, line)


def _from_wkt(path: Path, line: int, text: str) -> list[Part]:
    if "\0" in text:
        raise refused(path, "holds a character NUL, at which programs cease to read", line)
    if text.count("(") > 1_000_000 or depth_of(text) > MOST_DEPTH:
        raise refused(path, f"nested deeper than {MOST_DEPTH} levels", line)
    try:
        with np.errstate(invalid="ignore", over="ignore"):
            shape = shapely.from_wkt(text)
    except (shapely.errors.ShapelyError, ValueError, NotImplementedError) as error:
        reason = escaped(str(error).split(": ", 1)[-1].strip())[:100]
        if "onlinear" in reason:
            reason = "it has curves; make lines of them first (ST_CurveToLine)"
        raise refused(path, f"not valid WKT: {reason}{_missing(text)}", line) from None
    return [Part(one, line=line) for one in flat(shape)]


def _missing(text: str) -> str:
    """``; ...`` for the bracket or comma that seems to be missing; empty where none does."""
    opened, closed = text.count("("), text.count(")")
    if opened != closed:
        side = "closing" if opened > closed else "opening"
        more = "one" if abs(opened - closed) == 1 else abs(opened - closed)
        return f"; a bracket is missing: {opened} opening, {closed} closing; {more} {side} more"
    for point in re.split(r"[(),]", text):
        numbers = point.split()
        if len(numbers) > 3 and not re.search(r"[A-DF-Za-df-z]", point):
            return f'; a comma is missing: "{escaped(point.strip())[:40]}" is more than one point'
    return ""


def flat(shape: Any) -> list[Any]:
    """Single geometries of a shapely one, empty ones left out."""
    if shape is None or shape.is_empty:
        return []
    if hasattr(shape, "geoms"):
        return [one for inner in shape.geoms for one in flat(inner)]
    return [shape]


def degrees(path: Path, why: str, line: int | None = None) -> Exception:
    """Error at a source whose coordinates are no metres, and ``why`` it is known."""
    return refused(
        path,
        f"coordinates are degrees of longitude and latitude ({why}), and a world is in metres; "
        "project them first, e.g. with ogr2ogr -t_srs EPSG:32633 (the UTM zone of the place)",
        line,
    )


def drawing_of(path: Path, kind: str, parts: list[Part], options: Options) -> Drawing:
    """Give every part of a source its place in a drawing [m]; raises ImportSourceError."""
    drawing = Drawing(kind=f"{kind} polygons")
    drawing.facts.append(f"{options.unit:g} m per unit")
    if not parts:
        raise refused(path, "holds no polygon and no line")
    check_count(path, parts)
    origin = _origin([part.shape for part in parts], options.unit)
    if origin.any():
        drawing.facts.append(f"origin moved to {origin[0]:.0f}, {origin[1]:.0f} m of the source")
    shapes = [_scaled(path, part, options.unit, origin, drawing) for part in parts]
    check_work(path, [line for shape in shapes for line in lines_of(shape)])
    polygons: list[Any] = []
    walls: list[Any] = []
    repairs: list[str] = []  # of each of these
    unused: list[str] = []
    paths: list[tuple[str, FloatArray]] = []
    for part, shape in zip(parts, shapes, strict=True):
        if part.role in ("robot", "obstacle") and shape.geom_type == "Polygon" and shape.interiors:
            unused.append(f"{part.role} at {place(_ring(shape)[0])}: solid, its holes filled")
        if shape.geom_type in ("LineString", "LinearRing"):
            _line(drawing, part, rounded(shapely.get_coordinates(shape)), paths, unused)
        elif shape.geom_type != "Polygon":
            at = place(shapely.get_coordinates(shape)[0])
            unused.append(f"{shape.geom_type} at {at}: holds no lines, left out")
        elif part.role == "robot":
            drawing.robots.append(DrawnRobot(drawing.free_name(part.name), _ring(shape)))
        elif part.role == "obstacle":
            drawing.obstacles.append(_ring(shape))
        elif part.role == "wall":
            walls += [shape] if is_thick(shape) else []
            for line in [] if is_thick(shape) else lines_of(shape):
                _line(drawing, part, rounded(line), paths, unused)
        else:
            found, repair = _valid(path, shape, part.line, drawing)
            polygons += found
            repairs += [repair] * len(found)
    take_paths(drawing, paths)
    take_walls(drawing, walls)
    drawing.changes += listed(unused)
    if polygons:
        chosen = chosen_area(polygons, drawing, options.origin)
        taken = next(k for k, one in enumerate(polygons) if one is chosen)
        drawing.repairs += filter(None, [repairs[taken]])
        drawing.within = shapely.Polygon(chosen.exterior, [*filter(is_long, chosen.interiors)])
        drawing.changes += listed(polygons[:taken] + polygons[taken + 1 :], _left_out)
        drawing.add_outline(chosen)
    elif not drawing.boundaries:
        raise refused(path, "holds no polygon; one says where robots may go")
    else:
        drawing.changes += join_ends(drawing.boundaries)
    return drawing


def check_count(path: Path, parts: list[Part]) -> None:
    """Refuse more geometries than are read."""
    if len(parts) > MOST_GEOMETRIES:
        raise refused(path, f"more than {MOST_GEOMETRIES} geometries")


def _origin(shapes: list[Any], scale: float) -> FloatArray:
    """(2,) [m] to be taken from all coordinates: whole kilometres, as national grids need; else 0.

    Only where the place itself is no larger than coordinates may be.
    """
    points = shapely.get_coordinates(shapes) * scale
    if np.isfinite(points).all() and np.abs(points).max() > LARGEST >= np.ptp(points, axis=0).max():
        return np.asarray(np.floor(points.min(axis=0) / KILOMETRE) * KILOMETRE)
    return np.zeros(2)


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


def _line(
    drawing: Drawing,
    part: Part,
    points: FloatArray,
    paths: list[tuple[str, FloatArray]],
    unused: list[str],
) -> None:
    """A wall, or a piece of a path; only what has that role has the name of a robot."""
    if len(points) < 2:
        unused.append(f"line of no length at {place(points[0])}: left out")
    elif part.role in ("boundary", "wall"):
        drawing.boundaries.append(points)
    else:
        paths.append((part.name if part.role == "path" else "", points))


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
