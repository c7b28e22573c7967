"""A centreline with widths, in the race-track convention: ``x_m, y_m, w_tr_right_m, w_tr_left_m``.

Commas or semicolons between values; lines that begin with ``#`` are comments. A line above the
numbers, comment or not, may name the columns, in any order; without names they are these four. The
road is the union of what lies between each two of its points.
"""

from __future__ import annotations

import math
import re
from itertools import takewhile
from pathlib import Path

import numpy as np
import shapely

from physim.authoring.importing.area import SMALLEST
from physim.authoring.importing.drawing import (
    Drawing,
    Shape,
    listed,
    place,
    refused,
    rounded,
)
from physim.authoring.importing.options import Options
from physim.authoring.importing.source import read_text
from physim.authoring.importing.work import check_work
from physim.errors import nearest
from physim.geometry.shapes import FloatArray
from physim.world.ground.polyline import Polyline

COLUMNS = ("x_m", "y_m", "w_tr_right_m", "w_tr_left_m")
MEANT = (
    "x_m, y_m [m] points of the centreline, w_tr_right_m, w_tr_left_m [m] from it to the edges of "
    "the road"
)
NAME = re.compile(r"[^\W\d][\w.\-/°]*\s*(\[[^\]]*\]|\([^)]*\))?")
"""One word, and a unit in brackets after it."""
MOST_POINTS, MOST_LINES = 15_000, 300_000
"""Points of a track; lines of a file, with empty ones, comments and points that are repeated"""
CLOSED, CLOSED_SHARE, CLOSABLE_SHARE = 2.0, 0.2, 0.5
"""[-] A track is closed when its ends are no further apart than the first times its longest step
and the second of its length; than the third, if --start says that it is closed."""
GAP = 2.0
"""[m] of road left out where a closed track is cut open"""
MARGIN = 3.0
"""[m] from the ends of the road at which its path begins and ends, less on a narrow road"""
BEND = 3.0
"""[-] widths along the track within which its stretches may overlap: in bends they do"""


def read_track(path: Path, options: Options) -> Drawing:
    """Read a race-track CSV into a drawing with its centreline as the path.

    Raises ImportSourceError, with file:line for what a row or the names of columns say.
    """
    drawing = Drawing(kind="centreline with widths (race-track convention)", path=path)
    table = _table(drawing, read_text(path), options.unit)
    table[:, :2] = drawing.moved(table[:, :2])
    width = table[:, 2:].sum(axis=1)
    is_closed, length = _closed(table[:, :2], options)
    drawing.facts.append(
        f"{len(table)} points, {length:.1f} m, {'closed' if is_closed else 'open'}, "
        f"{width.min():.2f} to {width.max():.2f} m wide; {options.unit:g} m per unit"
    )
    if length < SMALLEST:
        raise drawing.refusal(f"the centreline is {length:.3g} m long; check --scale")
    centre, left, right = _edges(table, is_closed)
    if is_closed:
        centre, left, right = _opened(drawing, centre, left, right, options)
    elif options.start is not None or options.gap is not None:
        raise refused(path, "--start and --gap are for closed tracks; this one is open")
    check_work(path, [left, right])
    road = _road(drawing, centre, left, right)
    way = Polyline(centre)
    margin = min(MARGIN, float(width.min()), 0.2 * way.length)
    line = rounded(way.stretch(margin, way.length - margin))
    drawing.shapes = [Shape("place", road), Shape("path", shapely.LineString(line))]
    drawing.facts.append(f"the path begins and ends {margin:g} m from the ends of the road")
    return drawing


def _table(drawing: Drawing, text: str, scale: float) -> FloatArray:
    """(n, 4) [m] values in the order of `COLUMNS`; repeated points are dropped and listed."""
    path, rows = drawing.path, text.split("\n")
    if len(rows) > MOST_LINES:
        raise refused(path, f"{len(rows)} lines; at most {MOST_LINES} are read")
    numbered = [(k, row.strip()) for k, row in enumerate(rows, start=1) if row.strip()]
    above = list(
        takewhile(lambda one: one[1][0] == "#" or one[1].lstrip(' ,;"')[:1].isalpha(), numbered)
    )
    if len(above) == len(numbered):
        raise refused(path, f"no row that begins with a number; columns: {', '.join(COLUMNS)}")
    first, row = numbered[len(above)]
    if re.search(r"\t|^\S+( +\S+){3}$", row) and not re.search("[,;]", row):
        between = "tabs" if "\t" in row else "spaces"
        raise refused(path, f"{between} between the columns; separate them by commas", first)
    separator = ";" if ";" in row else ","
    count = len(row.split(separator))
    order = _columns(drawing, above, first, count)
    table, repeated = list[list[float]](), list[str]()
    for k, row in numbered[len(above) :]:
        if row[0] == "#":
            continue
        values = [value * scale for value in _numbers(path, k, row, separator, count, order)]
        if table and math.dist(table[-1][:2], values[:2]) <= 1e-6:
            repeated.append(f"line {k}: repeats the point before it, dropped")
            continue
        table.append(values)
        if len(table) > MOST_POINTS:
            raise refused(path, f"more than {MOST_POINTS} points", k)
    if len(table) < 2:
        raise refused(path, f"{len(table)} points; a centreline needs at least 2")
    drawing.changes += listed(repeated)
    return np.array(table)


def _columns(drawing: Drawing, above: list[tuple[int, str]], first: int, count: int) -> list[int]:
    """Places of the four columns in a row; refused where the names above differ."""
    header, line = list[str](), first
    for k, row in above:
        names = [name.strip(" \"'#\t").lower() for name in re.split("[,;\t]", row)]
        words = len(names) > 1 and all(NAME.fullmatch(name) for name in names if name)
        columns = len(names) in (4, count) or any(name[:1] == "x" for name in names)
        if row[0] != "#" or "x_m" in row.lower() or (words and columns):
            header, line = names, k
    if not header and count == 4:
        return [0, 1, 2, 3]
    given = ", ".join(header)[:200] if header else f"{count} without names"
    others = [name for name in header if name and name not in COLUMNS]
    wrong = [name for name in COLUMNS if header.count(name) != 1]
    if wrong:
        near = nearest(wrong[0], others) if len(wrong) == 1 else ""
        message = f"not one column {', '.join(wrong)}; the columns are {given}{near}"
        raise refused(drawing.path, f"{message}; rename or add: {MEANT}", line)
    if others:
        drawing.changes.append(f"columns left out: {', '.join(others)}"[:200])
    return [header.index(name) for name in COLUMNS]


def _numbers(
    path: Path, line: int, row: str, separator: str, count: int, order: list[int]
) -> list[float]:
    """The four values of a row, finite, widths above 0."""
    cells = [cell.strip(' "') for cell in row.split(separator)]
    if (separator == ";" and "," in row) or len(cells) <= max(order) or any(cells[count:]):
        message = f"{len(cells)} values in {count} columns, parted by {separator}"
        raise refused(path, f"{message}; of numbers with a decimal comma write a point", line)
    values = []
    for name, cell in zip(COLUMNS, (cells[k] for k in order), strict=True):
        try:
            value = float(cell) if cell.isascii() and "_" not in cell else math.nan
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise refused(path, f'{name}: "{cell[:40]}" is not a finite number', line)
        if name.startswith("w_") and value <= 0.0:
            raise refused(path, f"{name}: {value:g}; a width must be greater than 0", line)
        values.append(value)
    return values


def _closed(points: FloatArray, options: Options) -> tuple[bool, float]:
    """Whether the last point leads back to the first, and the length of the centreline [m]."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    gap, length = float(np.hypot(*(points[0] - points[-1]))), float(steps.sum())
    most = min(CLOSED * float(steps.max()), CLOSED_SHARE * length)
    if options.start is not None:
        most = CLOSABLE_SHARE * length
    closed = len(points) > 3 and gap <= most and not options.open
    return closed, length + (gap if closed else 0.0)


def _edges(table: FloatArray, is_closed: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Centreline and both edges (n, 2) [m], square to the direction from point to next but one."""
    if is_closed and np.hypot(*(table[0, :2] - table[-1, :2])) > 1e-6:
        table = np.vstack([table, table[:1]])
    points = table[:, :2]
    ahead = np.vstack([points[1:], points[1:2] if is_closed else points[-1:]]) - points
    behind = points - np.vstack([points[-2:-1] if is_closed else points[:1], points[:-1]])
    units = [d / np.maximum(np.hypot(*d.T), 1e-300)[:, None] for d in (ahead, behind)]
    direction = units[0] + units[1]
    size = np.hypot(*direction.T)[:, None]
    direction = np.where(size > 1e-9, direction / np.maximum(size, 1e-9), units[0])
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    return points, points + table[:, 3:] * normal, points - table[:, 2:3] * normal


def _opened(
    drawing: Drawing, centre: FloatArray, left: FloatArray, right: FloatArray, options: Options
) -> tuple[FloatArray, ...]:
    """Cut a closed road open: a path of a formation has a beginning and an end."""
    way = Polyline(centre)
    start, gap = options.start or 0.0, GAP if options.gap is None else options.gap
    if not start < way.length:
        raise drawing.refusal(f"--start {start:g}: the track is {way.length:.1f} m long, from 0")
    if not gap < 0.5 * way.length:
        raise drawing.refusal(f"--gap {gap:g}: must be less than half of {way.length:.1f} m")
    twice = np.concatenate((way.station, way.station[1:] + way.length))
    end = start + way.length - gap
    inside = twice[(twice > start + 1e-6) & (twice < end - 1e-6)]
    at = np.concatenate(([start], inside, [end]))
    cut = tuple(
        np.stack([np.interp(at, twice, np.concatenate((v, v[1:]))) for v in line.T], axis=1)
        for line in (centre, left, right)
    )
    drawing.changes.append(
        f"closed track cut open at station {start:g} m, {place(cut[0][0])}: the road ends "
        f"{gap:g} m before it begins (--start, --gap; --open: it is no closed one)"
    )
    return cut


def _road(drawing: Drawing, centre: FloatArray, left: FloatArray, right: FloatArray) -> object:
    """The road as a shapely polygon; refused where stretches far apart along it meet."""
    a, b, c, d = right[:-1], right[1:], left[1:], left[:-1]
    halves = [shapely.polygons(np.stack(corners, axis=1)) for corners in ((a, b, c), (a, c, d))]
    pieces = shapely.union(*halves)
    first, second = shapely.STRtree(pieces).query(pieces, predicate="intersects")
    station, width = Polyline(centre).station, np.hypot(*(left - right).T)
    apart = station[second] - station[first + 1]
    met = np.flatnonzero(apart > BEND * np.maximum(width[first], width[second]))
    if met.size:
        k = met[0]
        raise drawing.refusal(
            f"the road meets itself at {place(centre[first[k]])}: its stretches at "
            f"{station[first[k]]:.1f} m and {station[second[k]]:.1f} m overlap or share an edge; "
            "make the widths there smaller, smooth noisy points, or cut a closed track open "
            "elsewhere (--start)"
        )
    road = shapely.union_all(pieces, grid_size=1e-3)
    return max(shapely.get_parts(road), key=shapely.area)
