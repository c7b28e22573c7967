"""Polygons and lines of WKT and GeoJSON: an outer ring is a wall, holes are solid, a line the path.

A polygon is the place where robots may go. Where there are several, the one with the path in it,
that at ``--from``, that with most of the robots, or the largest is taken. Features of GeoJSON may
have a role each; geometries are in metres.
"""

from __future__ import annotations

import json
import re
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
    listed,
    place,
    refused,
    rounded,
)
from physim.authoring.importing.enclosure import chosen_area, join_ends
from physim.authoring.importing.source import read_text
from physim.authoring.importing.work import check_work, depth_of, lines_of
from physim.errors import nearest
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray

MOST_GEOMETRIES = 10_000
MOST_DEPTH = 20
"""Geometries within geometries."""
HEIGHTS = "third coordinates (height) left out"


@dataclass(frozen=True)
class Part:
    """A shapely polygon or line, its role ("" if none is said) and name, and where it stands."""

    shape: Any
    role: str = ""
    name: str = ""
    line: int | None = None


def read_wkt(path: Path, options: Options) -> Drawing:
    """Read a WKT file: one geometry, or one a line; ``#`` begins a comment."""
    rows = read_text(path).split("\n")
    texts: list[tuple[int, str]] = []
    for k, row in enumerate(rows, start=1):
        row = row.split("#", 1)[0].strip().rstrip(";")
        if not row:
            continue
        if re.match(r"(SRID\s*=\s*\d+\s*;?\s*)?[A-Za-z]", row) or not texts:
            texts.append((k, row))
        else:  # a geometry may go over several lines
            texts[-1] = (texts[-1][0], f"{texts[-1][1]} {row}")
    if not texts:
        raise refused(path, "holds no geometry; POLYGON ((x y, ...)) is needed")
    parts: list[Part] = []
    for k, text in texts:
        parts += _from_wkt(path, k, text)
    return drawing_of(path, "WKT", parts, options)


def _from_wkt(path: Path, line: int, text: str) -> list[Part]:
    srid = re.match(r"SRID\s*=\s*(\d+)\s*;?\s*", text, re.I)
    if srid is not None:
        if srid[1] in ("4326", "4258"):
            raise degrees(path, f"SRID {srid[1]}", line)
        text = text[srid.end() :]
    if text.count("(") > 1_000_000 or depth_of(text) > MOST_DEPTH:
        raise refused(path, f"nested deeper than {MOST_DEPTH} levels", line)
    try:
        with np.errstate(invalid="ignore"):
            shape = shapely.from_wkt(text)
    except (shapely.errors.ShapelyError, ValueError, NotImplementedError) as error:
        reason = escaped(str(error).split(": ", 1)[-1].strip())[:100]
        raise refused(path, f"not valid WKT: {reason}{_missing(text)}", line) from None
    return [Part(one, line=line) for one in flat(shape)]


def _missing(text: str) -> str:
    """``; ...`` for the bracket or comma that seems to be missing; empty where none does."""
    opened, closed = text.count("("), text.count(")")
    if opened != closed:
        side = "closing" if opened > closed else "opening"
        return f"; a bracket is missing: {opened} opening, {closed} closing; one {side} more"
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
    if len(parts) > MOST_GEOMETRIES:
        raise refused(path, f"{len(parts)} geometries; at most {MOST_GEOMETRIES} are read")
    shapes = [_scaled(path, part, options.unit, drawing) for part in parts]
    check_work(path, [line for shape in shapes for line in lines_of(shape)])
    polygons: list[Any] = []
    unused: list[str] = []
    for part, shape in zip(parts, shapes, strict=True):
        if shape.geom_type in ("LineString", "LinearRing"):
            _line(drawing, part, rounded(shapely.get_coordinates(shape)), unused)
        elif shape.geom_type != "Polygon":
            at = place(shapely.get_coordinates(shape)[0])
            unused.append(f"{shape.geom_type} at {at}: holds no lines, left out")
        elif part.role == "robot":
            name = part.name or f"r{len(drawing.robots) + 1}"
            drawing.robots.append(DrawnRobot(name, _ring(shape)))
        elif part.role == "obstacle":
            drawing.obstacles.append(_ring(shape))
        else:
            polygons.append(_valid(path, shape, part.line, drawing))
    drawing.changes += listed(unused)
    if polygons:
        chosen = chosen_area(polygons, drawing, options.origin)
        drawing.changes += listed([one for one in polygons if one is not chosen], _left_out)
        drawing.add_outline(chosen)
    elif not drawing.boundaries:
        raise refused(path, "holds no polygon; one says where robots may go")
    else:
        drawing.changes += join_ends(drawing.boundaries)
    return drawing


def _scaled(path: Path, part: Part, scale: float, drawing: Drawing) -> Any:
    """Shape of a part in metres, without heights. Raises ImportSourceError for what is too far."""
    shape = shapely.transform(shapely.force_2d(part.shape), lambda points: points * scale)
    points = shapely.get_coordinates(shape)
    if not np.isfinite(points).all():
        raise refused(path, "a coordinate is not a finite number", part.line)
    if np.abs(points).max() > LARGEST:
        raise refused(
            path,
            f"a coordinate of {np.abs(points).max():g} m is beyond {LARGEST:g} m; move the origin, "
            "or check --scale",
            part.line,
        )
    if part.shape.has_z and HEIGHTS not in drawing.changes:
        drawing.changes.append(HEIGHTS)
    return shape


def _left_out(polygon: Any) -> str:
    at = place(polygon.representative_point().coords[0])
    return f"polygon of {polygon.area:.3f} m² at {at}: not the area of the robots, left out"


def _ring(shape: Any) -> FloatArray:
    """Corners (n, 2) [m] of a polygon's outline, the first not repeated; one of a mere grain."""
    points = rounded(shapely.get_coordinates(shape.exterior))
    return points[:-1] if len(points) > 1 else points


def _line(drawing: Drawing, part: Part, points: FloatArray, unused: list[str]) -> None:
    if len(points) < 2:
        unused.append(f"line of no length at {place(points[0])}: left out")
    elif part.role in ("boundary", "wall"):
        drawing.boundaries.append(points)
    elif part.name and part.role == "path" and part.name in {r.name for r in drawing.robots}:
        drawing.paths[part.name] = points
    elif drawing.reference is None:
        drawing.reference = points
    else:
        unused.append(f"second line from {place(points[0])} to {place(points[-1])}: left out")


def _valid(path: Path, shape: Any, line: int | None, drawing: Drawing) -> Any:
    """Polygon on the millimetre grid; one that crosses itself is repaired, which is reported."""
    if not shape.is_valid:
        reason = shapely.is_valid_reason(shape)
        valid = _polygons_of(shapely.make_valid(shape))
        if not valid:
            raise refused(path, f"a polygon encloses no area ({reason})", line)
        shape = max(valid, key=shapely.area)
        drawing.changes.append(
            f"polygon repaired ({reason}): {len(valid)} parts, the largest of {shape.area:.3f} m² "
            "is kept"
        )
    whole = _polygons_of(shapely.set_precision(shape, 10.0**-DIGITS))
    if not whole:
        raise refused(path, "a polygon is smaller than a millimetre; check --scale", line)
    return max(whole, key=shapely.area)


def _polygons_of(shape: Any) -> list[Any]:
    """Polygons with area among the parts of a shape."""
    return [one for one in shapely.get_parts(shape) if one.geom_type == "Polygon" and one.area > 0]


DEGREES = ("crs84", "epsg:4326", "epsg::4326", "epsg/0/4326", "epsg:4258", "epsg::4258")
ROLES = ("boundary", "obstacle", "path", "robot")
COLLECTIONS = {"FeatureCollection": "features", "GeometryCollection": "geometries"}


def read_geojson(path: Path, options: Options) -> Drawing:
    """Read a GeoJSON file in metres; degrees are refused."""
    text = read_text(path)
    try:
        value = json.loads(text, parse_constant=_not_finite)
    except json.JSONDecodeError as error:
        raise refused(path, f"not valid JSON: {error.msg}", error.lineno) from None
    except RecursionError:
        raise refused(path, "nested too deeply") from None
    except ValueError as error:
        raise refused(path, escaped(str(error))[:100]) from None
    if not isinstance(value, dict) or "type" not in value:
        raise refused(path, 'not GeoJSON: an object with "type" is needed')
    crs = json.dumps(value.get("crs") or "").lower()
    if any(name in crs for name in DEGREES):
        raise degrees(path, "the crs of the file")
    parts = list(_features(path, value, "", "", 0))
    if options.scale is None and len(crs) < 3 and parts:
        _check_degrees(path, parts)
    return drawing_of(path, "GeoJSON", parts, options)


def _not_finite(word: str) -> float:
    raise ValueError(f"{word} is not a finite number; coordinates are finite")


def _features(path: Path, value: Any, role: str, name: str, depth: int) -> Any:
    """Every polygon and line below a GeoJSON object."""
    if depth > MOST_DEPTH:
        raise refused(path, f"nested deeper than {MOST_DEPTH} levels")
    if not isinstance(value, dict):
        raise refused(path, "not GeoJSON: a feature or geometry is an object")
    kind = str(value.get("type"))
    if kind in COLLECTIONS:
        entries = value.get(COLLECTIONS[kind])
        if not isinstance(entries, list):
            raise refused(path, f'not GeoJSON: "{COLLECTIONS[kind]}" must be a list')
        for one in entries:
            yield from _features(path, one, role, name, depth + 1)
    elif kind == "Feature":
        about = value.get("properties")
        about = about if isinstance(about, dict) else {}
        own = _role(path, about)
        label = escaped(str(about.get("name", value.get("id", "")) or ""))[:80]
        if value.get("geometry") is not None:
            yield from _features(path, value["geometry"], own, label, depth + 1)
    else:
        for one in flat(_shape(path, value)):
            _check_role(path, one, role)
            yield Part(one, role, name)


def _role(path: Path, about: dict[str, Any]) -> str:
    """What a feature is for, by its property ``role``, else by ``layer`` where that is a role.

    A role that is none is refused, and so is a layer that seems to be one misspelt.
    """
    given = about.get("role")
    own = str(given if given is not None else about.get("layer") or "").strip().lower()
    own = "boundary" if own == "wall" else own
    near = nearest(own, list(ROLES))
    if own and own not in ROLES and (given is not None or near):
        key = "role" if given is not None else "layer"
        raise refused(path, f'{key}: "{escaped(own)[:40]}" is none of {", ".join(ROLES)}{near}')
    return own if own in ROLES else ""


def _check_role(path: Path, shape: Any, role: str) -> None:
    """Refuse a line where an outline is needed, and an outline where a line is."""
    is_line = shape.geom_type in ("LineString", "LinearRing")
    if is_line and role in ("obstacle", "robot"):
        raise refused(path, f'a {shape.geom_type} has the role "{role}"; that is a Polygon')
    if shape.geom_type == "Polygon" and role == "path":
        raise refused(path, 'a Polygon has the role "path"; that is a LineString')


def _shape(path: Path, value: dict[str, Any]) -> Any:
    """Geometry with coordinates as a shapely one."""
    kind = escaped(str(value.get("type")))[:40]
    bad = _no_number(value.get("coordinates"), 0)
    if bad is not None:
        quoted = escaped(json.dumps(bad))[:40]
        raise refused(
            path, f'geometry "{kind}": {quoted} is not a number; coordinates are lists of [x, y]'
        )
    try:
        return shapely.geometry.shape(value)
    except (
        shapely.errors.ShapelyError, ValueError, TypeError, LookupError, AttributeError,
        OverflowError,
    ):  # fmt: skip
        raise refused(
            path, f'geometry "{kind}" cannot be read; coordinates are lists of [x, y]'
        ) from None


def _no_number(value: Any, depth: int) -> Any:
    """First text, bool or object within lists of coordinates; None where there is none.

    What is no list at all, or nested too deeply, is for shapely to refuse.
    """
    if isinstance(value, list):
        found = (_no_number(one, depth + 1) for one in value if depth < MOST_DEPTH)
        return next((one for one in found if one is not None), None)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return None if is_number or depth == 0 else value


def _check_degrees(path: Path, parts: list[Part]) -> None:
    """GeoJSON without a crs is in degrees; numbers that can hardly be metres are refused."""
    points = np.vstack([shapely.get_coordinates(part.shape) for part in parts])
    x, y = np.abs(points).max(axis=0)
    if x <= 180.0 and y <= 90.0 and np.ptp(points, axis=0).max() < 1.0:
        raise degrees(
            path,
            f"all within {np.ptp(points, axis=0).max():.2g} of a unit, and GeoJSON without crs is "
            "in degrees; --scale 1 if these are metres",
        )
