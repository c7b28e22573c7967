"""Rows, one a run: what may stand in them, and the files that they are appended to.

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
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, get_type_hints
from uuid import uuid4

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from physim.errors import PhysimError

if TYPE_CHECKING:
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


class Column(NamedTuple):
    """What a column of the results means."""

    meaning: str
    """one line"""
    unit: str = ""
    """empty for texts, "-" for numbers without one"""


@dataclass(
    frozen=True, kw_only=True, slots=True,
    config=ConfigDict(strict=True, extra="ignore", allow_inf_nan=False),
)  # fmt: skip
class Row:
    """What came of one run; the fields are the columns. None: it has no meaning for this run.

    A field without a `Column` is the metric of its name: `columns` tells what all of them mean.
    """

    run: Annotated[Key, Column("key of the run, 20 hex digits")]
    world: Annotated[str, Column("name of the world")]
    seed: Annotated[Count, Column("seed of the run", "-")]
    settings: Annotated[str, Column('values set by the sweep, as "key=value; key=value"')] = ""
    controller: Annotated[str, Column("registered name, or module:Class")] = ""
    physim: Annotated[str, Column("version of physim")]
    engine: Annotated[str, Column("physics engine and its version")]
    ended: Annotated[Ended, Column("finished, duration, error, timeout or killed")]
    reason: Annotated[str, Column("why the run failed, on one line")] = ""
    seconds: Annotated[Size | None, Column("simulated time", "s")] = None
    robots: Annotated[Count | None, Column("number of robots", "-")] = None
    contacts: Count | None = None
    contacts_between_robots: Count | None = None
    contacts_with_movers: Count | None = None
    contacts_with_boundaries: Count | None = None
    grazes: Count | None = None
    first_contact: Size | None = None
    first_contact_pair: Annotated[
        str, Column('names of the two bodies in the first contact, as "r1, r2"')
    ] = ""
    deepest_contact: Size | None = None
    closing_speed: Size | None = None
    energy_lost: Size | None = None
    impulse: Size | None = None
    severest_contact_pair: Annotated[
        str, Column("names of the two bodies in the severest contact")
    ] = ""
    severest_contact_time: Annotated[
        Size | None, Column("when the severest contact began", "s")
    ] = None
    shortest_distance: Signed | None = None
    shortest_boundary_distance: Signed | None = None
    least_distance: Annotated[
        Signed | None,
        Column("shortest distance of a robot to a robot or wall; negative = depth", "m"),
    ] = None
    least_distance_pair: Annotated[str, Column("names of the two bodies at least_distance")] = ""
    least_distance_time: Annotated[Size | None, Column("time of least_distance", "s")] = None
    shortest_collision_time: Annotated[float, Field(ge=0.0)] | None = None
    shortest_collision_time_pair: Annotated[
        str, Column("name of the robot that made that decision")
    ] = ""
    shortest_collision_time_time: Annotated[Size | None, Column("time of that decision", "s")] = (
        None
    )
    shortest_pair_collision_time: Annotated[
        Annotated[float, Field(ge=0.0)] | None,
        Column(
            "shortest collision time of any two robots under the commands applied at decisions, "
            "whatever the controller; 10 where none is shorter", "s",
        ),
    ] = None  # fmt: skip
    formation_error_peak: Size | None = None
    formation_error_rms: Size | None = None
    deviation_peak: Size | None = None
    deviation_rms: Size | None = None
    time_to_finish: Size | None = None
    standstill: Size | None = None
    speed_changes: Size | None = None
    rotation_changes: Size | None = None
    not_arrived: Annotated[str, Column("names of robots that had not arrived at the end")] = ""
    stood: Annotated[str, Column("names of robots that stood short of their stops")] = ""
    danger_share: Share | None = None
    decisions: Count | None = None
    messages: Count | None = None
    decision_median: Annotated[
        Size | None,
        Column("median of the processor time that a decision of one robot took", "s"),
    ] = None
    decision_99: Annotated[
        Size | None, Column("processor time within which 99 % of decisions were made", "s")
    ] = None
    cpu_seconds: Annotated[Size | None, Column("processor time that the run took", "s")] = None
    wall_seconds: Annotated[Size | None, Column("wall-clock time that the run took", "s")] = None
    verdict: Annotated[str, Column("verdict of the validation (sweep --validate)")] = ""
    unexplained: Annotated[
        Count | None, Column("number of unexplained disagreements of the validation", "-")
    ] = None
    record: Annotated[Kept, Column("path in the folder of a record that was kept")] = ""
    world_hash: Annotated[Hash, Column("hash of the effective world without its seed")] = ""
    digest: Annotated[Hash, Column("digest of a record that was kept")] = ""
    metrics: Annotated[Metrics, Field(default_factory=dict)]
    """of the metrics that packages registered; in tables each is a column, ``metric_NAME``"""

    @property
    def failed(self) -> bool:
        """Whether it did not come to an end of its own: an error, its limit, a kill."""
        return self.ended not in DONE

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


def columns() -> list[tuple[str, str, str]]:
    """Name, unit and meaning of each column, in the order of the results.

    The unit is empty for texts, "-" for numbers without one. Columns of metrics that packages
    registered, ``metric_NAME``, stand behind them.
    """
    from physim.analysis.metrics import DEFINITIONS  # readers of rows need none

    found, hints = [], get_type_hints(Row, include_extras=True)
    for name in COLUMNS:
        notes = getattr(hints[name], "__metadata__", ())
        told = [(name, one.unit, one.meaning) for one in notes if isinstance(one, Column)]
        found += told or [(name, DEFINITIONS[name].unit, DEFINITIONS[name].meaning)]
    return found


def own_columns(rows: Iterable[Row]) -> list[str]:
    """Names of the columns of metrics that packages registered: of those that any row has."""
    return sorted({PREFIX + name for row in rows for name in row.metrics})


def as_table(rows: Sequence[Row]) -> Iterator[list[Any]]:
    """The names of all columns, then the values of each row; None where there is none."""
    own, values = own_columns(rows), attrgetter(*COLUMNS)
    yield [*COLUMNS, *own]
    for row in rows:
        yield [*values(row), *(row.metrics.get(name.removeprefix(PREFIX)) for name in own)]


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


def read_rows(file: Path) -> Iterator[Row]:
    """Rows of a file, one a line. A last line that is not ended is none.

    Raises PhysimError with file, line and column for what is no row.
    """
    number = 0
    try:
        with open(file, "rb") as stream:
            while (line := stream.readline(LONGEST_ROW)).endswith(b"\n"):
                number += 1
                old = any(one in line for one in EARLIER)
                yield _earlier(line) if old else ROW.validate_json(line)
        if len(line) == LONGEST_ROW:
            number += 1
            raise ValueError(f"is no row: has {LONGEST_ROW} bytes or more")
    except ValidationError as error:
        raise PhysimError(f"{file}:{number}: {told(error)}") from None
    except (ValueError, TypeError, AttributeError, RecursionError) as error:
        raise PhysimError(f"{file}:{number}: is no row: {str(error)[:200]}") from None
    except OSError as error:
        raise PhysimError(f"{file}: cannot be read: {error.strerror}") from None


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


def title_of(column: str) -> tuple[str, str]:
    """Name of the metric of a column, and its unit where it is installed here."""
    name = column.removeprefix(PREFIX)
    known = installed().definitions.get(name)
    unit = "" if known is None or known.unit == "-" else known.unit
    return name, unit
