"""Open a record file and hold it against the table of `layout`, or say in one line what is wrong.

Whoever made the file, reading it runs nothing, opens no other file and does not hang. Values are
held against the bounds of the table as they are read. A limit: the HDF5 library itself may crash on
a file whose index was changed byte by byte.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from physim.errors import RecordError, WorldError
from physim.escaping import escaped
from physim.parts.declarations import Declared
from physim.record import layout
from physim.record.layout import Bound, Dataset

AGAIN = "make the record again"
MOST_PACKED, LITTLE = 30, 10_000_000
"""A dataset may claim so many times the bytes that it has in the file, and in any case so many."""
LONGEST = 120
"""Characters of a value that a message repeats."""
_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def open_record(path: Path) -> h5py.File:
    """Open a record for reading. Raises RecordError that names the file and the fault."""
    if path.is_dir():
        inside = path / "record.h5"
        hint = f"; did you mean {inside}?" if inside.is_file() else ""
        raise RecordError(f"{path}: is a folder; give the record.h5 of a run{hint}")
    try:
        fault = "is not a regular file" if path.exists() else "no such file"
        if path.is_file():
            with path.open("rb") as stream:
                fault = "" if stream.read(len(_SIGNATURE)) == _SIGNATURE else "not an HDF5 file"
    except OSError as error:
        raise RecordError(f"{path}: cannot be read: {error.strerror}") from error
    if fault:
        raise RecordError(f"{path}: {fault}; give the record.h5 of a run")
    try:
        return h5py.File(path, "r")
    except OSError as error:
        fault = "truncated" if "truncated" in str(error) else "damaged"
        raise RecordError(f"{path}: {fault} HDF5 file; {AGAIN}") from error


def damaged(where: str, part: str, error: Exception) -> RecordError:
    """Error for a part of a record that cannot be read."""
    told = " ".join(str(error).split()) or type(error).__name__
    return RecordError(f"{where}: {part} cannot be read, the file is damaged: {told}")


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
    try:
        found = dict(file.attrs)
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise damaged(where, "its attributes", error) from error
    if shown(found.get("format")) != repr(layout.FORMAT):
        raise RecordError(f"{where}: not a record of physim (no attribute format)")
    if shown(version := found.get("version")) != repr(layout.VERSION):
        older = str(version)[:2] in ("1.", "2.", "3.", "4.")
        reader = "physim before 29 November 2026" if older else "another physim"
        raise RecordError(
            f"{where}: record version {shown(version)}, which {reader} reads; this one reads "
            f"version {layout.VERSION}: {AGAIN}"
        )
    if shown(found.get("units"), 999) != repr(layout.UNITS):
        raise RecordError(
            f"{where}: attribute units is {shown(found.get('units'))}; it must be {layout.UNITS!r}"
        )
    plain = {key: one.item() if isinstance(one, np.generic) else one for key, one in found.items()}
    if isinstance(ended := plain.get("ended"), bytes):
        plain["ended"] = ended.decode("utf-8", "replace")
    try:
        return {**vars(layout.AttributesModel.model_validate(plain))}
    except ValidationError as error:
        fault = error.errors()[0]
        key = str(fault["loc"][0])
        if fault["type"] == "missing":
            raise RecordError(f"{where}: attribute {key} is missing") from error
        raise RecordError(
            f"{where}: attribute {key} is {shown(found[key])}: {fault['msg']}; {AGAIN}"
        ) from error


def check_datasets(
    file: h5py.File, where: str, robots: int, bodies: int, declared: Declared
) -> None:
    """Check that an open file has every dataset of the table, each of its type and shape.

    Raises RecordError that names the first that is missing or not as it should be.
    """
    there: set[str] = set()
    growing = layout.row_types(robots, [column.name for column in declared.columns])
    sizes = {"N": robots, "N+1": robots + 1, "W+1": bodies - robots + 1}
    try:
        file.visit(there.add)  # no links, which may lead to other files
        for path, one in layout.TABLE.items():
            found = file[path] if path[1:] in there else None
            if fault := _fault(found, one, growing.get(path, one.dtype).base, sizes):
                raise RecordError(f"{where}: dataset {path} {fault}; {AGAIN}")
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise damaged(where, "a dataset", error) from error


def _fault(found: object, of: Dataset[Any], dtype: np.dtype[Any], sizes: Mapping[str, int]) -> str:
    """What is wrong with a dataset; empty where nothing is."""
    if not isinstance(found, h5py.Dataset):
        return "is missing"
    wanted = [int(size) if size.isdigit() else sizes.get(size) for size in of.shape]
    has = (-1,) if found.shape is None else found.shape
    if len(has) != len(wanted) or any(
        size not in (None, count) for size, count in zip(wanted, has, strict=True)
    ):
        many = f"{sizes['N']} robots, {sizes['W+1'] - 1} walls"
        return f"is of shape {found.shape}; it must be ({', '.join(of.shape)}), of {many}"
    if found.dtype != dtype:
        return f"holds {shown(found.dtype)}, not {shown(dtype)}"
    most = max(LITTLE, MOST_PACKED * found.id.get_storage_size())
    if found.is_virtual or found.external or found.nbytes > most:
        return f"claims {found.nbytes} bytes that are not in the file"
    return ""


def check_rows(
    where: str, of: Dataset[Any], rows: NDArray[Any], first: int, highest: Mapping[str, int]
) -> None:
    """Hold rows of a dataset, from row ``first`` on, against the table; ``highest`` as in `Bound`.

    Raises RecordError for the first row with a value out of its bounds, or out of order.
    """
    for field in of.fields:
        values = rows[field.name] if field.name else rows
        least, most = (_bound(rows, bound, highest) for bound in (field.least, field.most))
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
            fault = f"{field.name or 'value'}{place} is {values[at]}; allowed: {low} to {high}"
            refuse(where, of.path, first + at[0] if at else "", fault)
    step = rows if of is layout.Layout.steps else None
    if of.path in layout.TABLES:
        step = rows["step"]
    if step is not None:
        late = np.flatnonzero(np.diff(step) < (step is rows))
        if len(late):
            k = int(late[0]) + 1
            refuse(
                where, of.path, first + k,
                f"step {step[k]} comes after step {step[k - 1]}; steps must be in order",
            )  # fmt: skip


def _bound(rows: NDArray[Any], bound: Bound, highest: Mapping[str, int]) -> Any:
    if isinstance(bound, str):
        return highest[bound] if bound in highest else rows[bound] + 1
    return bound


def check_starts(where: str, of: Dataset[Any], start: NDArray[Any], whole: int) -> None:
    """Check the starts of packed runs: from 0 to ``whole``, each run of `Dataset.fewest` or more.

    Raises RecordError for the first wrong one.
    """
    ends = start[:1].tolist() + start[-1:].tolist()
    if ends != [0, whole]:
        refuse(where, of.path, "", f"it goes from {ends} and not from 0 to {whole}")
    short = np.flatnonzero(np.diff(start) < of.fewest)
    if len(short):
        k = int(short[0])
        has = int(start[k + 1]) - int(start[k])
        refuse(where, of.path, k, f"{has} rows of {of.starts}; at least {of.fewest} are needed")


def refuse(where: str, path: str, row: Any, fault: str) -> None:
    """Raise RecordError for a row of a dataset."""
    place = path if row == "" else f"{path}, row {row}"
    raise RecordError(f"{where}: {place}: {fault}; {AGAIN}")


def shown(value: Any, most: int = LONGEST) -> str:
    """A value briefly, on one line."""
    plain = value.item() if isinstance(value, np.generic) else value  # np.float64(nan) is nan
    told = str(escaped(" ".join(repr(plain).split())))
    return told if len(told) <= most else f"{told[:most]}…"
