"""GeoJSON in metres: its polygons and lines, and the roles that features have."""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing, listed, refused
from physim.authoring.importing.options import Options
from physim.authoring.importing.parts import (
    MOST_GEOMETRIES,
    Part,
    check_count,
    drawing_of,
)
from physim.authoring.importing.polygons import MOST_DEPTH, check_codes, degrees, flat
from physim.authoring.importing.roles import ROLES, nearest_role, role_named
from physim.authoring.importing.source import read_text
from physim.errors import nearest, plural
from physim.escaping import escaped

MOST_LISTS = 1_000_000
MOST_DIGITS = 300
"""Digits of a whole number, about what fits into a float."""
CODE = re.compile(r"(?<!\d)\d{1,9}(?!\d)")
"""What may be the number by which a crs is known; versions may stand beside it"""
IN_DEGREES = re.compile(r"crs:?84|wgs[ _]?(?:19)?84\s*$|long?_?lat|lat_?long?", re.I)
"""Names of a crs in degrees"""
COLLECTIONS = {"FeatureCollection": "features", "GeometryCollection": "geometries"}


def read_geojson(path: Path, options: Options) -> Drawing:
    """Read a GeoJSON file in metres; degrees are refused."""
    text = read_text(path)
    if text.count("[") > MOST_LISTS:
        raise refused(path, f"more than {MOST_LISTS:,} points and lists; simplify the lines first")
    try:
        value = json.loads(
            text, parse_constant=_not_finite, parse_int=_whole, object_pairs_hook=_once
        )
    except json.JSONDecodeError as error:
        raise refused(path, f"not valid JSON: {error.msg}", error.lineno) from None
    except RecursionError:
        raise refused(path, "nested too deeply") from None
    except ValueError as error:
        raise refused(path, escaped(str(error))[:100]) from None
    if not isinstance(value, dict) or "type" not in value:
        raise refused(path, 'not GeoJSON: an object with "type" is needed')
    crs = _text_of(value.get("crs") or "")
    if IN_DEGREES.search(crs):
        raise degrees(path, "the crs of the file")
    parts = list(islice(_features(path, value, "", "", 0), MOST_GEOMETRIES + 1))
    check_count(path, parts)
    if options.scale is None and not value.get("crs") and parts:
        _check_degrees(path, parts)
    if value.get("crs"):
        is_code = "epsg" in crs.lower() or crs.strip().isdigit()
        codes = [int(code) for code in CODE.findall(crs)] if is_code else []
        check_codes(path, codes, "the crs of the file", parts, options)
    drawing = drawing_of(path, "GeoJSON", parts, options)
    drawing.changes += _layers_without_role(parts)
    if value.get("crs"):
        name = _name_of(value["crs"])
        drawing.facts.insert(1, f"lengths of its crs, {name}, are taken as they are")
    return drawing


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Object of its keys and values; programs differ in which of two values of a key they take."""
    made = dict(pairs)
    if len(made) < len(pairs):
        twice = Counter(key for key, _ in pairs).most_common(1)[0][0]
        kind = made.get("type")
        where = f' of type "{kind[:30]}"' if isinstance(kind, str) else ""
        raise ValueError(f'an object{where} has the key "{twice[:30]}" twice; leave one out')
    return made


def _text_of(crs: Any, depth: int = 0) -> str:
    """Names and numbers of a crs, as they are meant: without quotes, escapes and keys."""
    if not isinstance(crs, dict | list):
        return str(crs)
    if depth > MOST_DEPTH:
        return ""
    # its type may be EPSG, and its code the number alone
    keys = sorted(crs, key=lambda key: key != "type") if isinstance(crs, dict) else range(len(crs))
    return " ".join(_text_of(crs[key], depth + 1) for key in keys)


def _name_of(crs: Any) -> str:
    about = crs.get("properties") if isinstance(crs, dict) else None
    name = about.get("name") if isinstance(about, dict) else None
    return escaped(str(name or "unnamed")[:60])


def _whole(digits: str) -> int:
    if len(digits) > MOST_DIGITS:
        raise ValueError(
            f"{digits[:20]}…, a number of {len(digits)} digits; at most {MOST_DIGITS} are read"
        )
    return int(digits)


def _not_finite(word: str) -> float:
    raise ValueError(f"{word} is not a finite number; coordinates are finite")


def _features(path: Path, value: Any, role: str, name: str, depth: int) -> Any:
    """Every polygon and line below a GeoJSON object."""
    if depth > MOST_DEPTH:
        raise refused(path, f"nested deeper than {MOST_DEPTH} levels")
    if not isinstance(value, dict):
        raise refused(path, "not GeoJSON: a feature or geometry is an object")
    if depth and value.get("crs"):
        raise refused(path, "a feature or geometry has a crs of its own; give one to the file")
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
        about = {key.lower(): one for key, one in about.items()}  # shapefiles have capitals
        own, rest = _role(path, about)
        number = "" if own == "path" else value.get("id", "")  # pieces of one path have each one
        names = (about.get("name"), rest, number)  # of which 0 is one
        label = next((str(one) for one in names if one is not None and str(one).strip()), "")
        label = escaped(label)[:80]
        if value.get("geometry") is not None:
            layer = "" if own else str(about.get("layer") or "").strip()
            for part in _features(path, value["geometry"], own, label, depth + 1):
                yield replace(part, layer=layer or part.layer)
    else:
        for one in flat(_shape(path, value)):
            _check_role(path, one, role)
            yield Part(one, role, name)


def _role(path: Path, about: dict[str, Any]) -> tuple[str, str]:
    """What a feature is for, by its property ``role``, else by ``layer`` where that is a role.

    And the rest of the name of the layer, as ``1`` of ``path 1``.

    A role that is none is refused. A layer may have any name, and says a role as that of a drawing.
    """
    role = str(about.get("role") or "").strip().lower()
    if not role:
        return role_named(str(about.get("layer") or ""))
    if role not in ROLES:
        raise refused(
            path,
            f'role: "{escaped(role)[:40]}" is none of {", ".join(ROLES)}'
            f"{nearest(role, list(ROLES))}",
        )
    return role, ""


def _layers_without_role(parts: list[Part]) -> list[str]:
    """What is said of layers whose names are no role, of what they hold."""
    found = Counter(part.layer for part in parts if part.layer)
    return listed(
        [
            f'layer "{escaped(name)[:40]}" is no role ({", ".join(ROLES)}): '
            f"{plural(count, 'shape')} taken as without one, a line as a path, a polygon as a place"
            f"{nearest_role(name)}"
            for name, count in found.items()
        ]
    )


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
    """First text, bool, object or list too deep within lists of coordinates; None without one.

    What is no list at all is for shapely to refuse.
    """
    if isinstance(value, list) and depth < MOST_DEPTH:
        found = (_no_number(one, depth + 1) for one in value)
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
