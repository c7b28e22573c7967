"""Polygons and lines as WKT or GeoJSON: an outer ring is a wall, holes are solid, a line the path.

A polygon is the place where robots may go. Where there are several, the one with the path in it,
or the largest, is taken.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.importing.drawing import (
    DIGITS,
    Drawing,
    DrawnRobot,
    Options,
    listed,
    place,
    printable,
    refused,
    rounded,
)
from physim.importing.gaps import join_ends
from physim.importing.source import read_text

LARGEST = 1.0e6
"""[m] largest coordinate of a world"""
MOST_GEOMETRIES = 10_000
MOST_DEPTH = 20
MOST_CORNERS = 2_000
"""Corners of one obstacle of a world; a longer hole becomes a closed boundary."""

DEGREES = ("crs84", "epsg:4326", "epsg::4326", "epsg/0/4326", "epsg:4258", "epsg::4258")


@dataclass(frozen=True)
class _Part:
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
    parts: list[_Part] = []
    for k, text in texts:
        parts += _from_wkt(path, k, text)
    return _drawing(path, "WKT", parts, options)


def _from_wkt(path: Path, line: int, text: str) -> list[_Part]:
    srid = re.match(r"SRID\s*=\s*(\d+)\s*;?\s*", text, re.I)
    if srid is not None:
        if srid[1] in ("4326", "4258"):
            raise _degrees(path, f"SRID {srid[1]}", line)
        text = text[srid.end() :]
    if text.count("(") > 1_000_000 or _depth(text) > MOST_DEPTH:
        raise refused(path, f"nested deeper than {MOST_DEPTH} levels", line)
    try:
        with np.errstate(invalid="ignore"):
            shape = shapely.from_wkt(text)
    except (shapely.errors.ShapelyError, ValueError, NotImplementedError) as error:
        reason = printable(str(error).split(": ", 1)[-1].strip())[:100]
        raise refused(path, f"not valid WKT: {reason}", line) from None
    return [_Part(one, line=line) for one in _flat(shape)]


def _depth(text: str) -> int:
    depth = deepest = 0
    for character in text:
        depth += (character == "(") - (character == ")")
        deepest = max(deepest, depth)
    return deepest


def _flat(shape: Any) -> list[Any]:
    if shape is None or shape.is_empty:
        return []
    if hasattr(shape, "geoms"):
        return [one for inner in shape.geoms for one in _flat(inner)]
    return [shape]


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
        raise refused(path, printable(str(error))[:100]) from None
    if not isinstance(value, dict) or "type" not in value:
        raise refused(path, 'not GeoJSON: an object with "type" is needed')
    crs = json.dumps(value.get("crs") or "").lower()
    if any(name in crs for name in DEGREES):
        raise _degrees(path, "the crs of the file")
    parts = list(_features(path, value, "", "", 0))
    if options.scale is None and len(crs) < 3 and parts:
        _check_degrees(path, parts)
    return _drawing(path, "GeoJSON", parts, options)


def _not_finite(word: str) -> float:
    raise ValueError(f"{word} is not a finite number; coordinates are finite")


def _features(path: Path, value: Any, role: str, name: str, depth: int) -> Any:
    """Every polygon and line below a GeoJSON object."""
    if depth > MOST_DEPTH:
        raise refused(path, f"nested deeper than {MOST_DEPTH} levels")
    if not isinstance(value, dict):
        raise refused(path, "not GeoJSON: a feature or geometry is an object")
    kind = value.get("type")
    if kind == "FeatureCollection":
        for one in _list(path, value, "features"):
            yield from _features(path, one, role, name, depth + 1)
    elif kind == "Feature":
        about = value.get("properties")
        about = about if isinstance(about, dict) else {}
        own = str(about.get("role", about.get("layer", ""))).strip().lower()
        label = printable(str(about.get("name", value.get("id", "")) or ""))[:80]
        if value.get("geometry") is not None:
            yield from _features(path, value["geometry"], own, label, depth + 1)
    elif kind == "GeometryCollection":
        for one in _list(path, value, "geometries"):
            yield from _features(path, one, role, name, depth + 1)
    else:
        try:
            shape = shapely.geometry.shape(value)
        except (shapely.errors.ShapelyError, ValueError, TypeError, LookupError, AttributeError):
            raise refused(
                path, f'geometry "{printable(str(kind))[:40]}" cannot be read; coordinates are '
                "lists of [x, y]",
            ) from None  # fmt: skip
        for one in _flat(shape):
            yield _Part(one, role, name)


def _list(path: Path, value: dict[str, Any], key: str) -> list[Any]:
    entries = value.get(key)
    if not isinstance(entries, list):
        raise refused(path, f'not GeoJSON: "{key}" must be a list')
    return entries


def _degrees(path: Path, why: str, line: int | None = None) -> Exception:
    return refused(
        path,
        f"coordinates are degrees of longitude and latitude ({why}), and a world is in metres; "
        "project them first, e.g. with ogr2ogr -t_srs EPSG:32633 (the UTM zone of the place)",
        line,
    )


def _check_degrees(path: Path, parts: list[_Part]) -> None:
    """GeoJSON without a crs is in degrees; numbers that can hardly be metres are refused."""
    points = np.vstack([shapely.get_coordinates(part.shape) for part in parts])
    x, y = np.abs(points).max(axis=0)
    if x <= 180.0 and y <= 90.0 and np.ptp(points, axis=0).max() < 1.0:
        raise _degrees(
            path,
            f"all within {np.ptp(points, axis=0).max():.2g} of a unit, and GeoJSON without crs is "
            "in degrees; --scale 1 if these are metres",
        )


def _drawing(path: Path, kind: str, parts: list[_Part], options: Options) -> Drawing:
    scale = 1.0 if options.scale is None else options.scale
    drawing = Drawing(kind=f"{kind} polygons")
    drawing.facts.append(f"{scale:g} m per unit")
    if not parts:
        raise refused(path, "holds no polygon and no line")
    if len(parts) > MOST_GEOMETRIES:
        raise refused(path, f"{len(parts)} geometries; at most {MOST_GEOMETRIES} are read")
    polygons: list[_Part] = []
    unused: list[str] = []
    for part in parts:
        points = shapely.get_coordinates(part.shape) * scale
        if not np.isfinite(points).all():
            raise refused(path, "a coordinate is not a finite number", part.line)
        if len(points) and np.abs(points).max() > LARGEST:
            raise refused(
                path, f"a coordinate of {np.abs(points).max():g} m is beyond {LARGEST:g} m; move "
                "the origin, or mind the --scale", part.line,
            )  # fmt: skip
        if part.shape.has_z and not any("height" in text for text in drawing.changes):
            drawing.changes.append("third coordinates (height) left out")
        shape = shapely.transform(shapely.force_2d(part.shape), lambda p: p * scale)
        if shape.geom_type == "Polygon" and part.role == "robot":
            ring = _ring(shape)
            name = part.name or f"r{len(drawing.robots) + 1}"
            drawing.robots.append(DrawnRobot(name, ring))
        elif shape.geom_type == "Polygon" and part.role == "obstacle":
            drawing.obstacles.append(_ring(shape))
        elif shape.geom_type == "Polygon":
            polygons.append(_Part(_valid(path, shape, part.line, drawing), part.role, part.name))
        elif shape.geom_type in ("LineString", "LinearRing"):
            _line(drawing, part, rounded(shapely.get_coordinates(shape)), unused)
        else:
            unused.append(f"{shape.geom_type} at {place(points[0])}: holds no lines, left out")
    drawing.changes += listed(unused)
    if polygons:
        _place_polygons(path, drawing, polygons, options)
    elif not drawing.boundaries:
        raise refused(path, "holds no polygon; one says where robots may go")
    else:
        drawing.changes += join_ends(drawing.boundaries)
    return drawing


def _ring(shape: Any) -> FloatArray:
    """Corners (n, 2) [m] of a polygon's outline, the first not repeated; one of a mere grain."""
    points = rounded(shapely.get_coordinates(shape.exterior))
    return points[:-1] if len(points) > 1 else points


def _line(drawing: Drawing, part: _Part, points: FloatArray, unused: list[str]) -> None:
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
    """Polygon on the millimetre grid; one that crosses itself is mended and told."""
    if not shape.is_valid:
        reason = shapely.is_valid_reason(shape)
        mended = shapely.get_parts(shapely.make_valid(shape))
        mended = [one for one in mended if one.geom_type == "Polygon"]
        if not mended:
            raise refused(path, f"a polygon encloses no area ({reason})", line)
        largest = max(mended, key=lambda one: float(one.area))
        drawing.changes.append(
            f"polygon mended ({reason}): {len(mended)} parts, the largest of {largest.area:.3f} m² "
            "is kept"
        )
        shape = largest
    snapped = shapely.set_precision(shape, 10.0**-DIGITS)
    whole = [one for one in shapely.get_parts(snapped) if one.geom_type == "Polygon"]
    if not whole or snapped.is_empty:
        raise refused(path, "a polygon is smaller than a millimetre; mind the --scale", line)
    return max(whole, key=lambda one: float(one.area))


def _place_polygons(path: Path, drawing: Drawing, polygons: list[_Part], options: Options) -> None:
    """Take the polygon that robots are in; list the others."""
    shapes = [part.shape for part in polygons]
    if drawing.reference is not None:
        line = shapely.LineString(drawing.reference)
        chosen = max(shapes, key=lambda p: (float(p.intersection(line).length), float(p.area)))
    elif options.origin is not None:
        start = shapely.Point(options.origin)
        chosen = max(shapes, key=lambda p: (bool(p.covers(start)), float(p.area)))
    else:
        chosen = max(shapes, key=lambda p: float(p.area))
    drawing.changes += listed(
        [
            f"polygon of {one.area:.3f} m² at {place(one.representative_point().coords[0])}: not "
            "the area of the robots, left out"
            for one in shapes
            if one is not chosen
        ]
    )
    drawing.boundaries.append(shapely.get_coordinates(chosen.exterior))
    for ring in chosen.interiors:
        points = shapely.get_coordinates(ring)
        if len(points) - 1 <= MOST_CORNERS:
            drawing.obstacles.append(points[:-1])
        else:
            drawing.boundaries.append(points)
