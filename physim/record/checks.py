"""Open a record file, or say in one line why it cannot be read.

A limit: the HDF5 library itself may crash on a file whose index was changed byte by byte. What is
caught here are files that break off, that are something else, or that lack or twist a part.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import chain
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
        fault = next(chain(_attribute_faults(file.attrs), _dataset_faults(file)), None)
    except Exception as error:  # the library raises many kinds for damaged files
        raise RecordError(f"{where}: damaged record: {_one_line(error)}") from error
    if fault is not None:
        raise RecordError(f"{where}: {fault}")


def damaged(where: str, part: str, error: Exception) -> RecordError:
    """Error for a part of a record that cannot be read."""
    return RecordError(f"{where}: {part} cannot be read, the file is damaged: {_one_line(error)}")


def _attribute_faults(attributes: h5py.AttributeManager) -> Iterator[str]:
    """What is wrong with the root attributes; each is looked at only where those before are right.

    An unknown minor version adds only what may be passed over; a major one is refused.
    """
    found = attributes.get("format")
    if not isinstance(found, str) or found != layout.FORMAT:
        yield f"not a record of physim (no attribute format = {layout.FORMAT})"
    version = attributes.get("version")
    major, _, minor = version.partition(".") if isinstance(version, str) else ("", "", "")
    if major != str(layout.MAJOR) or not minor.isdecimal() or len(minor) > 5:
        given = version if isinstance(version, int | np.integer) else repr(str(version)[:20])
        yield (
            f"record version {given}; this physim reads version {layout.MAJOR}; make the record "
            "again"
        )
    for name in layout.ATTRIBUTES:
        if name not in attributes:
            yield f"attribute {name} is missing"
        value = attributes[name]
        if name == "ended" and isinstance(value, str):
            yield (
                "attribute ended is a text of variable length; it must be of fixed length, "
                f"S{layout.ENDED_BYTES}"
            )
        if name == "units" and value != layout.UNITS:
            yield f"attribute units is {value!r}; it must be {layout.UNITS!r}"
        if not _is_sound(name, value):
            yield f"attribute {name} is {value!r}, which no record has"
    versions = attributes.get("versions", "{}")
    if not isinstance(_from_json(versions), dict):
        yield f"attribute versions is {versions!r}; it must be a JSON object"


def _is_sound(name: str, value: Any) -> bool:
    """Whether a record may have this value of an attribute."""
    if name == "tables":
        found = _from_json(value)
        return isinstance(found, list) and all(table in layout.OPTIONAL for table in found)
    if name == "given":
        found = _from_json(value)
        return isinstance(found, list) and all(
            isinstance(one, list) and len(one) == 2 and all(isinstance(t, str) for t in one)
            for one in found
        )
    if name in layout.TEXTS:
        return isinstance(value, str)
    if name == "ended":
        return isinstance(value, bytes) and value.decode() in layout.ENDED
    is_number = np.ndim(value) == 0 and np.issubdtype(np.asarray(value).dtype, np.number)
    return bool(is_number and (name != "dt" or value > 0))


def _from_json(text: Any) -> Any:
    """What a JSON text says; None where it is none."""
    try:
        return json.loads(text)
    except (TypeError, ValueError):
        return None


def _dataset_faults(file: h5py.File) -> Iterator[str]:
    """What is wrong with the datasets; each is looked at only where those before are right."""
    for path in layout.DATASETS:
        if not isinstance(file.get(path), h5py.Dataset):
            yield f"dataset {path} is missing"
    robots = file["/robots/stop_station"].size
    bodies = file["/bodies/id"].size
    for path in ("/bodies/kind", "/bodies/name"):
        if file[path].size != bodies or bodies < robots:
            yield (
                f"dataset {path} has {file[path].size} rows, /bodies/id {bodies}, for {robots} "
                "robots"
            )
    columns = [name.decode() for name in file["/columns/name"][:]]
    wanted: dict[str, tuple[tuple[int, ...], Any]] = {
        **{path: ((), row) for path, row in layout.table_types(columns).items()},
        layout.OTHERS: ((), layout.other_type(robots)),
        **layout.steps_rows(robots),
    }
    for path, (shape, row) in wanted.items():
        found = file[path]
        if found.shape[1:] != shape or found.ndim != 1 + len(shape) or found.dtype != row:
            yield f"dataset {path} has rows {found.shape[1:]} of {found.dtype}"
    for path, row in (
        (layout.EXTREMES, layout.EXTREME),
        (layout.EXTREMES_FARTHEST, layout.FARTHEST),
    ):
        if file[path].dtype != row:
            yield f"dataset {path} has rows of {file[path].dtype}"
    for path in ("/robots/lead", layout.ARRIVED):
        if file[path].shape != (robots,):
            yield f"dataset {path} has rows {file[path].shape}"


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
