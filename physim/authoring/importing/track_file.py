"""A centreline with widths, in the race-track convention: ``x_m, y_m, w_tr_right_m, w_tr_left_m``.

Commas or semicolons between values; lines that begin with ``#`` are comments. Which columns hold
what is said by the line that names them, else by their order. Names that are not the four are
refused, with those that seem to be meant: to take columns for what their names deny would swap
the sides of the road in silence.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physim.authoring.importing.drawing import LARGEST, grid_origin, listed, refused
from physim.errors import nearest
from physim.escaping import escaped
from physim.geometry.shapes import FloatArray

COLUMNS = ("x_m", "y_m", "w_tr_right_m", "w_tr_left_m")
MEANT = {
    "x_m": re.compile(r"x\b|x_|.*_x\b"),
    "y_m": re.compile(r"y\b|y_|.*_y\b"),
    "w_tr_right_m": re.compile(r".*(right|rigth)"),
    "w_tr_left_m": re.compile(r".*(left|lft)"),
}
"""What a name looks like that seems to mean a column."""
NAME = re.compile(r"[^\W\d][\w.\-/°]*\s*(\[[^\]]*\]|\([^)]*\))?")
"""One word, and a unit in brackets after it."""


@dataclass(frozen=True)
class Columns:
    """Places of x, y, right and left width in a row, the separator, and other columns' names."""

    order: tuple[int, ...]
    separator: str
    count: int
    """of all columns"""
    extra: tuple[str, ...] = ()


def columns_of(path: Path, rows: Sequence[tuple[int, str]]) -> Columns:
    """Columns of a file from its rows (line, text), empty ones left out.

    Raises ImportSourceError with the line for names that are not ``COLUMNS``, and where there are
    neither names nor four columns.
    """
    data = next(((k, row) for k, row in rows if not row.startswith("#") and is_data(row)), None)
    if data is None:
        raise refused(path, "no row that begins with a number; columns: " + ", ".join(COLUMNS))
    separator = ";" if ";" in data[1] else ","
    count = len(_cells(path, *data, separator))
    above = [(k, row, _names(row)) for k, row in rows if k < data[0]]
    headers = [(k, names) for k, _, names in above if _is_header(names)]
    for k, row, names in above:
        if not row.startswith("#") and len(names) < 2:
            quoted = escaped(row[:40])
            raise refused(path, f'"{quoted}" names no columns; a comment begins with #', k)
        if not headers and (not row.startswith("#") or _lists_names(names, count)):
            raise refused(path, _unknown(names), k)
    if not headers:
        _check_count(path, data, separator, count)
        return Columns((0, 1, 2, 3), separator, count)
    line, header = headers[-1]
    if any(name not in header for name in COLUMNS):
        raise refused(path, _unknown(header), line)
    twice = next((name for name in COLUMNS if header.count(name) > 1), None)
    if twice is not None:
        raise refused(path, f"two columns {twice}", line)
    extra = tuple(escaped(name) for name in header if name and name not in COLUMNS)
    order = tuple(header.index(name) for name in COLUMNS)
    return Columns(order, separator, len(header), extra)


def _cells(path: Path, line: int, row: str, separator: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([row], delimiter=separator))]
    except csv.Error:
        raise refused(path, "a row that is none of a table", line) from None


def is_data(row: str) -> bool:
    """Whether a row holds values rather than names: its first cell does not begin with a letter.

    Its first that holds anything: tables with numbered rows have none above their numbers.
    """
    first = row.lstrip("\"',;% \t")[:3].lower()
    return not first[:1].isalpha() or first in ("nan", "inf")


def _names(row: str) -> list[str]:
    return [name.strip(" \"'#\t").lower() for name in row.replace(";", ",").split(",")]


def _is_header(names: list[str]) -> bool:
    return "x_m" in names or len(set(names) & set(COLUMNS)) >= 2


def _lists_names(names: list[str], count: int) -> bool:
    """Whether a comment lists names of ``count`` columns, or at least an x and a y."""
    if len(names) < 2 or not all(NAME.fullmatch(name) for name in names):
        return False
    places = (_meant(column, names) for column in ("x_m", "y_m"))
    return len(names) == count or all(places)


def _meant(column: str, names: Sequence[str]) -> str:
    """Name that seems to mean a column; empty where none does, or several."""
    like = [name for name in names if name not in COLUMNS and MEANT[column].match(name)]
    return like[0] if len(like) == 1 else ""


def _unknown(names: list[str]) -> str:
    """What to say of names among which some of the four are missing."""
    missing = [column for column in COLUMNS if column not in names]
    there = f"no column {missing[0]}; there: {escaped(', '.join(names))[:200]}"
    meant = {column: _meant(column, names) for column in missing}
    if all(meant.values()):
        pairs = ", ".join(f"{escaped(name)[:40]} to {column}" for column, name in meant.items())
        return f"{there}; rename {pairs}, if that is what they are"
    return there + nearest(missing[0], names)


def _check_count(path: Path, data: tuple[int, str], separator: str, count: int) -> None:
    if separator == "," and count == 1 and len(data[1].split()) == 4:
        raise refused(path, "the values are separated by spaces; separate them by commas", data[0])
    if count != 4:
        raise refused(
            path, f"{count} columns and no names; 4 are needed: {', '.join(COLUMNS)}", data[0]
        )


MOST_POINTS = 15_000
MOST_LINES = 300_000
"""Lines of a file, with empty ones, comments and points that are repeated."""


@dataclass(frozen=True)
class TrackFile:
    """The rows of a track: points (n, 2) [m] and widths (n,) [m]."""

    points: FloatArray
    right: FloatArray
    left: FloatArray
    changes: tuple[str, ...]
    origin: FloatArray
    """(2,) [m] that has been taken from the points of the file"""


def read_track_file(path: Path, text: str, scale: float) -> TrackFile:
    """Read the rows; ``scale`` [m per unit of the file].

    Raises ImportSourceError for too many lines; with file:line for what is no number, not finite,
    out of range, or a width that is not positive. A point that repeats the one before it is dropped
    and listed.
    """
    if (count := text.count("\n")) > MOST_LINES:
        raise refused(path, f"{count} lines; at most {MOST_LINES} are read")
    rows = [(k, row.strip()) for k, row in enumerate(text.split("\n"), start=1)]
    rows = [(k, row) for k, row in rows if row]
    columns = columns_of(path, rows)
    extra = f"columns left out: {', '.join(columns.extra)}"
    changes = [f"{extra[:200]}…" if len(extra) > 200 else extra] if columns.extra else []
    values, lines, repeated = list[list[float]](), list[int](), list[str]()
    for k, row in rows:
        if row.startswith("#") or not is_data(row):
            if values and not row.startswith("#"):
                raise refused(path, f'"{escaped(row[:40])}" is not a row of numbers', k)
            continue
        value = [v * scale for v in _numbers(path, k, row, columns)]
        _check(path, k, value)
        if values and math.dist(values[-1][:2], value[:2]) <= 1e-6:
            repeated.append(f"line {k}: repeats the point before it, dropped")
            continue
        values.append(value)
        lines.append(k)
        if len(values) > MOST_POINTS:
            raise refused(path, f"more than {MOST_POINTS} points", k)
    if len(values) < 2:
        raise refused(path, f"{len(values)} points; a centreline needs at least 2")
    table = np.array(values)
    origin = grid_origin(table[:, :2])
    table[:, :2] -= origin
    _check_size(path, lines, table)
    changes += listed(repeated)
    return TrackFile(table[:, :2], table[:, 2], table[:, 3], tuple(changes), origin)


def _numbers(path: Path, line: int, row: str, columns: Columns) -> list[float]:
    order, separator = columns.order, columns.separator
    cells = _cells(path, line, row, separator)
    if separator == ";" and any("," in cell for cell in cells):
        raise refused(path, "numbers with a decimal comma; write a point", line)
    if len(cells) <= max(order):
        raise refused(path, f"{len(cells)} values; {max(order) + 1} are needed", line)
    if any(cells[columns.count :]):
        more = "; numbers with a decimal comma? write a point" if separator == "," else ""
        message = f"{len(cells)} values in {columns.count} columns{more}"
        raise refused(path, message, line)
    values = []
    for name, cell in zip(COLUMNS, (cells[k] for k in order), strict=True):
        try:
            values.append(float(cell) if cell.isascii() and "_" not in cell else math.nan)
        except ValueError:
            message = f'{name}: "{escaped(cell[:40])}" is not a number'
            raise refused(path, message, line) from None
    return values


def _check(path: Path, line: int, value: list[float]) -> None:
    for name, v in zip(COLUMNS, value, strict=True):
        if not math.isfinite(v):
            raise refused(path, f"{name}: {v} is not a finite number", line)
    for name, v in zip(COLUMNS[2:], value[2:], strict=True):
        if v <= 0.0:
            raise refused(path, f"{name}: a width of {v:g} m; it must be greater than 0", line)


def _check_size(path: Path, lines: list[int], table: FloatArray) -> None:
    """Refuse a number beyond what a world may hold; of points the one farthest from the others."""
    if np.abs(table).max() <= LARGEST:
        return
    away = np.abs(table - np.median(table, axis=0))
    away[np.abs(table) <= LARGEST] *= 1.0 - 1e-9  # of two points that which is beyond
    k, column = np.unravel_index(np.argmax(away), away.shape)
    message = (
        f"{COLUMNS[column]}: {table[k, column]:g} m is {away[k, column]:g} m from the middle one "
        f"of all, and a world reaches to {LARGEST:g} m; check it, or --scale"
    )
    raise refused(path, message, lines[k])
