"""What a record file holds: names, row types, version; and the digest over all of it.

The file is plain HDF5 that any version of the library reads. All lengths are metres, angles
radians, times seconds, in the world frame; steps count from 0, the start.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW

if TYPE_CHECKING:
    from physim.record.reader import Record


Row = tuple[tuple[int, ...], Any]
"""Shape and type of one row of a dataset."""

FORMAT = "physim-record"
MAJOR, MINOR = 4, 0
"""The major number is raised with every change that an older reader would misread, the minor one
where something is added that it may pass over. 4: footprints and considered robots packed, a few
datasets for all robots and all decisions."""
VERSION = f"{MAJOR}.{MINOR}"

UNITS = "m, rad, s, N s; world frame; headings counter-clockwise from the x axis, unwrapped"

ENDED = ("running", "finished", "duration", "interrupted", "error")
"""How a run ended; a file whose run was killed still says "running"."""

ENDED_BYTES = 16
"""Length of the attribute ``ended``: fixed, so that it changes in place (see `crash_safe`)."""

_DECISION = [
    ("step", "<i8"),
    ("robot", "<i4"),
    ("mode", "i1"),
    ("rule", "i1"),
    ("nominal_v", "<f8"),
    ("nominal_omega", "<f8"),
    ("applied_v", "<f8"),
    ("applied_omega", "<f8"),
    ("station", "<f8"),
    ("reference_station", "<f8"),
    ("formation_error", "<f8"),
    ("deviation", "<f8"),
    ("considered", "<i4"),
    ("next_step", "<i8"),
]


def update_type(columns: Sequence[str]) -> np.dtype[np.void]:
    """Row of the update table: one decision, with the columns that its controller declares.

    Step, robot, numbers of mode and rule (-1 where none was given), nominal and applied command
    [m/s, rad/s], stations [m] along the own and the reference path, formation error [m], deviation
    [m] from the own path (left positive), how many robots were considered, step of the next
    decision; then the declared columns, NaN where the decision left one out.
    """
    return np.dtype([*_DECISION, *((name, "<f8") for name in columns)])


DECISION = tuple(name for name, _ in _DECISION)
"""Columns of the update table that every record has."""

COMMAND_STAGES = ("nominal", "filtered", "applied")
"""Of a command: as it was decided, after the filters, after the disturbances."""
COMMAND = np.dtype(
    [("step", "<i8"), ("robot", "<i4")]
    + [(f"{stage}_{part}", "<f8") for stage in COMMAND_STAGES for part in ("v", "omega")]
)
"""Command of one robot over the step that begins at a sample, at all its stages [m/s, rad/s]: a row
at every step at which they differ, or at which the nominal one is not that of the robot's last
decision. Where there is no row, all three are the nominal command of the last decision, and 0
before the first."""

CONSIDERING = np.dtype([("step", "<i8"), ("robot", "<i4"), ("count", "<i4")])
"""How many robots were considered in a decision; `OTHERS` has them, decision after decision."""

CONSIDERED = np.dtype([("step", "<i8"), ("robot", "<i4"), ("other", "<i4")])
"""A robot that was considered in the decision of another, as `Record.considered` gives it."""

EXTREME = np.dtype(
    [
        ("clearance", "<f8"),
        ("clearance_step", "<i8"),
        ("clearance_other", "<i4"),
        ("boundary_clearance", "<f8"),
        ("boundary_step", "<i8"),
        ("boundary_other", "<i4"),
    ]
)
"""Shortest distances of one robot over all physics steps [m], when, and to which body id; inf, -1
and -1 where there is nothing to be near to."""

FARTHEST = np.dtype([("farthest", "<f8"), ("step", "<i8"), ("a", "<i4"), ("b", "<i4")])
"""Largest distance between two robots over all physics steps [m], when, who; -inf and -1 for one
robot."""

NO_EXTREME = np.array((np.inf, -1, -1, np.inf, -1, -1), dtype=EXTREME)
NO_FARTHEST = np.array((-np.inf, -1, -1, -1), dtype=FARTHEST)

TABLES = ("/updates", "/commands", "/considered", "/contacts", "/false_contacts")
"""Growing tables of rows."""

OTHERS = "/considered_others"
"""Growing dataset of the robots that were considered, packed, see `CONSIDERING`."""

OPTIONAL = ("updates", "considered", "contacts", "false_contacts")
"""Tables that a run may leave out; the commands and the samples are always there."""

STEPS = ("/steps/step", "/steps/pose", "/steps/clearance", "/steps/boundary_clearance")
"""Growing datasets with one row a recorded sample; they come last in the file, see `crash_safe`."""

TEXT = "text"
"""Stands for the type of a text of any length."""

_NUMBER: Row = ((), "<f8")
_WHOLE: Row = ((), "<i8")
_WORDS: Row = ((), TEXT)
_POINT: Row = ((2,), "<f8")

FIXED: dict[str, Row] = {
    "/bodies/id": ((), "<i4"),
    "/bodies/kind": _WORDS,
    "/bodies/name": _WORDS,
    "/robots/stop_station": _NUMBER,
    "/robots/lead": _NUMBER,
    "/modes/name": _WORDS,
    "/modes/words": _WORDS,
    "/modes/colour": _WORDS,
    "/modes/danger": ((), "i1"),
    "/rules/name": _WORDS,
    "/rules/words": _WORDS,
    "/columns/name": _WORDS,
    "/columns/unit": _WORDS,
    "/columns/words": _WORDS,
    "/footprints/vertices": _POINT,
    "/footprints/part_start": _WHOLE,
    "/footprints/body_start": _WHOLE,
    "/walls/vertices": _POINT,
    "/walls/part_start": _WHOLE,
    "/walls/body_start": _WHOLE,
    "/paths/points": _POINT,
    "/paths/start": _WHOLE,
    "/reference/points": _POINT,
    "/reference/start": _WHOLE,
    "/areas/accessible/points": _POINT,
    "/areas/accessible/start": _WHOLE,
    "/areas/safe/points": _POINT,
    "/areas/safe/start": _WHOLE,
}
"""Datasets written once, at the start, and their rows."""

EXTREMES = "/extremes"
EXTREMES_FARTHEST = "/extremes_farthest"

ARRIVED = "/robots/arrived"
"""(N,) step from which on each robot has arrived, to the end of the run; -1 where it has not."""

DATASETS = (*FIXED, EXTREMES, EXTREMES_FARTHEST, ARRIVED, *TABLES, OTHERS, *STEPS)
"""Every dataset that a record must have."""

ATTRIBUTES = (
    "format",
    "version",
    "units",
    "name",
    "world",
    "seed",
    "dt",
    "steps_planned",
    "record_every",
    "tables",
    "given",
    "safe_distance",
    "ended",
    "steps_run",
    "rejected_contacts",
)
"""Root attributes, all inside the digest. Outside, and not needed: ``versions`` of
physim and its libraries, and ``given_settings``.
``tables`` are the optional ones that the run recorded, ``given`` the parts [kind, name] that came
from Python in place of or beside those that the world names, both JSON lists. ``given_settings``
is one, too: for each of ``given`` its ``settings`` that differ from their defaults, and the names
of those that are ``not_known``."""

TEXTS = ("format", "version", "units", "name", "world", "tables", "given")
"""Attributes that are texts."""

WALL_CLOCK = "/wall_clock"
"""Group whose attributes are figures of the wall clock: outside the digest."""


def steps_rows(robots: int) -> dict[str, Row]:
    """Shape and type of one row of each dataset in ``STEPS``."""
    shapes: dict[str, Row] = {
        "/steps/step": ((), "<i8"),
        "/steps/pose": ((robots, 3), "<f8"),
        "/steps/clearance": ((robots,), "<f8"),
        "/steps/boundary_clearance": ((robots,), "<f8"),
    }
    return shapes


def other_type(robots: int) -> str:
    """Type of the numbers in `OTHERS`: as small as N robots allow."""
    return "<u2" if robots <= 1 << 16 else "<i4"


def table_types(columns: Sequence[str]) -> dict[str, np.dtype[np.void]]:
    """Row type of each of `TABLES`."""
    types = (update_type(columns), COMMAND, CONSIDERING, CONTACT_ROW, FALSE_CONTACT_ROW)
    return dict(zip(TABLES, types, strict=True))


BLOCK_BYTES = 1 << 22


def digest(record: Record, file: h5py.File) -> str:
    """SHA-256 (hexadecimal) over all datasets and the root attributes in `layout.ATTRIBUTES`.

    Each part goes in with its name, type and shape, so nothing can move from one to another. Left
    out: ``/wall_clock``, the attributes ``versions`` and ``given_settings``; chunks and places in
    the file do not matter. Two runs of the same world, seed and version on one machine have equal
    digests; so have a record in memory and its copy on disk.
    """
    total = hashlib.sha256()
    for name in ATTRIBUTES:
        total.update(f"{name}={file.attrs[name]!r}\n".encode())
    for path in DATASETS:
        _add(total, record, file[path], path)
    return total.hexdigest()


def _add(total: hashlib._Hash, record: Record, dataset: h5py.Dataset, path: str) -> None:
    """Add one dataset, block by block, so that memory stays flat."""
    shape = dataset.shape
    if path in STEPS:
        shape = (record.samples, *shape[1:])
    elif path in TABLES or path == OTHERS:
        shape = (len(record.read(path, check=False)),)
    total.update(f"{path} {dataset.dtype.descr} {shape}\n".encode())
    if not shape:
        total.update(record.read(path, check=False).tobytes())
        return
    row_bytes = dataset.dtype.itemsize * int(np.prod(shape[1:], dtype=int))
    block = max(1, BLOCK_BYTES // row_bytes)
    for first in range(0, shape[0], block):
        rows = record.read(path, first, min(first + block, shape[0]), check=False)
        if dataset.dtype.kind == "O":
            total.update(b"".join(len(text).to_bytes(8, "little") + text for text in rows))
        else:
            total.update(np.ascontiguousarray(rows).tobytes())
