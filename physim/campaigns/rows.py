"""Rows, one a run: what may stand in them, the files that they are appended to, tables of them.

Each sweep appends lines of JSON to a file of its own in ``rows/``. A line is a row once it is
ended; one that was cut off by a kill or a full disk is none, and its run is done again.
"""

from __future__ import annotations

import errno
import functools
import json
import os
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import fields
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple
from uuid import uuid4

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from physim.errors import PhysimError

if TYPE_CHECKING:
    import pyarrow as pa

    from physim.analysis.metrics.registered import Registered

FOLDER = "rows"
FINISHED, DURATION, ERROR, TIMEOUT, KILLED = "finished", "duration", "error", "timeout", "killed"
DONE = (FINISHED, DURATION)
"""Ends of runs that ran as long as they were to"""
FAILED = (ERROR, TIMEOUT, KILLED)
"""How a run ended that says nothing about its controller's safety"""
PREFIX = "metric_"
"""Of columns of metrics of one's own, so that no metric's name is that of another column"""
LONGEST_ROW = 1_000_000
"""[bytes] of a line; a row has a thousandth of them"""
TOGETHER = 20_000
"""Rows that are made a table at a time: memory does not grow with files"""

Ended = Literal["finished", "duration", "interrupted", "error", "timeout", "killed"]
Count = Annotated[int, Field(ge=0, lt=2**63)]
Size = Annotated[float, Field(ge=0.0, le=1e12)]
Signed = Annotated[float, Field(ge=-1e12, le=1e12)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Key = Annotated[str, Field(pattern="^[0-9a-f]{20}$")]
Kept = Annotated[str, Field(pattern=r"^(records/[0-9a-f]{20}\.h5)?$")]
Hash = Annotated[str, Field(pattern="^[0-9a-f]{0,128}$")]
Name = Annotated[str, Field(pattern="^[a-z][a-z0-9_]*$")]
Metrics = dict[Name, float]


class Came(NamedTuple):
    """What came of a run, as far as a sweep needs to know."""

    failed: bool
    """by an error, its limit or a kill"""
    contact_free: bool
    """it came to its end and nothing touched"""
    finished: bool
    """all robots arrived"""

    @property
    def rate(self) -> bool:
        """Whether it was contact-free and finished."""
        return self.contact_free and self.finished


@dataclass(
    frozen=True, kw_only=True, slots=True,
    config=ConfigDict(strict=True, extra="ignore", allow_inf_nan=False),
)  # fmt: skip
class Row:
    """What came of one run; the fields are the columns. None: it has no meaning for this run."""

    run: Key
    """key, 20 hex digits"""
    world: str
    seed: Count
    settings: str = ""
    """ "key=value; key=value" """
    controller: str = ""
    physim: str
    engine: str
    ended: Ended
    reason: str = ""
    """one line"""
    seconds: Size | None = None
    """[s] simulated"""
    robots: Count | None = None
    contacts: Count | None = None
    """episodes, with robots and with walls"""
    contacts_between_robots: Count | None = None
    contacts_with_boundaries: Count | None = None
    grazes: Count | None = None
    """contacts between two samples"""
    first_contact: Size | None = None
    """[s]"""
    first_contact_pair: str = ""
    """ "r1, r2" """
    deepest_contact: Size | None = None
    """[m]"""
    closing_speed: Size | None = None
    """[m/s] of the severest contact, as the next four"""
    energy_lost: Size | None = None
    """[J]"""
    impulse: Size | None = None
    """[N s]"""
    severest_contact_pair: str = ""
    severest_contact_time: Size | None = None
    """[s]"""
    shortest_distance: Signed | None = None
    """[m] of two robots; negative: depth"""
    shortest_boundary_distance: Signed | None = None
    """[m] of a robot and a wall; negative: depth"""
    least_distance: Signed | None = None
    """[m] the less of the two"""
    least_distance_pair: str = ""
    least_distance_time: Size | None = None
    """[s]"""
    shortest_collision_time: Annotated[float, Field(ge=0.0)] | None = None
    """[s]"""
    shortest_collision_time_pair: str = ""
    shortest_collision_time_time: Size | None = None
    """[s]"""
    shortest_pair_collision_time: Annotated[float, Field(ge=0.0)] | None = None
    """[s] of any two robots under the commands applied at decisions; 10 where none is shorter"""
    formation_error_peak: Size | None = None
    """[m] greatest size"""
    deviation_peak: Size | None = None
    """[m] greatest size, from the path"""
    time_to_finish: Size | None = None
    """[s]"""
    not_arrived: str = ""
    """ "r1, r3": robots that had not arrived at the end"""
    stood: str = ""
    """those of them that stood"""
    danger_share: Share | None = None
    decisions: Count | None = None
    messages: Count | None = None
    cpu_seconds: Size | None = None
    """[s] of the processor"""
    wall_seconds: Size | None = None
    """[s] by the clock"""
    verdict: str = ""
    """of the validation, where the run was validated"""
    unexplained: Count | None = None
    """disagreements of its checks without a cause"""
    record: Kept = ""
    """path of a record that was kept, within the folder"""
    world_hash: Hash = ""
    """of the effective world without its seed"""
    digest: Hash = ""
    """of a record that was kept"""
    metrics: Annotated[Metrics, Field(default_factory=dict)]
    """of the metrics that packages registered; in tables each is a column, ``metric_NAME``"""

    @property
    def failed(self) -> bool:
        """Whether it ended by an error, its limit or a kill."""
        return self.ended in FAILED

    @property
    def contact_free(self) -> bool:
        """Whether it came to its end and nothing touched."""
        return self.ended in DONE and self.contacts == self.grazes == 0

    @property
    def came(self) -> Came:
        """What came of it."""
        return Came(self.failed, self.contact_free, self.ended == FINISHED)


ROW = TypeAdapter(Row)
COLUMNS = tuple(one.name for one in fields(Row) if one.name != "metrics")
"""The columns that all tables of rows have"""


def schema() -> pa.Schema:
    """The columns, as Arrow has them."""
    import pyarrow as pa

    whole = ("Count", "int")
    texts = ("str", "Key", "Kept", "Hash", "Ended")

    def kind(name: str) -> pa.DataType:
        return pa.string() if name in texts else pa.int64() if name in whole else pa.float64()

    return pa.schema(
        [pa.field(one.name, kind(str(one.type).partition(" ")[0])) for one in fields(Row)][:-1]
    )


def table_of(rows: Sequence[Row]) -> pa.Table:
    """Rows as a table; metrics of one's own have a column each, null where a row has none."""
    import pyarrow as pa

    columns = zip(*map(attrgetter(*COLUMNS), rows), strict=True) if rows else ((),) * len(COLUMNS)
    arrays = [pa.array(column, one.type) for column, one in zip(columns, schema(), strict=True)]
    found = pa.Table.from_arrays(arrays, schema=schema())
    for name in sorted({name for row in rows for name in row.metrics}):
        values = pa.array([row.metrics.get(name) for row in rows], pa.float64())
        found = found.append_column(PREFIX + name, values)
    return found


def rows_of(table: pa.Table) -> list[Row]:
    """The rows of a table, without metrics of one's own."""
    return [Row(**one) for one in table.select(list(COLUMNS)).to_pylist()]


RENAMED = {
    "deepest": "deepest_contact",
    "formation_error": "formation_error_peak",
    "deviation": "deviation_peak",
    "finish_time": "time_to_finish",
    "updates": "decisions",
}
"""Columns of earlier rows that have the names of their metrics now"""
OF_WALLS = {
    "contacts": "contacts_between_robots",
    "wall_contacts": "contacts_with_boundaries",
    "shortest_distance": "least_distance",
    "shortest_distance_pair": "least_distance_pair",
    "shortest_distance_time": "least_distance_time",
}
"""Columns of rows with ``wall_contacts``, whose ``contacts`` are of robots alone and whose
``shortest_distance`` is of robots and walls, by what they mean"""
EARLIER = tuple(f'"{name}":'.encode() for name in ("wall_contacts", *RENAMED))
"""By which a line of an earlier version is known"""


def _earlier(line: bytes) -> Row:
    """Row of a line of an earlier version, its columns named by what they mean now."""
    tree = json.loads(line)
    if "wall_contacts" in tree:
        both = tree.get("contacts"), tree["wall_contacts"]
        tree = {OF_WALLS.get(name, name): value for name, value in tree.items()}
        tree["contacts"] = None if None in both else sum(both)
    tree = {RENAMED.get(name, name): value for name, value in tree.items()}
    pairs = (one.partition("=") for one in tree.get("metrics", "").split("; ") if one)
    tree["metrics"] = {name: float(value) for name, _, value in pairs}
    return ROW.validate_json(json.dumps(tree))


def read_rows(file: Path) -> Iterator[list[Row]]:
    """Rows of a file, some at a time. A last line that is not ended is none.

    Raises PhysimError with file, line and column for what is no row.
    """
    found: list[Row] = []
    number = 0
    try:
        with open(file, "rb") as stream:
            while (line := stream.readline(LONGEST_ROW)).endswith(b"\n"):
                number += 1
                old = any(one in line for one in EARLIER)
                found.append(_earlier(line) if old else ROW.validate_json(line))
                if len(found) == TOGETHER:
                    yield found
                    found = []
        if len(line) == LONGEST_ROW:
            number += 1
            raise ValueError(f"is no row: has {LONGEST_ROW} bytes or more")
    except ValidationError as error:
        raise PhysimError(f"{file}:{number}: {told(error)}") from None
    except (ValueError, TypeError, AttributeError, RecursionError) as error:
        raise PhysimError(f"{file}:{number}: is no row: {str(error)[:200]}") from None
    except OSError as error:
        raise PhysimError(f"{file}: cannot be read: {error.strerror}") from None
    if found:
        yield found


def told(error: ValidationError) -> str:
    """The first fault that pydantic found, on one line."""
    first = error.errors(include_url=False)[0]
    if first["type"] == "json_invalid":
        return "is no JSON"
    where = "".join(f"{one}: " for one in first["loc"])
    return f"{where}{first['msg']}; given: {repr(first['input'])[:40]}"


class Rows:
    """The rows of a folder, and one writer of them. PhysimError for one with links or pipes."""

    def __init__(self, folder: Path) -> None:
        check_places(folder)
        self.folder = folder / FOLDER
        self.file = self.folder / f"{time.time_ns():020d}-{uuid4().hex[:12]}.jsonl"

    def write(self, rows: Iterable[Row]) -> None:
        """Put rows on disk, all or none. Raises PhysimError where that fails."""
        data = b"".join(ROW.dump_json(row) + b"\n" for row in rows)
        try:
            with open(self.file, "ab", buffering=0) as stream:
                before = stream.tell()
                try:
                    if stream.write(data) < len(data):
                        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
                    os.fsync(stream.fileno())
                except OSError:
                    stream.truncate(before)
                    raise
        except OSError as error:
            text = error.strerror or error
            raise PhysimError(f"{self.file}: cannot be written: {text}") from None

    def files(self) -> list[Path]:
        """Files of all writers, in the order in which they were begun."""
        try:
            names = sorted(one.name for one in os.scandir(self.folder))
        except (FileNotFoundError, NotADirectoryError):  # whoever needs one says so
            return []
        return [self.folder / name for name in names if name.endswith(".jsonl") and name[0] != "."]


def check_places(folder: Path) -> None:
    """Raise PhysimError where a campaign's folder holds links, pipes or devices.

    It may come from a stranger: reading or writing through a link would leave the folder, reading a
    pipe would never end. Its own folders, one deep, hold regular files.
    """
    with suppress(FileNotFoundError, NotADirectoryError):  # whoever needs it says so
        inside = [one.path for one in os.scandir(folder) if one.is_dir(follow_symlinks=False)]
        for entry in (one for place in (str(folder), *inside) for one in os.scandir(place)):
            if not entry.is_file(follow_symlinks=False) and not entry.is_dir(follow_symlinks=False):
                what = "a link" if entry.is_symlink() else "a pipe or a device"
                raise PhysimError(
                    f"{entry.path}: is {what}; the folder of a campaign holds files and folders of "
                    "its own"
                )


@functools.cache
def installed() -> Registered:
    """The metrics that packages registered, looked for once in a process."""
    from physim.analysis.metrics import DEFINITIONS, own_metrics  # readers of rows need none

    return own_metrics(DEFINITIONS)


def columns_of(table: pa.Table) -> list[str]:
    """Names of the columns of one's own metrics."""
    return [name for name in table.column_names if name.startswith(PREFIX)]


def title_of(column: str) -> tuple[str, str]:
    """Name of the metric of a column, and its unit where it is installed here."""
    name = column.removeprefix(PREFIX)
    known = installed().definitions.get(name)
    unit = "" if known is None or known.unit == "-" else known.unit
    return name, unit
