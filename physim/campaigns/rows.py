"""Rows on disk: in shards that appear whole.

A shard is a file of JSON lines in ``rows/`` that is written under another name, then renamed.
Every writer puts its own small shards together into larger ones, which appear before the small
ones go: at any moment all rows are there, some of them twice; who reads takes each run once.
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import uuid4

from physim.campaigns.columns import (
    COLUMNS,
    DURATION,
    ERROR,
    FAILED,
    FINISHED,
    KILLED,
    TIMEOUT,
    TIMES,
    Row,
    row_of,
    schema,
)
from physim.drafts import draft_of
from physim.errors import Notice, PhysimError
from physim.json_text import parse_json

if TYPE_CHECKING:
    import pyarrow as pa

FOLDER = "rows"
SUFFIX = ".jsonl"
LONGEST_ROW = 1_000_000
"""Bytes of a line; a row has a thousandth of them"""
TOGETHER = 64
"""Shards of one size that are put together into one of the next"""


def check_places(folder: Path) -> None:
    """Raise PhysimError where a campaign's folder holds links, pipes or devices.

    It may come from a stranger: reading or writing through a link would leave the folder, reading a
    pipe would never end. Its own folders, one deep, hold regular files.
    """
    try:
        for entry in os.scandir(folder):
            _check_entry(entry)
            if entry.is_dir(follow_symlinks=False):
                for one in os.scandir(entry.path):
                    _check_entry(one)
    except (FileNotFoundError, NotADirectoryError):
        return  # whoever needs it says so
    except OSError as error:
        raise PhysimError(f"{folder}: cannot be read: {error.strerror}") from None


def _check_entry(entry: os.DirEntry[str]) -> None:
    if not entry.is_file(follow_symlinks=False) and not entry.is_dir(follow_symlinks=False):
        what = "a link" if entry.is_symlink() else "a pipe or a device"
        raise PhysimError(
            f"{entry.path}: is {what}; the folder of a campaign holds files and folders of its own"
        )


class Shards:
    """The rows of a folder, and one writer of them. PhysimError for one with links or pipes."""

    def __init__(self, folder: Path) -> None:
        check_places(folder)
        self.folder = folder / FOLDER
        self._writer = uuid4().hex[:12]
        self._count = 0
        self._mine: dict[int, list[Path]] = {}
        self._cut: set[Path] = set()
        """shards whose last line is cut off"""

    def write(self, rows: Iterable[Row]) -> list[str]:
        """Put rows on disk, all or none; names of the shards that are there by that.

        Raises PhysimError where that fails.
        """
        lines = [_line(row) for row in rows]
        return self._put(0, lines) if lines else []

    def read(self, but: set[str] | None = None) -> Iterator[Row]:
        """All rows on disk, each run once: of one that was done again the row that says more.

        Shards whose names are in ``but`` are left out; those that were read are added to it. Raises
        PhysimError for a row that is none.
        """
        found: dict[str, Row] = {}
        for row in self.each(but):
            found[row.run] = _better(found.get(row.run), row)
        yield from found.values()

    def each(self, but: set[str] | None = None) -> Iterator[Row]:
        """All rows as they are read, some runs more than once; otherwise as `read`."""
        known = set() if but is None else but
        while new := [file for file in self.files() if file.name not in known]:
            for file in new:
                with suppress(FileNotFoundError):  # its rows are in a larger one by now
                    for row, _ in self._rows(file):
                        yield row
                known.add(file.name)

    def are_plain(self, file: Path, plain: Callable[[bytes], bool]) -> bool:
        """Whether all lines of a shard are whole and ``plain``. Raises as `rows_of`."""
        return all(line.endswith(b"\n") and plain(line) for line in _lines(file))

    def rows_of(self, file: Path) -> list[Row]:
        """Rows of one shard. Raises PhysimError where it is none, FileNotFoundError."""
        return [row for row, _ in self._rows(file)]

    def _rows(self, file: Path) -> Iterator[tuple[Row, bytes]]:
        """Rows of one shard with their lines. A last line that was cut off is told and left out."""
        for number, line in enumerate(_lines(file), 1):
            try:
                try:
                    tree = parse_json(line)
                except ValueError as error:
                    if line.endswith(b"\n"):
                        raise ValueError(f"is no row: {error}") from None
                    self._tell_cut(file, number)
                    return
                row = row_of(tree)
            except ValueError as error:
                raise PhysimError(f"{file}:{number}: {error}") from None
            yield row, line

    def _tell_cut(self, file: Path, number: int) -> None:
        if file not in self._cut:
            self._cut.add(file)
            text = f"{file}:{number}: the last line is cut off; its run counts as not done"
            warnings.warn(text, Notice, stacklevel=2)

    def put_together(self) -> None:
        """Leave few shards of whatever writer, none cut off; others may write meanwhile."""
        small = [file for file in self.files() if _level(file) < 2 or file in self._cut]
        if len(small) > 1 or self._cut.intersection(small):
            self._merge(2, small)

    def _put(self, level: int, lines: list[bytes]) -> list[str]:
        self._count += 1
        path = self.folder / f"{_stamp()}-{level}-{self._writer}-{self._count:06d}{SUFFIX}"
        write_whole(path, b"".join(lines))
        mine = self._mine.setdefault(level, [])
        mine.append(path)
        if len(mine) < TOGETHER or level == 2:
            return [path.name]
        self._mine[level] = []
        return [path.name, *self._merge(level + 1, mine)]

    def _merge(self, level: int, files: list[Path]) -> list[str]:
        lines: dict[str, tuple[bool, bytes]] = {}
        """Of each run whether it failed, and its line: far less than rows."""
        read = []
        for file in files:
            with suppress(FileNotFoundError):
                for row, line in self._rows(file):
                    if not row.failed or lines.get(row.run, (True,))[0]:
                        lines[row.run] = row.failed, line.rstrip() + b"\n"
                read.append(file)
        names = self._put(level, [line for _, line in lines.values()]) if lines else []
        _settle(self.folder)
        for file in read:
            with suppress(OSError):
                file.unlink()
            self._cut.discard(file)
        return names

    def files(self) -> list[Path]:
        """Shards in the order in which they were written."""
        try:
            names = sorted(one.name for one in os.scandir(self.folder))
        except FileNotFoundError:
            return []
        return [self.folder / name for name in names if name.endswith(SUFFIX) and name[0] != "."]


def read(folder: str | os.PathLike[str]) -> pa.Table:
    """All rows of a campaign's folder, each run once, in the order of world, settings, controller
    and seed. Raises PhysimError where there are none or one cannot be read."""
    from physim.campaigns.reading import read_table

    return read_table(Path(folder))


def in_order(rows: Iterable[Row]) -> list[Row]:
    """Rows in the order of world, settings, controller and seed."""
    return sorted(
        rows, key=lambda row: (row.world, row.settings, row.controller, row.seed, row.run)
    )


def write_whole(path: Path, data: bytes) -> None:
    """Put a file in its place, whole and on the disk. PhysimError where that fails."""
    draft = draft_of(path)
    try:
        with open(draft, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        draft.replace(path)
    except OSError as error:
        raise PhysimError(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        with suppress(OSError):
            draft.unlink()


def _better(one: Row | None, other: Row) -> Row:
    """Of two rows of the same run the one that says more, else the later one."""
    return one if one is not None and other.failed and not one.failed else other


def _line(row: Row) -> bytes:
    return json.dumps(asdict(row), allow_nan=False).encode() + b"\n"


def _lines(file: Path) -> Iterator[bytes]:
    try:
        with open(file, "rb") as stream:
            number = 0
            while line := stream.readline(LONGEST_ROW):
                number += 1
                if len(line) == LONGEST_ROW:
                    raise PhysimError(
                        f"{file}:{number}: is no row: has {LONGEST_ROW} bytes or more"
                    )
                yield line
    except FileNotFoundError:
        raise
    except OSError as error:
        raise PhysimError(f"{file}: cannot be read: {error.strerror}") from None


def _settle(folder: Path) -> None:
    """Let names of files last, before those that they replace go; where the system can do it."""
    with suppress(OSError):
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


def _level(file: Path) -> int:
    part = file.name.split("-")[1:2]
    return int(part[0]) if part and part[0].isdigit() else 2


def _stamp() -> str:
    """Time by which shards of several writers are in order."""
    import time

    return f"{time.time_ns():020d}"


__all__ = [
    "COLUMNS",
    "DURATION",
    "ERROR",
    "FAILED",
    "FINISHED",
    "KILLED",
    "TIMEOUT",
    "TIMES",
    "Row",
    "Shards",
    "in_order",
    "read",
    "schema",
    "write_whole",
]
