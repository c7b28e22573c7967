"""Open a record file and hold it against the table of `layout`, or say in one line what is wrong.

Whoever made the file, reading it runs nothing, opens no other file and does not hang. Values are
held against the bounds of the table as they are read. A limit: the HDF5 library itself may crash on
a file whose index was changed byte by byte.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from physim.errors import RecordError, WorldError
from physim.escaping import escaped
from physim.parts.user_code import first_fault
from physim.record import layout
from physim.record.table import Bound, Dataset

AGAIN = "make the record again"
MOST_PACKED, LITTLE = 30, 10_000_000
"""A dataset may claim so many times the bytes that it has in the file, and in any case so many."""
BROKEN = (OSError, RuntimeError, KeyError, ValueError, TypeError, MemoryError)
"""What h5py raises for a damaged file."""


def open_record(path: Path) -> h5py.File:
    """Open a record for reading. Raises RecordError that names the file and the fault."""
    fault = ""
    if not os.path.isfile(path):
        fault = "is no file" if os.path.exists(path) else "no such file"
    elif not h5py.is_hdf5(path):
        fault = "not an HDF5 file" if os.access(path, os.R_OK) else "cannot be read"
    if fault:
        raise RecordError(f"{path}: {fault}; give the folder of a run, or its record.h5")
    try:
        return h5py.File(path, "r")
    except OSError as error:
        fault = "truncated" if "truncated" in str(error) else "damaged"
        raise RecordError(f"{path}: {fault} HDF5 file; {AGAIN}") from error


@contextmanager
def reading(where: str, part: str) -> Iterator[None]:
    """Turn what h5py raises for a part that cannot be read into RecordError."""
    try:
        yield
    except BROKEN as error:
        told = " ".join(str(error).split()) or type(error).__name__
        raise RecordError(f"{where}: {part} cannot be read, the file is damaged: {told}") from error


def check_record(given: object) -> None:
    """Raise TypeError for what is no record, as a file, a world or a summary."""
    if not hasattr(given, "footprints"):
        raise TypeError(
            f"a Record is needed, not {type(given).__name__}; Record.load(file) or simulate(world) "
            "gives one"
        )


@contextmanager
def reading_world(where: str) -> Iterator[None]:
    """Turn a fault of the world inside into RecordError, one line with the first fault."""
    try:
        yield
    except WorldError as error:
        fault = str(error).splitlines()[0].removeprefix(f"world of {where}:").strip()
        raise RecordError(f"{where}: the world inside cannot be read: {fault}") from error


def attributes_of(file: h5py.File, where: str) -> dict[str, Any]:
    """Values of the attributes of a record of this version, by the names of properties.

    Raises RecordError that names the first that is missing or not as it should be.
    """
    with reading(where, "its attributes"):
        given = dict(file.attrs)
    found = {key: one.item() if isinstance(one, np.generic) else one for key, one in given.items()}
    if isinstance(ended := found.get("ended"), bytes):
        found["ended"] = ended.decode("utf-8", "replace")
    try:
        return {**vars(layout.AttributesModel.model_validate(found))}
    except ValidationError as error:
        key = error.errors()[0]["loc"][0]
        told = str(escaped(" ".join(first_fault(error).split())))
        if key == "format":
            told = f"not a record of physim ({told})"
        elif key == "version":
            told = f"record {told}; physim before 29 November 2026 reads version 4.0 and older"
        else:
            told = f"attribute {told}"
        raise RecordError(f"{where}: {told}; {AGAIN}") from error


def check_datasets(
    file: h5py.File,
    where: str,
    tables: Sequence[str],
    sizes: Mapping[str, int],
    types: Mapping[str, np.dtype[Any]],
) -> None:
    """Check that an open file has every dataset that it needs, each of its type and shape.

    ``tables`` are the optional ones that it says it has, ``sizes`` those of shapes that are known,
    ``types`` those of rows that grow. Raises RecordError that names the first that is missing or
    not as it should be.
    """
    there: set[str] = set()
    with reading(where, "a dataset"):
        file.visit(there.add)  # no links, which may lead to other files
        for path, one in layout.TABLE.items():
            if not (one.needed or path[1:] in (*tables, *there)):
                continue
            found = file[path] if path[1:] in there else None
            if fault := _fault(found, one, types.get(path, one.dtype).base, sizes):
                raise RecordError(f"{where}: dataset {path} {fault}; {AGAIN}")


def has_column(file: h5py.File, path: str, name: str) -> bool:
    """Whether a dataset is in the file, which no link is, and has a column of that name."""
    if not isinstance(file.get(path, getlink=True), h5py.HardLink):
        return False
    with reading(path, name):
        found = file[path]
        return isinstance(found, h5py.Dataset) and name in (found.dtype.names or ())


def _fault(found: object, of: Dataset[Any], dtype: np.dtype[Any], sizes: Mapping[str, int]) -> str:
    """What is wrong with a dataset; empty where nothing is."""
    if not isinstance(found, h5py.Dataset):
        return "is missing"
    has = (-1,) if found.shape is None else found.shape
    if [*has] != [sizes.get(size, count) for size, count in zip(of.shape, has, strict=False)] or (
        len(has) != len(of.shape)
    ):
        known = ", ".join(f"{name} = {size}" for name, size in sizes.items() if not name.isdigit())
        return f"is of shape {found.shape}; it must be ({', '.join(of.shape)}), {known}"
    if found.dtype != dtype:
        return f"holds {found.dtype!s:.120}, not {dtype!s:.120}"
    most = max(LITTLE, MOST_PACKED * found.id.get_storage_size())
    if found.is_virtual or found.external or found.nbytes > most:
        return f"claims {found.nbytes} bytes that are not in the file"
    return ""


def check_rows(
    where: str, of: Dataset[Any], rows: NDArray[Any], first: int, highest: Mapping[str, int]
) -> None:
    """Hold rows of a dataset, from row ``first`` on, against the table.

    ``highest`` are the numbers of `Bound`, and of datasets in which others say where runs begin,
    by their paths, their rows. Raises RecordError for the first row with a value out of its bounds,
    or out of order.
    """

    def bound(given: Bound) -> Any:
        if isinstance(given, str):
            return highest[given] if given in highest else rows[given] + 1
        return given

    def refuse(row: int | None, fault: str) -> None:
        place = of.path if row is None else f"{of.path}, row {first + row}"
        raise RecordError(f"{where}: {place}: {fault}; {AGAIN}")

    for field in of.fields:
        values = rows[field.name] if field.name else rows
        least, most = bound(field.least), bound(field.most)
        wrong = np.zeros(values.shape, dtype=np.bool_)
        if least is not None:
            wrong |= ~(values >= least)  # so is NaN
        if most is not None:
            wrong |= ~(values <= most)
        if wrong.any():
            at = tuple(np.argwhere(wrong)[0].tolist())
            low, high = (
                "any" if one is None else f"{np.broadcast_to(one, values.shape)[at]:g}"
                for one in (least, most)
            )
            place = f" {[*at[1:]]}" if at[1:] else ""
            refuse(
                at[0] if at else None,
                f"{field.name or 'value'}{place} is {values[at]}; allowed: {low} to {high}",
            )
    if of.starts:
        ends, whole = [*rows[:1].tolist(), *rows[-1:].tolist()], highest[of.starts]
        if ends != [0, whole]:
            refuse(None, f"it goes from {ends} and not from 0 to {whole}")
    is_table = of.path in layout.TABLES
    if of.starts or is_table or of is layout.Layout.steps:
        order = rows["step"] if is_table else rows
        apart = np.diff(order)
        fewest = 0 if is_table else of.fewest
        if (apart < fewest).any():
            k = int(np.argmax(apart < fewest))
            if of.starts:
                refuse(k, f"{apart[k]} rows of {of.starts}; at least {fewest} are needed")
            refuse(
                k + 1, f"step {order[k + 1]} comes after step {order[k]}; steps must be in order"
            )
