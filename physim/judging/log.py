"""Read a log of poses: a CSV file with a row for each sample of a robot.

Every fault is one line: file, line and column, what was given, and how to mend it. A log is read as
numbers and names; nothing in it is run.
"""

from __future__ import annotations

import csv
import hashlib
import math
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from physim.errors import PhysimError, Position, nearest
from physim.geometry.shapes import FloatArray, IntArray

COLUMNS = ("time", "x", "y", "heading", "robot")
"""What the first line must name, in any order; the last is a robot's name or number"""
MOST_BYTES = 1 << 29
"""of a file: some ten million samples"""
LONGEST_LINE = 1 << 16
"""Characters; a file with longer ones is no log"""
FARTHEST = 1e6
"""[m] from the origin, as of a world"""
SHOWN = 12
"""Names that an error lists"""


@dataclass(frozen=True)
class Track:
    """The samples of one robot, in the order of time."""

    name: str
    time: FloatArray
    """(M,) [s] as logged, increasing"""
    pose: FloatArray
    """(M, 3) [m, m, rad or degrees] as logged"""
    line: IntArray
    """(M,) line of the file"""


@dataclass(frozen=True)
class Log:
    """What was logged of the robots of a world."""

    path: Path
    sha256: str
    columns: tuple[str, ...]
    """as the first line names them"""
    tracks: tuple[Track, ...] = ()
    """of each robot of the world, in its order"""

    def refuse(self, line: int, column: str, fault: str) -> NoReturn:
        """Raise PhysimError for a value: where it stands, and what is wrong."""
        with self.path.open(encoding="utf-8-sig", newline="") as file:
            text = next((one for number, one in enumerate(file, 1) if number == line), "")
        before = next(csv.reader([text]), [])[: self.columns.index(column)]
        place = Position(self.path, line, 1 + sum(len(cell) + 1 for cell in before))
        raise PhysimError(f"{place}: {fault}")


def read_log(path: Path, names: Sequence[str]) -> Log:
    """Read the samples of the robots of these ``names``.

    Raises PhysimError, one line, for the first fault.
    """
    if not path.is_file():  # a pipe would hang
        what = "is no file" if path.exists() else "no such file"
        raise PhysimError(f"{path}: {what}; give a CSV file with columns {', '.join(COLUMNS)}")
    if (size := path.stat().st_size) > MOST_BYTES:
        raise PhysimError(
            f"{path}: {size / 1e6:.0f} MB; at most {MOST_BYTES / 1e6:.0f} MB are read; cut the log "
            "into parts, or keep fewer samples"
        )
    number = 1
    try:
        with path.open("rb") as raw:
            digest = hashlib.file_digest(raw, "sha256").hexdigest()
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(_lines(file), strict=True)
            head = tuple(cell.strip() for cell in next(reader, []))
            rows = ((number := reader.line_num, row) for row in reader if row)
            return _tracked(Log(path, digest, head), rows, names)
    except (csv.Error, UnicodeDecodeError) as error:
        raise PhysimError(
            f"{Position(path, number, 1)}: from here on no CSV in UTF-8 ({error}); write lines of "
            "values between commas"
        ) from None
    except OSError as error:
        raise PhysimError(f"{path}: cannot be read: {error.strerror}") from None


def _lines(file: Any) -> Iterator[str]:
    while line := file.readline(LONGEST_LINE):
        if len(line) == LONGEST_LINE:
            raise csv.Error(f"a line of more than {LONGEST_LINE} characters")
        yield line


def _tracked(log: Log, rows: Iterator[tuple[int, list[str]]], names: Sequence[str]) -> Log:
    """The log with its rows, each with its line, put to the robots that they are of."""
    *numeric, at = (_place(log, column) for column in COLUMNS)
    known = {str(k): k for k in range(len(names))} | {one: k for k, one in enumerate(names)}
    lines, who, numbers = array("q"), array("q"), array("d")
    for line, row in rows:
        if len(row) != len(log.columns):
            raise PhysimError(
                f"{Position(log.path, line, 1)}: {len(row)} values for the {len(log.columns)} "
                "columns that the first line names"
            )
        for column, k in zip(COLUMNS, numeric, strict=False):
            try:
                numbers.append(float(row[k]))
            except ValueError:
                log.refuse(line, column, f"{column} is {row[k][:40]!r}; it must be a number")
        if (robot := known.get(row[at].strip())) is None:
            listed = ", ".join(names[:SHOWN]) + (", …" if len(names) > SHOWN else "")
            log.refuse(
                line, "robot",
                f"the world has no robot {row[at][:40]!r}; it has {listed}, or by number 0 to "
                f"{len(names) - 1}{nearest(row[at][:40], [*names])}",
            )  # fmt: skip
        lines.append(line)
        who.append(robot)
    values, line_of = np.array(numbers).reshape(-1, 4), np.array(lines, dtype=np.int64)
    most = np.array((math.inf, FARTHEST, FARTHEST, math.inf))
    for row_, k in np.argwhere(~(np.isfinite(values) & (np.abs(values) <= most)))[:1].tolist():
        log.refuse(
            int(line_of[row_]), COLUMNS[k],
            f"{COLUMNS[k]} is {values[row_, k]:g}; it must be a finite number, x and y at most "
            f"{FARTHEST:g} m from 0; leave out samples in which a robot was not seen",
        )  # fmt: skip
    robots, tracks = np.array(who, dtype=np.int64), []
    order = np.argsort(robots, kind="stable")
    ends = np.searchsorted(robots[order], np.arange(len(names) + 1))
    for k, name in enumerate(names):
        mine = order[ends[k] : ends[k + 1]]
        if len(mine) < 2:
            raise PhysimError(
                f"{Position(log.path, 1, 1)}: robot {name} of the world has {len(mine) or 'no'} "
                f"sample{'s' * (len(mine) != 1)}, and needs two at least; log it, or take it out "
                "of the world"
            )
        track = Track(name, values[mine, 0], values[mine, 1:], line_of[mine])
        for late in np.flatnonzero(np.diff(track.time) <= 0.0)[:1].tolist():
            before, after = track.time[late : late + 2].tolist()
            fault = f"{after:.12g} s comes after {before:.12g} s; sort the rows by time"
            fault = f"a second sample at {after:.12g} s; keep one" if before == after else fault
            log.refuse(int(track.line[late + 1]), "time", f"{name}: {fault}")
        tracks.append(track)
    return Log(log.path, log.sha256, log.columns, tuple(tracks))


def _place(log: Log, column: str) -> int:
    """Where a column stands. Raises PhysimError unless the first line names it once."""
    if log.columns.count(column) == 1:
        return log.columns.index(column)
    named = [one[:40] for one in log.columns[:SHOWN]]
    fault = f"the first line must name a column {column}; it names {', '.join(named) or 'none'}"
    if column in log.columns:
        fault = f"the first line names {column} twice; rename one"
    elif len(named) == 1:
        fault += "; separate the columns by commas"
    else:
        fault += f"{nearest(column, named)}; name it so there"
    raise PhysimError(f"{Position(log.path, 1, 1)}: {fault}")
