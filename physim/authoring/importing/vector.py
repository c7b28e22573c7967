"""GeoJSON and WKT in metres: polygons and lines, each with the role that the file states.

Features of GeoJSON have a property ``role``, else ``layer`` says it. In WKT, and in GeoJSON in
which no feature has either, polygons are places where robots may go, and a line is the path.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import dataclass, replace
from itertools import accumulate
from math import isfinite, radians
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import (
    Drawing,
    Shape,
    invalid_at,
    listed,
    place,
    refused,
    rounded,
)
from physim.authoring.importing.options import Options
from physim.authoring.importing.roles import hint, role_named, unroled
from physim.authoring.importing.source import read_text
from physim.authoring.importing.work import check_work
from physim.errors import nearest

MOST_DEPTH = 20
"""Geometries within geometries"""
ROLES = ("place", "boundary", "obstacle", "path", "robot")
ABUT = 1.5e-3
"""[m] Places nearer than this abut: corners that are one may be rounded apart by 1.4 mm."""
BY_ROLE = 'give it the property "role": place, boundary, obstacle, path or robot'
PROJECT = "project them first (ogr2ogr -t_srs EPSG:32633, the UTM zone of the place)"


@dataclass(frozen=True)
class _Part:
    """A single geometry of a source, in its units, and what the source says of it."""

    geometry: Any
    role: str = ""
    name: str = ""
    layer: str = ""
    heading: float | None = None
    """[rad]"""
    elsewhere: frozenset[str] = frozenset()
    """roles that other properties than role and layer say"""
    label: str = ""
    line: int | None = None


def read_wkt(path: Path, options: Options) -> Drawing:
    """Read a WKT file: one geometry, or one a line; ``#`` begins a comment."""
    texts: list[tuple[int, list[str]]] = []
    opened = 0
    for k, row in enumerate(read_text(path).split("\n"), start=1):
        row = row.split("#", 1)[0].strip().rstrip(";")
        begins = re.match(r"(SRID\s*=|[A-Za-z])", row) is not None
        if row and (not texts or (begins and opened <= 0)):
            texts.append((k, [row]))
            opened = 0
        elif row:  # a geometry may go over several lines
            texts[-1][1].append(row)
        opened += row.count("(") - row.count(")")
    if not texts:
        raise refused(path, "holds no geometry; POLYGON ((x y, ...)) is needed")
    parts: list[_Part] = []
    stated = ""
    for k, rows in texts:
        text = " ".join(rows)
        if srid := re.match(r"(SRID\s*=\s*\d{1,9})\s*(?:;\s*)?", text, re.I):
            stated, text = srid[1], text[srid.end() :]
        depth = max(accumulate((c == "(") - (c == ")") for c in text), default=0)
        if depth > MOST_DEPTH or "\0" in text:
            raise refused(path, f"nested deeper than {MOST_DEPTH} levels, or with NUL in it", k)
        try:
            with np.errstate(invalid="ignore", over="ignore"):
                shape = shapely.from_wkt(text)
        except (shapely.errors.ShapelyError, ValueError, NotImplementedError) as error:
            reason = str(error).split(": ", 1)[-1].strip()[:100]
            counts = f"{text.count('(')} opening and {text.count(')')} closing brackets"
            if "closed linestring" in reason:
                counts = "repeat the first point of a ring as its last"
            raise refused(path, f"not valid WKT: {reason} ({counts})", k) from None
        for one in _flat(shape):
            role = "place" if one.geom_type == "Polygon" else "path"
            parts.append(_Part(one, role, label=one.geom_type, line=k))
    return _drawing(path, "WKT polygons", parts, stated, options)


def read_geojson(path: Path, options: Options) -> Drawing:
    """Read a GeoJSON file; raises ImportSourceError."""
    text = read_text(path)
    try:
        value = json.loads(
            text, parse_constant=_not_finite, parse_int=float, object_pairs_hook=_once
        )
    except json.JSONDecodeError as error:
        raise refused(path, f"not valid JSON: {error.msg}", error.lineno) from None
    except RecursionError:
        raise refused(path, "nested too deeply") from None
    except ValueError as error:
        raise refused(path, str(error)[:100]) from None
    if not isinstance(value, dict) or "type" not in value:
        raise refused(path, 'not GeoJSON: an object with "type" is needed')
    features = value.get("features") if value["type"] == "FeatureCollection" else [value]
    if not isinstance(features, list):
        raise refused(path, 'not GeoJSON: "features" must be a list')
    parts: list[_Part] = []
    names = set[str]()
    for k, feature in enumerate(features, start=1):
        about = _about(path, feature, k)
        own = {one for one in (about.name, about.layer) if one}
        names |= own
        if own & {*options.ignore}:
            continue
        geometry = feature.get("geometry") if feature.get("type") == "Feature" else feature
        if geometry is not feature and isinstance(geometry, dict) and geometry.get("crs"):
            raise refused(path, f"{about.label}: has a crs of its own; give one to the file")
        if geometry is not None:
            found = _geometries(path, geometry, about.label)
            parts += [replace(about, geometry=one) for one in found]
    for name in sorted({*options.ignore} - names):
        near = nearest(name[:100], sorted(names))
        raise refused(path, f"--ignore {name}: no feature has that name or layer{near}")
    kinds = {"Polygon": "place", "LineString": "path", "LinearRing": "path"}
    as_wkt = [replace(one, role=kinds.get(one.geometry.geom_type, "")) for one in parts]
    if any(one.role or one.layer for one in parts) or any(
        one.elsewhere - {one.role} for one in as_wkt
    ):
        parts = _with_roles(path, parts, options)
    else:
        parts = as_wkt
    stated = json.dumps(value["crs"])[:80] if value.get("crs") else ""
    return _drawing(path, "GeoJSON polygons", parts, stated, options)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Object of its keys and values; programs differ in which of two values of a key they take."""
    made = dict(pairs)
    if len(made) < len(pairs):
        twice = Counter(key for key, _ in pairs).most_common(1)[0][0]
        raise ValueError(f'an object has the key "{twice[:30]}" twice; leave one out')
    return made


def _not_finite(word: str) -> float:
    raise ValueError(f"{word} is not a finite number; coordinates are finite")


def _about(path: Path, feature: Any, number: int) -> _Part:
    """What a feature says of itself."""
    if not isinstance(feature, dict):
        raise refused(path, f"feature {number}: not GeoJSON: a feature is an object")
    said = feature.get("properties") if feature.get("type") == "Feature" else None
    about = {key.lower(): one for key, one in said.items()} if isinstance(said, dict) else {}
    layer = str(about.get("layer") or "").strip()
    role, rest = str(about.get("role") or "").strip().lower(), ""
    if not role:
        role, rest = ("place", "") if layer.lower() == "place" else role_named(layer)
    given = [about.get("name"), rest, "" if role == "path" else feature.get("id")]
    given = [int(one) if isinstance(one, float) and one.is_integer() else one for one in given]
    name = next((str(one).strip() for one in given if one not in (None, "")), "")[:80]
    label = f"feature {number}" + (f' "{name}"' if name else "")
    elsewhere = frozenset(
        word for key, one in about.items()
        if key not in ("role", "layer") and (word := str(one).strip().lower()) in (*ROLES, "wall")
    )  # fmt: skip
    if role and role not in (*ROLES, "wall"):
        message = f'{label}: role: "{role[:40]}" is none of {", ".join(ROLES)}'
        raise refused(path, message + nearest(role[:40], list(ROLES)))
    heading = about.get("heading") if role == "robot" else None
    if heading is not None and not (isinstance(heading, float) and isfinite(heading)):
        raise refused(path, f"{label}: heading: a number of degrees is needed, 0 along x")
    heading = None if heading is None else radians(heading)
    return _Part(None, role, name, layer, heading, elsewhere, label)


def _geometries(path: Path, value: Any, label: str) -> list[Any]:
    """Single geometries of a GeoJSON geometry."""
    try:
        if not _is_geometry(value, 0):
            raise ValueError
        return _flat(shapely.geometry.shape(value))
    except (
        shapely.errors.ShapelyError, ValueError, TypeError, LookupError, AttributeError,
        OverflowError,
    ):  # fmt: skip
        kind = str(value.get("type") if isinstance(value, dict) else value)[:40]
        message = f'{label}: geometry "{kind}" cannot be read; coordinates are lists of [x, y], '
        raise refused(path, f"{message}nested at most {MOST_DEPTH} deep") from None


def _is_geometry(value: Any, depth: int) -> bool:
    """Whether all coordinates of a geometry, or of those in it, are lists of numbers."""
    if isinstance(value, dict):
        is_many = value.get("type") == "GeometryCollection"
        return _is_geometry(value["geometries" if is_many else "coordinates"], depth)
    if isinstance(value, list) and depth < MOST_DEPTH:
        return all(_is_geometry(one, depth + 1) for one in value)
    return isinstance(value, float)


def _flat(shape: Any) -> list[Any]:
    """Single geometries of a shapely one, empty ones left out."""
    if shape is None or shape.is_empty:
        return []
    parts = [shape]
    for _ in range(MOST_DEPTH):
        parts = [one for part in parts for one in shapely.get_parts(part)]
    return [one for one in parts if not one.is_empty]


def _with_roles(path: Path, parts: list[_Part], options: Options) -> list[_Part]:
    """Parts of a file that states roles: refuses those without, and shapes that suit no role."""
    without = [one for one in parts if not one.role and one.geometry.geom_type != "Point"]
    if without and not options.ignore_others:
        said = [
            (f'{one.label} of the layer "{one.layer[:40]}"' if one.layer else one.label,
             hint(one.layer), one.name or one.layer, None)
            for one in without
        ]  # fmt: skip
        raise unroled(path, said, BY_ROLE)
    found = []
    for one in parts:
        is_polygon, role = one.geometry.geom_type == "Polygon", one.role
        if role == "wall":  # a line has no inside
            role = "obstacle" if is_polygon else "boundary"
        needs = {"path": "LineString"}.get(role, "Polygon")
        if role and is_polygon == (role == "path") and role != "boundary":
            raise refused(
                path, f'{one.label}: a {one.geometry.geom_type} is no "{role}"; that is a {needs}'
            )
        found.append(replace(one, role=role))
    return found


def _drawing(path: Path, kind: str, parts: list[_Part], stated: str, options: Options) -> Drawing:
    """Drawing [m] of parts with a role; ``stated`` is the system of coordinates, where one is."""
    drawing = Drawing(kind, path)
    drawing.facts.append(f"{options.unit:g} m per unit")
    drawn = [one for one in parts if one.role and one.geometry.geom_type != "Point"]
    if len(drawn) < len(parts):
        drawing.changes.append(
            f"{len(parts) - len(drawn)} points or shapes without a role left out"
        )
    if not drawn:
        raise refused(path, "holds no polygon and no line with a role")
    flat = shapely.force_2d([one.geometry for one in drawn])
    shapes = shapely.transform(flat, lambda points: points * options.unit)
    every, owner = shapely.get_coordinates(shapes, return_index=True)
    for k in owner[~np.isfinite(every).all(axis=1)]:
        raise refused(path, f"{drawn[k].label}: a coordinate is not a finite number", drawn[k].line)
    is_small = stated or np.ptp(every, axis=0).max() < 1.0
    if options.scale is None and is_small and (np.abs(every) <= (180.0, 90.0)).all():
        about = f" ({stated})" if stated else ""
        message = f"within 180 by 90 units{about}: degrees? {PROJECT}; --scale 1 if metres"
        raise refused(path, message)
    if stated:
        drawing.facts.append(f"lengths of {stated} are taken as metres")
    shapes = shapely.transform(shapes, drawing.moved)
    check_work(path, [shapely.get_coordinates(one) for one in shapes])
    for dimension, is_there in (("heights", shapely.has_z), ("measures (M)", shapely.has_m)):
        if any(is_there(one.geometry) for one in drawn):
            drawing.changes.append(f"{dimension} of points left out")
    for one, shape in zip(drawn, shapes, strict=True):
        drawing.shapes += _shapes(path, one, shape, drawing)
    _unite(drawing)
    if not drawing.of("place", "boundary", "obstacle"):
        raise refused(path, "holds no polygon and no boundary; one says where robots may go")
    return drawing


def _shapes(path: Path, part: _Part, shape: Any, drawing: Drawing) -> list[Shape]:
    """Shapes of a part whose geometry is in metres; polygons that are none are refused."""

    def made(geometry: Any) -> Shape:
        role: Any = part.role
        return Shape(role, geometry, part.name, part.heading, part.label, part.line)

    if shape.geom_type != "Polygon" or part.role == "boundary":
        is_polygon = shape.geom_type == "Polygon"
        rings = [shape.exterior, *shape.interiors] if is_polygon else [shape]
        lines = [rounded(shapely.get_coordinates(ring)) for ring in rings]
        if any(len(line) < 2 for line in lines):
            raise refused(path, f"{part.label}: shorter than a millimetre; --scale?", part.line)
        return [made(shapely.LineString(line)) for line in lines]
    if not shape.is_valid:
        reason = shapely.is_valid_reason(shape).split("[")[0].lower()
        raise refused(
            path,
            f"{part.label}: no valid polygon: {reason}{invalid_at(shape)}; correct it",
            part.line,
        )
    if part.role == "robot" and shape.interiors:
        raise refused(path, f"{part.label}: a robot has one outline, and no holes", part.line)
    near = shapely.transform(shape, lambda p: p.round(3) + 0.0)
    whole = [near] if near.is_valid else shapely.get_parts(shapely.set_precision(shape, 1e-3))
    whole = [one for one in whole if one.geom_type == "Polygon" and one.area > 0.0]
    if not whole:
        raise refused(
            path, f"{part.label}: encloses no area to the millimetre; --scale?", part.line
        )
    if not near.is_valid:
        told = f"{part.label}: {len(whole)} after rounding: a neck or wall is below a millimetre"
        drawing.changes.append(told)
    return [made(one) for one in whole]


def _unite(drawing: Drawing) -> None:
    """Unite places that overlap or abut; those that stay apart are listed.

    A place within another is refused: it adds nothing, so it is more likely an obstacle.
    """
    places = drawing.of("place")
    if len(places) < 2:
        return
    is_wkt = drawing.kind.startswith("WKT")
    how = "make it a hole of that one if it is an obstacle" if is_wkt else BY_ROLE
    areas = [one.geometry for one in places]
    inner, outer = shapely.STRtree(areas).query(areas, predicate="covered_by")
    for i, k in zip(inner[inner != outer], outer[inner != outer], strict=True):
        raise drawing.refusal(
            f"lies within the place of {places[k]}; leave it out, or {how}", places[i]
        )
    united = shapely.union_all([one.geometry for one in places])
    closed = united.buffer(ABUT / 2.0, join_style="mitre").buffer(-ABUT / 2.0, join_style="mitre")
    united = shapely.set_precision(shapely.union(united, closed), 1e-3)
    found = [one for one in shapely.get_parts(united) if one.geom_type == "Polygon"]
    first = [next(one for one in places if one.geometry.intersects(area)) for area in found]
    drawing.shapes = [
        *(replace(one, geometry=area) for one, area in zip(first, found, strict=True)),
        *drawing.of("boundary", "obstacle", "path", "robot"),
    ]
    told = f"{len(places)} polygons united where they overlap, or abut within {ABUT * 1e3:g} mm: "
    sizes = [f"{one.area:.1f} m² about {place(one.representative_point().coords[0])}"
             for one in found]  # fmt: skip
    drawing.facts.append(told + ", ".join(listed(sizes)))
