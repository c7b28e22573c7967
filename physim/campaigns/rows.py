"""Rows on disk: in shards that appear whole.

A shard is a file of JSON lines in ``rows/`` that is written under another name, then renamed.
Every writer puts its own small shards together into larger ones, which appear before the small
ones go: at any moment all rows are there, some of them twice; who reads takes each run once.
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import uuid4

from physim.campaigns.columns import FAILED, Row, row_of
from physim.campaigns.shard import Part, read_shard
from physim.drafts import discard, draft_of
from physim.errors import Notice, PhysimError

if TYPE_CHECKING:
    import pyarrow as pa

FOLDER = "rows"
SUFFIX = ".jsonl"
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

    def tables(self, but: set[str] | None = None) -> Iterator[pa.Table]:
        """The rows of all shards, part by part, some runs more than once, every row checked.

        Shards whose names are in ``but`` are left out; those that were read are added to it. Raises
        PhysimError for a row that is none.
        """
        known = set() if but is None else but
        while new := [file for file in self.files() if file.name not in known]:
            for file in new:
                known.add(file.name)
                with suppress(FileNotFoundError):  # its rows are in a larger one by now
                    for part in self._read(file):
                        yield part.table

    def _read(self, file: Path) -> Iterator[Part]:
        """One shard. A last line that was cut off is told and left out."""
        for part in read_shard(file):
            if part.cut:
                self._tell_cut(file, part.cut)
            yield part

    def _tell_cut(self, file: Path, number: int) -> None:
        if file not in self._cut:
            self._cut.add(file)
            text = f"{file}:{number}: the last line is cut off; its run counts as not done"
            warnings.warn(text, Notice, stacklevel=2)

    def place_of(self, row: Mapping[str, object]) -> str:
        """``FILE:LINE`` of the last row with these columns, which one of the shards has."""
        place, run = str(self.folder), str(row["run"]).encode()
        for file in self.files():
            with suppress(OSError, ValueError):
                for number, line in enumerate(file.read_bytes().split(b"\n"), 1):
                    if run in line and row.items() <= asdict(row_of(json.loads(line))).items():
                        place = f"{file}:{number}"
        return place

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
                for part in self._read(file):
                    runs, ends = (part.table[name].to_pylist() for name in ("run", "ended"))
                    for run, end, line in zip(runs, ends, part.lines, strict=True):
                        if end not in FAILED or lines.get(run, (True,))[0]:
                            lines[run] = end in FAILED, line.rstrip() + b"\n"
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
        except (FileNotFoundError, NotADirectoryError):  # whoever needs one says so
            return []
        return [self.folder / name for name in names if name.endswith(SUFFIX) and name[0] != "."]


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
        discard(draft)


def _line(row: Row) -> bytes:
    return json.dumps(asdict(row), allow_nan=False).encode() + b"\n"


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


__all__ = ["FOLDER", "Shards", "check_places", "write_whole"]
