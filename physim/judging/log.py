"""Read a log of poses: a CSV file or a data frame, a row for each sample of a robot.

Every fault is one line: file, line and column, what was given, and how to mend it. A log is read as
numbers and names; nothing in it is run.
"""

from __future__ import annotations

import csv
import hashlib
import math
import os
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from physim.errors import PhysimError, Position, nearest
from physim.geometry.shapes import FloatArray, IntArray
from physim.record.layout import FAR
from physim.units import joined

COLUMNS = ("time", "robot", "x", "y", "heading")
"""What a log must have: s, name or number of the robot, m, m, rad; in any order"""
MOST_BYTES = 1 << 29
"""of a file: some ten million samples"""
LONGEST_LINE = 1 << 16
"""Characters; a file with longer ones is no log"""
FARTHEST = 0.01 * FAR
"""[m] from the origin, as a world's own coordinates may be"""
SHOWN_NAMES = 12
SHOWN = 40
"""Characters of a cell that an error repeats"""


@dataclass(frozen=True)
class Track:
    """The samples of one robot, in the order of time."""

    name: str
    time: FloatArray
    """(M,) [s] as logged, increasing"""
    pose: FloatArray
    """(M, 3) [m, m, rad] headings as logged"""
    row: IntArray
    """(M,) line of the file, or row of the data frame, of each sample"""


@dataclass(frozen=True)
class Log:
    """What was logged of the robots of a world."""

    name: str
    sha256: str
    """of the file, or of the values of a data frame"""
    tracks: tuple[Track, ...]
    """of each robot of the world, in its order"""
    unread: tuple[str, ...]
    """columns that are not read"""
    place: Callable[[int, str], str]
    """where a value stands, by its row and column"""

    def refuse(self, row: int, column: str, fault: str) -> NoReturn:
        """Raise PhysimError for a value: where it stands, and what is wrong."""
        raise PhysimError(f"{self.place(row, column)}: {fault}")


def read_log(
    log: str | os.PathLike[str] | Mapping[str, Any],
    names: Sequence[str],
    columns: Mapping[str, str],
) -> Log:
    """Read the samples of the robots of these ``names`` from a CSV file or a data frame.

    ``columns`` says what the log calls a column of `COLUMNS`, where it has another name. Raises
    PhysimError, one line, for the first fault.
    """
    for key in columns:
        if key not in COLUMNS:
            raise PhysimError(
                f"columns: {key!r} is none of {', '.join(COLUMNS)}{nearest(key, [*COLUMNS])}"
            )
    if isinstance(log, str | os.PathLike):
        return _read_file(Path(log), names, columns)
    if not hasattr(log, "keys"):
        raise TypeError(f"a log is a CSV file or a data frame, not {type(log).__name__}")
    head = [str(key) for key in log]
    cells = [np.asarray(log[key]).tolist() for key in log]
    rows = enumerate(zip(*cells, strict=True))

    def place(row: int, column: str) -> str:
        return f"the log, row {row}, column {columns.get(column, column)}"

    digest = hashlib.sha256(repr((head, cells)).encode()).hexdigest()
    return _logged("data frame", digest, head, rows, "the log", place, names, columns)


def _read_file(path: Path, names: Sequence[str], columns: Mapping[str, str]) -> Log:
    if not path.is_file():  # a pipe would hang
        what = "is no file" if path.exists() else "no such file"
        raise PhysimError(f"{path}: {what}; give a CSV file with columns {', '.join(COLUMNS)}")
    if (size := path.stat().st_size) > MOST_BYTES:
        raise PhysimError(
            f"{path}: {size / 1e6:.0f} MB; at most {MOST_BYTES / 1e6:.0f} MB are read; cut the log "
            "into parts, or keep fewer samples"
        )
    head: list[str] = []

    def place(row: int, column: str) -> str:
        with path.open(encoding="utf-8-sig", newline="") as file:
            line = next((one for k, one in enumerate(file, 1) if k == row), "")
        k = head.index(columns.get(column, column))
        before = next(csv.reader([line]), [])[:k]
        return str(Position(path, row, 1 + sum(len(cell) + 1 for cell in before)))

    number = 1
    try:
        with path.open("rb") as raw:
            digest = hashlib.file_digest(raw, "sha256").hexdigest()
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(_lines(file), strict=True)
            head += [cell.strip() for cell in next(reader, [])]
            rows = ((number := reader.line_num, row) for row in reader if row)
            where = f"{path}:1:1"
            return _logged(path.name, digest, head, rows, where, place, names, columns)
    except (csv.Error, UnicodeDecodeError) as error:
        raise PhysimError(
            f"{path}:{number}: not a CSV file in UTF-8 from here on ({error}); a log is lines of "
            "values between commas"
        ) from None
    except OSError as error:
        raise PhysimError(f"{path}: cannot be read: {error.strerror}") from None


def _lines(file: Any) -> Iterator[str]:
    while line := file.readline(LONGEST_LINE):
        if len(line) == LONGEST_LINE:
            raise csv.Error(f"a line of more than {LONGEST_LINE} characters")
        yield line


def _logged(
    name: str,
    digest: str,
    head: Sequence[str],
    rows: Iterator[tuple[int, Sequence[Any]]],
    where: str,
    place: Callable[[int, str], str],
    names: Sequence[str],
    columns: Mapping[str, str],
) -> Log:
    """Put rows of cells, each with its number, to the robots they are of."""
    at = _places(head, where, columns)
    time, robot, *pose = (at[column] for column in COLUMNS)
    known = {str(k): k for k in range(len(names))} | {one: k for k, one in enumerate(names)}
    row_of, robot_of, numbers = array("q"), array("q"), array("d")
    for number, row in rows:
        if len(row) != len(head):
            raise PhysimError(
                f"{where.rpartition(':')[0].rpartition(':')[0]}:{number}:1: {len(row)} values; the "
                f"first line names {len(head)} columns"
            )
        try:
            numbers.extend((float(row[time]), *(float(row[k]) for k in pose)))
            robot_of.append(known[str(row[robot]).strip()])
        except (ValueError, TypeError):
            _refuse_number(number, row, at, place)
        except KeyError:
            given = str(row[robot]).strip()[:SHOWN]
            listed = ", ".join(names[:SHOWN_NAMES]) + (", …" if len(names) > SHOWN_NAMES else "")
            raise PhysimError(
                f"{place(number, 'robot')}: the world has no robot {given!r}; its robots are "
                f"{listed}, or 0 to {len(names) - 1} in that order{nearest(given, [*names])}"
            ) from None
        row_of.append(number)
    values = np.array(numbers).reshape(-1, 4)
    lines, who = np.array(row_of, dtype=np.int64), np.array(robot_of, dtype=np.int64)
    order = np.argsort(who, kind="stable")
    values, lines, who = values[order], lines[order], who[order]
    for k, column in enumerate(one for one in COLUMNS if one != "robot"):
        most = FARTHEST if column in "xy" else math.inf
        if len(wrong := np.flatnonzero(~(np.abs(values[:, k]) <= most) | np.isinf(values[:, k]))):
            first = int(wrong[np.argmin(lines[wrong])])
            raise PhysimError(
                f"{place(int(lines[first]), column)}: {column} is {values[first, k]:g}; it must be "
                f"a finite number{f', at most {most:g} m from 0' if most < math.inf else ''}; leave "
                "out samples in which a robot was not seen"
            )
    ends = np.searchsorted(who, np.arange(len(names) + 1))
    tracks = []
    for k, one in enumerate(names):
        mine = slice(ends[k], ends[k + 1])
        if (count := len(lines[mine])) < 2:
            raise PhysimError(
                f"{where}: robot {one} of the world has {count or 'no'} "
                f"sample{'s' * (count != 1)}; each needs at least two; log it, or take it out of "
                "the world"
            )
        track = Track(one, values[mine, 0], values[mine, 1:], lines[mine])
        if (late := np.flatnonzero(np.diff(track.time) <= 0.0)).size:
            before, after = (float(track.time[late[0] + j]) for j in (0, 1))
            fault = f"{after:.12g} s comes after {before:.12g} s; sort the rows by time"
            if before == after:
                fault = f"a second sample at {after:.12g} s; keep one"
            raise PhysimError(f"{place(int(track.row[late[0] + 1]), 'time')}: {one}: {fault}")
        tracks.append(track)
    unread = tuple(one for k, one in enumerate(head) if k not in at.values())
    return Log(name, digest, tuple(tracks), unread, place)


def _places(head: Sequence[str], where: str, columns: Mapping[str, str]) -> dict[str, int]:
    """Which of the columns that the first line names are those of `COLUMNS`."""
    found = {}
    for column in COLUMNS:
        called = columns.get(column, column)
        if head.count(called) == 1:
            found[column] = head.index(called)
            continue
        short = [one[:SHOWN] for one in head[:SHOWN_NAMES]]
        fault = (
            f"the first line must name a column {called!r}; it names {joined(short or ['none'])}"
        )
        if called in head:
            fault = f"column {called!r} is there {head.count(called)} times"
        elif len(head) == 1 and (";" in head[0] or "\t" in head[0]):
            fault += "; separate the columns by commas"
        else:
            fault += (
                f"{nearest(called, short)}; if it has another name, give --columns {column}=NAME"
            )
        raise PhysimError(f"{where}: {fault}")
    return found


def _refuse_number(
    number: int, row: Sequence[Any], at: Mapping[str, int], place: Callable[[int, str], str]
) -> NoReturn:
    """Raise PhysimError for the first cell of a row that should be a number and is none."""
    for column in (one for one in COLUMNS if one != "robot"):
        try:
            float(row[at[column]])
        except (ValueError, TypeError):
            given = repr(str(row[at[column]])[:SHOWN])
            raise PhysimError(
                f"{place(number, column)}: {column} is {given}; it must be a number"
            ) from None
    raise AssertionError(number)
