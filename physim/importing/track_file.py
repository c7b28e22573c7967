"""A centreline with widths, in the race-track convention: ``x_m, y_m, w_tr_right_m, w_tr_left_m``.

Commas or semicolons between values; lines that begin with ``#`` are comments.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.importing.drawing import LARGEST, listed, printable, refused
from physim.importing.track_columns import COLUMNS, Columns, columns_of, is_data

MOST_POINTS = 100_000


@dataclass(frozen=True)
class TrackFile:
    """The rows of a track: points (n, 2) [m] and widths (n,) [m]."""

    points: FloatArray
    right: FloatArray
    left: FloatArray
    changes: tuple[str, ...]


def read_track_file(path: Path, text: str, scale: float) -> TrackFile:
    """Read the rows; ``scale`` [m per unit of the file].

    Raises ImportSourceError with file:line for what is no number, not finite, out of range, or a
    width that is not positive. A point that repeats the one before it is dropped and listed.
    """
    rows = [(k, row.strip()) for k, row in enumerate(text.split("\n"), start=1)]
    rows = [(k, row) for k, row in rows if row]
    columns = columns_of(path, rows)
    changes = [f"columns left out: {', '.join(columns.extra)}"] if columns.extra else []
    values: list[list[float]] = []
    repeated: list[str] = []
    for k, row in rows:
        if row.startswith("#") or not is_data(row):
            if values and not row.startswith("#"):
                raise refused(path, f'"{printable(row[:40])}" is not a row of numbers', k)
            continue
        value = [v * scale for v in _numbers(path, k, row, columns)]
        _check(path, k, value)
        if values and math.dist(values[-1][:2], value[:2]) <= 1e-6:
            repeated.append(f"line {k}: repeats the point before it, dropped")
            continue
        values.append(value)
        if len(values) > MOST_POINTS:
            raise refused(path, f"more than {MOST_POINTS} points", k)
    if len(values) < 2:
        raise refused(path, f"{len(values)} points; a centreline needs at least 2")
    table = np.array(values)
    changes += listed(repeated)
    return TrackFile(table[:, :2], table[:, 2], table[:, 3], tuple(changes))


def _numbers(path: Path, line: int, row: str, columns: Columns) -> list[float]:
    order, separator = columns.order, columns.separator
    cells = [cell.strip() for cell in row.split(separator)]
    if separator == ";" and any("," in cell for cell in cells):
        raise refused(path, "numbers with a decimal comma; write a point", line)
    if len(cells) <= max(order):
        raise refused(path, f"{len(cells)} values; {max(order) + 1} are needed", line)
    values = []
    for name, cell in zip(COLUMNS, (cells[k] for k in order), strict=True):
        try:
            values.append(float(cell) if "_" not in cell else math.nan)
        except ValueError:
            message = f'{name}: "{printable(cell[:40])}" is not a number'
            raise refused(path, message, line) from None
    return values


def _check(path: Path, line: int, value: list[float]) -> None:
    for name, v in zip(COLUMNS, value, strict=True):
        if not math.isfinite(v):
            raise refused(path, f"{name}: {v} is not a finite number", line)
        if abs(v) > LARGEST:
            raise refused(path, f"{name}: {v:g} m is beyond {LARGEST:g} m; check --scale", line)
    for name, v in zip(COLUMNS[2:], value[2:], strict=True):
        if v <= 0.0:
            raise refused(path, f"{name}: a width of {v:g} m; it must be greater than 0", line)
