"""Open a record file, or say in one line why it cannot be read.

A limit: the HDF5 library itself may crash on a file whose index was changed byte by byte. What is
caught here are files that break off, that are something else, or that lack or twist a part.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from physim.errors import RecordError
from physim.record import layout

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def open_record(path: Path) -> h5py.File:
    """Open a record for reading. Raises RecordError that names the file and the fault."""
    if not path.exists():
        raise RecordError(f"{path}: no such file; give the record.h5 of a run")
    if path.is_dir():
        inside = path / "record.h5"
        hint = f"; did you mean {inside}?" if inside.is_file() else ""
        raise RecordError(f"{path}: is a folder; give the record.h5 of a run{hint}")
    try:
        if not path.is_file():
            raise RecordError(f"{path}: is not a regular file; give the record.h5 of a run")
        with path.open("rb") as stream:
            signature = stream.read(len(_HDF5_SIGNATURE))
    except OSError as error:
        raise RecordError(f"{path}: cannot be read: {error.strerror}") from error
    if signature != _HDF5_SIGNATURE:
        raise RecordError(f"{path}: not an HDF5 file; give the record.h5 of a run")
    try:
        return h5py.File(path, "r")
    except OSError as error:
        fault = "truncated" if "truncated" in str(error) else "damaged"
        raise RecordError(f"{path}: {fault} HDF5 file; make the record again") from error


def check_layout(file: h5py.File, where: str) -> None:
    """Check that an open file is a record of this version, with all its parts.

    Raises RecordError that names the first part that is missing or not as it should be.
    """
    try:
        _check_attributes(file, where)
        _check_datasets(file, where)
    except RecordError:
        raise
    except Exception as error:  # the library raises many kinds for damaged files
        raise RecordError(f"{where}: damaged record: {_one_line(error)}") from error


def damaged(where: str, part: str, error: Exception) -> RecordError:
    """Error for a part of a record that cannot be read."""
    return RecordError(f"{where}: {part} cannot be read, the file is damaged: {_one_line(error)}")


def _check_attributes(file: h5py.File, where: str) -> None:
    found = file.attrs.get("format")
    if not isinstance(found, str) or found != layout.FORMAT:
        raise RecordError(
            f"{where}: not a record of physim (no attribute format = {layout.FORMAT})"
        )
    _check_version(file.attrs.get("version"), where)
    for name in layout.ATTRIBUTES:
        if name not in file.attrs:
            raise RecordError(f"{where}: attribute {name} is missing")
        _check_attribute(name, file.attrs[name], where)

    _check_versions(file.attrs.get("versions", "{}"), where)


def _check_version(version: Any, where: str) -> None:
    """An unknown minor version adds only what may be passed over; a major one is refused."""
    major, _, minor = version.partition(".") if isinstance(version, str) else ("", "", "")
    if major == str(layout.MAJOR) and minor.isdecimal() and len(minor) < 6:
        return
    told = version if isinstance(version, int | np.integer) else repr(str(version)[:20])
    raise RecordError(
        f"{where}: record version {told}; this physim reads version {layout.MAJOR}; make the "
        "record again"
    )


def _check_versions(text: Any, where: str) -> None:
    try:
        versions = json.loads(text)
    except (TypeError, ValueError):
        versions = None
    if not isinstance(versions, dict):
        raise RecordError(f"{where}: attribute versions is {text!r}; it must be a JSON object")


def _check_attribute(name: str, value: Any, where: str) -> None:
    if name == "ended" and isinstance(value, str):
        raise RecordError(
            f"{where}: attribute ended is a text of variable length; it must be of fixed length, "
            f"S{layout.ENDED_BYTES}"
        )
    if name == "units" and value != layout.UNITS:
        raise RecordError(f"{where}: attribute units is {value!r}; it must be {layout.UNITS!r}")
    if name in ("tables", "given"):
        _check_list(name, value, where)
        return
    if name in layout.TEXTS:
        good = isinstance(value, str)
    elif name == "ended":
        good = isinstance(value, bytes) and value.decode() in layout.ENDED
    else:
        good = np.ndim(value) == 0 and np.issubdtype(np.asarray(value).dtype, np.number)
    if name == "dt":
        good = good and value > 0
    if not good:
        raise RecordError(f"{where}: attribute {name} is {value!r}, which no record has")


def _check_list(name: str, text: Any, where: str) -> None:
    """``tables`` is a JSON list of table names, ``given`` one of [kind, name]."""
    try:
        found = json.loads(text)
        good = isinstance(found, list)
    except (TypeError, ValueError):
        good = False
    if good and name == "tables":
        good = all(table in layout.OPTIONAL for table in found)
    elif good:
        good = all(
            isinstance(one, list) and len(one) == 2 and all(isinstance(t, str) for t in one)
            for one in found
        )
    if not good:
        raise RecordError(f"{where}: attribute {name} is {text!r}, which no record has")


def _check_datasets(file: h5py.File, where: str) -> None:
    for path in layout.DATASETS:
        if not isinstance(file.get(path), h5py.Dataset):
            raise RecordError(f"{where}: dataset {path} is missing")
    robots = file["/robots/stop_station"].size
    bodies = file["/bodies/id"].size
    for path in ("/bodies/kind", "/bodies/name"):
        if file[path].size != bodies or bodies < robots:
            raise RecordError(
                f"{where}: dataset {path} has {file[path].size} rows, /bodies/id {bodies}, for "
                f"{robots} robots"
            )
    wanted: dict[str, tuple[tuple[int, ...], Any]] = {
        **{path: ((), row) for path, row in _table_types(file).items()},
        **layout.steps_rows(robots),
    }
    for path, (shape, row) in wanted.items():
        found = file[path]
        if found.shape[1:] != shape or found.ndim != 1 + len(shape) or found.dtype != row:
            raise RecordError(
                f"{where}: dataset {path} has rows {found.shape[1:]} of {found.dtype}"
            )
    for path, row in (
        (layout.EXTREMES, layout.EXTREME),
        (layout.EXTREMES_FARTHEST, layout.FARTHEST),
    ):
        if file[path].dtype != row:
            raise RecordError(f"{where}: dataset {path} has rows of {file[path].dtype}")
    for path in ("/robots/lead", layout.ARRIVED):
        if file[path].shape != (robots,):
            raise RecordError(f"{where}: dataset {path} has rows {file[path].shape}")
    for i in range(robots):
        if not len(file.get(layout.FOOTPRINTS.format(i), ())):
            raise RecordError(f"{where}: group {layout.FOOTPRINTS.format(i)} is missing")


def _table_types(file: h5py.File) -> dict[str, Any]:
    names = [name.decode() for name in file["/columns/name"][:]]
    return dict(layout.table_types(names))


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
