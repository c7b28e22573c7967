"""Rows of results: the columns, a row a run, and rows on disk in shards that appear whole.

A shard is a file of JSON lines in ``rows/`` that is written under another name, then renamed.
Every writer puts its own small shards together into larger ones, which appear before the small
ones go: at any moment all rows are there, some of them twice; who reads takes each run once.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from physim.drafts import draft_of
from physim.errors import PhysimError

if TYPE_CHECKING:
    import pyarrow as pa

FINISHED, DURATION, ERROR, TIMEOUT, KILLED = "finished", "duration", "error", "timeout", "killed"
FAILED = (ERROR, TIMEOUT, KILLED)
"""How a run ended that says nothing about its controller's safety"""
FOLDER = "rows"
SUFFIX = ".jsonl"
TOGETHER = 64
"""Shards of one size that are put together into one of the next"""


@dataclass(frozen=True, kw_only=True, slots=True)
class Row:
    """What came of one run; the fields are the columns. None: it has no meaning for this run."""

    run: str
    """key, 20 hex digits"""
    world: str
    seed: int
    settings: str = ""
    """ "key=value; key=value" """
    controller: str = ""
    physim: str
    engine: str
    ended: str
    """finished, duration, interrupted, error, timeout, killed"""
    reason: str = ""
    """one line"""
    seconds: float | None = None
    """[s] simulated"""
    robots: int | None = None
    contacts: int | None = None
    """episodes of two robots"""
    wall_contacts: int | None = None
    grazes: int | None = None
    """contacts between two samples"""
    first_contact: float | None = None
    """[s]"""
    first_contact_pair: str = ""
    """ "r1, r2" """
    deepest: float | None = None
    """[m]"""
    shortest_distance: float | None = None
    """[m] to robots and walls; negative: depth"""
    shortest_distance_pair: str = ""
    shortest_distance_time: float | None = None
    """[s]"""
    shortest_collision_time: float | None = None
    """[s]"""
    shortest_collision_time_pair: str = ""
    shortest_collision_time_time: float | None = None
    """[s]"""
    formation_error: float | None = None
    """[m] greatest size"""
    deviation: float | None = None
    """[m] greatest size, from the path"""
    finish_time: float | None = None
    """[s]"""
    danger_share: float | None = None
    updates: int | None = None
    messages: int | None = None
    cpu_seconds: float | None = None
    """[s] of the processor"""
    wall_seconds: float | None = None
    """[s] by the clock"""
    record: str = ""
    """path of a record that was kept, within the folder"""
    world_hash: str = ""
    """of the effective world without its seed"""
    digest: str = ""
    """of a record that was kept"""

    @property
    def failed(self) -> bool:
        """Whether it ended by an error, its limit or a kill."""
        return self.ended in FAILED

    @property
    def contact_free(self) -> bool:
        """Whether it came to its end and nothing touched."""
        touches = (self.contacts, self.wall_contacts, self.grazes)
        return self.ended in (FINISHED, DURATION) and not any(touches)

    @property
    def safe(self) -> bool:
        """Whether it was contact-free and all robots arrived."""
        return self.contact_free and self.ended == FINISHED


COLUMNS = tuple(field.name for field in fields(Row))
TIMES = ("cpu_seconds", "wall_seconds")
"""Columns that are not the same every time"""


def schema() -> pa.Schema:
    """The columns, as Arrow has them."""
    import pyarrow as pa

    types = {"str": pa.string(), "int": pa.int64(), "float": pa.float64()}
    return pa.schema(
        [pa.field(one.name, types[str(one.type).partition(" ")[0]]) for one in fields(Row)]
    )


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

    def write(self, rows: Iterable[Row]) -> list[str]:
        """Put rows on disk, all or none; names of the shards that are there by that.

        Raises PhysimError where that fails.
        """
        lines = [_line(row) for row in rows]
        return self._put(0, lines) if lines else []

    def read(self, but: set[str] | None = None) -> Iterator[Row]:
        """All rows on disk, each run once: of one that was done again the row that says more.

        Shards whose names are in ``but`` are left out; those that were read are added to it.
        """
        found: dict[str, Row] = {}
        known = set() if but is None else but
        while True:
            new = [file for file in self.files() if file.name not in known]
            if not new:
                break
            for file in new:
                with suppress(FileNotFoundError):  # its rows are in a larger one by now
                    for row in _read(file):
                        found[row.run] = _better(found.get(row.run), row)
                known.add(file.name)
        yield from found.values()

    @staticmethod
    def rows_of(file: Path) -> list[Row]:
        """Rows of one shard. Raises PhysimError where it is none, FileNotFoundError."""
        return _read(file)

    def put_together(self) -> None:
        """Leave few shards, of whatever writer; others may write meanwhile."""
        small = [file for file in self.files() if _level(file) < 2]
        if len(small) > 1:
            self._merge(2, small)

    def _put(self, level: int, lines: list[str]) -> list[str]:
        self._count += 1
        path = self.folder / f"{_stamp()}-{level}-{self._writer}-{self._count:06d}{SUFFIX}"
        write_whole(path, "\n".join(lines).encode() + b"\n")
        mine = self._mine.setdefault(level, [])
        mine.append(path)
        if len(mine) < TOGETHER or level == 2:
            return [path.name]
        self._mine[level] = []
        return [path.name, *self._merge(level + 1, mine)]

    def _merge(self, level: int, files: list[Path]) -> list[str]:
        rows: dict[str, Row] = {}
        read = []
        for file in files:
            with suppress(FileNotFoundError):
                for row in _read(file):
                    rows[row.run] = _better(rows.get(row.run), row)
                read.append(file)
        names = self._put(level, [_line(row) for row in rows.values()]) if rows else []
        for file in read:
            with suppress(OSError):
                file.unlink()
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


def _line(row: Row) -> str:
    return json.dumps(asdict(row), allow_nan=False)


def _read(file: Path) -> list[Row]:
    try:
        lines = file.read_bytes().splitlines()
        return [Row(**_known(json.loads(line))) for line in lines]
    except FileNotFoundError:
        raise
    except (OSError, ValueError, TypeError, RecursionError) as error:
        raise PhysimError(f"{file}: is no shard of rows ({error})") from None


def _known(values: Any) -> Any:
    """Values of the columns that there are: a later version may have more."""
    if not isinstance(values, dict):
        raise ValueError("a line is no row")
    return {key: value for key, value in values.items() if key in COLUMNS}


def _level(file: Path) -> int:
    part = file.name.split("-")[1:2]
    return int(part[0]) if part and part[0].isdigit() else 2


def _stamp() -> str:
    """Time by which shards of several writers are in order."""
    import time

    return f"{time.time_ns():020d}"


__all__ = [
    "COLUMNS",
    "FAILED",
    "TIMES",
    "Row",
    "Shards",
    "in_order",
    "read",
    "schema",
    "write_whole",
]
