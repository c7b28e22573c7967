"""Polygons and lines of WKT: an outer ring is a wall, holes are solid, a line is the path.

A polygon is the place where robots may go. Where there are several, the one with the path in it,
that at ``--from``, that with most of the robots, or the largest is taken. Those of GeoJSON
(`physim.authoring.importing.geojson`) may have a role each; geometries are in metres.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing, listed, refused
from physim.authoring.importing.options import Options
from physim.authoring.importing.parts import Part, drawing_of
from physim.authoring.importing.source import read_text
from physim.authoring.importing.work import depth_of
from physim.escaping import escaped

MOST_DEPTH = 20
"""Geometries within geometries."""
DEGREES = (4326, 4258)
"""EPSG codes of degrees that are met most"""
MAYBE_DEGREES = range(4001, 20_000)
"""EPSG codes, the others of degrees among them, and some of metres with places farther away"""
LEAST_CODE = 1024
"""EPSG code of the first system"""


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
