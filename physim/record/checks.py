"""Open a record file, or say in one line why it cannot be read.

A limit: the HDF5 library itself may crash on a file whose index was changed byte by byte. What is
caught here are files that break off, that are something else, or that lack or twist a part.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from physim.errors import RecordError
from physim.escaping import escaped
from physim.json_text import parse_json
from physim.record import layout
from physim.record.heaps import text_fault
from physim.record.packing import packing_fault

MOST_PACKED = 30
"""[-] A dataset may be packed up to this, far more than motion can be; records are not packed."""
RANGES = {"dt": (1.0e-9, 10.0), "safe_distance": (0.0, 1.0e6)}
"""[s], [m] least and largest value of an attribute"""
MOST_EVERY = 1_000_000
"""[steps] between two samples"""
LONGEST = 120
"""Characters of a value that a message repeats."""
DEEPEST = 8
"""Levels of groups: those of records are two."""
LITTLE = 10_000_000
"""[bytes] What a dataset may claim whatever it holds: a constant, or zeros that nobody wrote."""
PLACE = (b"areas/", b"walls/", b"reference/")
"""What of a record describes the place: nothing in it comes again and again, as paths and
footprints of many robots may."""
LITTLE_PLACE = 1_000_000
"""[bytes] What a dataset of it may claim: pictures cost by its points."""
FEW_TEXTS = 100
"""Texts that are read in one go before their length is known."""
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


def unreadable_world(where: str, error: Exception) -> RecordError:
    """What to raise where the text of the world inside is faulty: its first fault."""
    fault = str(error).splitlines()[0].removeprefix(f"world of {where}:").strip()
    return RecordError(f"{where}: the world inside cannot be read: {fault}")


def check_layout(file: h5py.File, where: str) -> None:
    """Check that an open file is a record of this version, with all its parts.

    Raises RecordError that names the first part that is missing or not as it should be.
    """
    try:
        parts = (_link_faults(file), _attribute_faults(file.attrs), _dataset_faults(file))
        fault = next(chain.from_iterable(parts), None)
    except Exception as error:  # the library raises many kinds for damaged files
        raise RecordError(f"{where}: damaged record: {_one_line(error)}") from error
    if fault is not None:
        raise RecordError(f"{where}: {fault}")


def damaged(where: str, part: str, error: Exception) -> RecordError:
    """Error for a part of a record that cannot be read."""
    return RecordError(f"{where}: {part} cannot be read, the file is damaged: {_one_line(error)}")


def _link_faults(file: h5py.File) -> Iterator[str]:
    """What leads out of the file, or claims more than is there; looked at before any value is.

    A record has datasets with all their rows in the file itself.
    """
    for name in file.attrs:
        values = h5py.h5a.open(file.id, name.encode("utf-8", "surrogateescape")).get_space()
        if values.get_simple_extent_npoints() > 1:
            yield f"attribute {escaped(name)} holds many values; a record has one"
    links, fault = _links(file)
    if fault is not None:
        yield f"/{_name(links[-1])} {fault}"
    texts: list[bytes] = []
    for link in links:
        found = h5py.h5o.open(file.id, link)
        if not isinstance(found, h5py.h5d.DatasetID):
            continue
        if (fault := _storage_fault(found, link.startswith(PLACE))) is not None:
            yield f"/{_name(link)} {fault}"
        kind = found.get_type()
        if kind.get_class() == h5py.h5t.VLEN:
            yield f"/{_name(link)} holds lists of their own lengths; a record has none"
        if kind.get_class() == h5py.h5t.STRING and kind.is_variable_str():
            texts.append(link)
    yield from _text_faults(file, texts)


def _links(file: h5py.File) -> tuple[list[bytes], str | None]:
    """Path of every part, up to the first with a fault, and that fault.

    By the library itself, which looks up no path from the root: there may be many.
    """
    links: list[bytes] = []

    def look_at(link: bytes, info: h5py.h5l.LinkInfo) -> str | None:
        links.append(link)
        if info.type != h5py.h5l.TYPE_HARD:
            return "is a link to another place; a record has none"
        too_deep = link.count(b"/") >= DEEPEST
        return f"lies deeper than {DEEPEST} levels; no part of a record does" if too_deep else None

    return links, file.id.links.visit(look_at, info=True)


def _name(link: bytes) -> str:
    return str(escaped(link.decode("utf-8", "surrogateescape")[:LONGEST]))


def _storage_fault(dataset: h5py.h5d.DatasetID, is_place: bool) -> str | None:
    """What is wrong with how a dataset lies in the file; ``is_place``: it is one of `PLACE`."""
    if h5py.h5o.get_info(dataset).rc > 1:
        return "is in several places; a record has each part once"
    plan = dataset.get_create_plist()
    if plan.get_layout() == h5py.h5d.VIRTUAL or plan.get_external_count():
        return "lies in another file; a record is one file"
    rows, there = dataset.get_space().get_simple_extent_npoints(), dataset.get_storage_size()
    most = max(LITTLE_PLACE if is_place else LITTLE, MOST_PACKED * there)
    if rows * dataset.get_type().get_size() > most:
        return f"claims {rows} values and holds {there} bytes; it is damaged"
    return packing_fault(dataset, most)


def _text_faults(file: h5py.File, links: list[bytes]) -> Iterator[str]:
    """Texts that are longer together than the file: many of them are one and the same there.

    ``links`` are those of datasets. What lies in one piece is looked at in the file itself, before
    the library reads a text: it believes its length.
    """
    most, length = max(LITTLE, file.id.get_filesize()), 0
    for link in links:
        found = h5py.h5o.open(file.id, link)
        known: int | None = None
        if file.driver == "sec2":
            fault, known = text_fault(Path(file.filename), found, most - length)
            if fault is not None:
                yield f"/{_name(link)} {fault}"
        rows = found.get_space().get_simple_extent_npoints()
        for first in range(0, rows if known is None else 0, FEW_TEXTS):
            last = first + FEW_TEXTS
            texts = np.atleast_1d(file[link][first:last] if rows > 1 else file[link][()])
            length += sum(map(len, texts.ravel().tolist()))
            if length > most:
                yield f"/{_name(link)} claims more than {most} letters; it is damaged"
        length += known or 0


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
        if name == "units" and not (isinstance(value, str) and value == layout.UNITS):
            yield f"attribute units is {_shown(value)}; it must be {layout.UNITS!r}"
        if not _is_sound(name, value):
            yield f"attribute {name} is {_shown(value)}, which no record has"
    versions = attributes.get("versions", "{}")
    found = _from_json(versions)
    if not isinstance(found, dict) or not all(map(_is_line, chain.from_iterable(found.items()))):
        yield f"attribute versions is {_shown(versions)}; it must be a JSON object of texts"
    settings = attributes.get("given_settings", "[]")
    found = _from_json(settings)
    if not isinstance(found, list) or not all(map(_is_settings, found)):
        yield (
            f"attribute given_settings is {_shown(settings)}; it must be a JSON list of "
            "settings and not_known, one for each part in given"
        )


def _is_sound(name: str, value: Any) -> bool:
    """Whether a record may have this value of an attribute."""
    if name == "tables":
        found = _from_json(value)
        return isinstance(found, list) and all(table in layout.OPTIONAL for table in found)
    if name == "name":
        return _is_line(value)
    if name == "given":
        found = _from_json(value)
        return isinstance(found, list) and all(
            isinstance(one, list) and len(one) == 2 and all(map(_is_line, one)) for one in found
        )
    if name in layout.TEXTS:
        return isinstance(value, str)
    if name == "ended":
        return isinstance(value, bytes) and value.decode() in layout.ENDED
    if np.ndim(value) != 0:
        return False
    if name in RANGES:
        least, most = RANGES[name]
        return bool(np.issubdtype(np.asarray(value).dtype, np.floating) and least <= value <= most)
    is_whole = np.issubdtype(np.asarray(value).dtype, np.integer)
    least, most = (1, MOST_EVERY) if name == "record_every" else (0, 2**63)
    return bool(is_whole and least <= value <= most)


def _is_settings(value: Any) -> bool:
    """Whether a value tells the settings of one part from Python."""
    if not isinstance(value, dict) or value.keys() != {"settings", "not_known"}:
        return False
    settings, not_known = value["settings"], value["not_known"]
    lines = isinstance(settings, dict) and isinstance(not_known, list)
    return lines and all(map(_is_line, (*settings, *not_known)))


def _is_line(value: Any) -> bool:
    """Whether a value is one line of text that can be printed."""
    return isinstance(value, str) and value.isprintable()


def _shown(value: Any) -> str:
    """A value briefly, on one line."""
    plain = value.item() if isinstance(value, np.generic) else value  # np.float64(nan) is nan
    text = escaped(_one_line_of(repr(plain)))
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}…"


def _from_json(text: Any) -> Any:
    """What a JSON text says; None where it is none."""
    try:
        return parse_json(text)
    except (TypeError, ValueError):
        return None


def _dataset_faults(file: h5py.File) -> Iterator[str]:
    """What is wrong with the datasets; each is looked at only where those before are right."""
    for path in layout.DATASETS:
        if not isinstance(file.get(path), h5py.Dataset):
            yield f"dataset {path} is missing"
    fixed = {**layout.FIXED, layout.EXTREMES: ((), layout.EXTREME), layout.ARRIVED: ((), "<i8")}
    yield from _row_faults(file, fixed)
    farthest = file[layout.EXTREMES_FARTHEST]
    if farthest.shape != () or farthest.dtype != layout.FARTHEST:
        yield f"dataset {layout.EXTREMES_FARTHEST} has rows {_rows(farthest)}; it is one row"
    robots = len(file["/robots/stop_station"])
    bodies = len(file["/bodies/id"])
    for path in ("/bodies/kind", "/bodies/name"):
        if len(file[path]) != bodies or bodies < robots:
            yield (
                f"dataset {path} has {len(file[path])} rows, /bodies/id {bodies}, for {robots} "
                "robots"
            )
        for k, text in enumerate(file[path][:]):
            if not _is_line(text.decode("utf-8", "surrogateescape")):
                yield f"{path}, row {k}: {_shown(text)} is no line of text; make the record again"
    for k, number in enumerate(file["/bodies/id"][:].tolist()):
        if number != k:
            yield f"/bodies/id, row {k}: it is {number}; it must be {k}; make the record again"
    for k, kind in enumerate(file["/bodies/kind"][:]):
        allowed = (b"robot",) if k < robots else (b"boundary", b"obstacle")
        if kind not in allowed:
            words = " or ".join(one.decode() for one in allowed)
            given = _shown(kind.decode())
            yield f"/bodies/kind, row {k}: {given} is no {words}; {robots} robots come first"
    for path in ("/robots/lead", layout.ARRIVED, layout.EXTREMES):
        if len(file[path]) != robots:
            yield f"dataset {path} has {len(file[path])} rows for {robots} robots"
    columns = [name.decode() for name in file["/columns/name"][:]]
    growing = {
        **{path: ((), row) for path, row in layout.table_types(columns).items()},
        layout.OTHERS: ((), layout.other_type(robots)),
        **layout.steps_rows(robots),
    }
    yield from _row_faults(file, growing)
    for key, value in getattr(file.get(layout.WALL_CLOCK), "attrs", {}).items():
        if np.ndim(value) != 0 or not np.issubdtype(np.asarray(value).dtype, np.number):
            yield f"attribute {escaped(key)} of {layout.WALL_CLOCK} is no number"


def _row_faults(file: h5py.File, wanted: Mapping[str, layout.Row]) -> Iterator[str]:
    """Datasets that are no rows of the wanted shape and type."""
    for path, (shape, row) in wanted.items():
        found = file[path]
        if found.shape is None or found.ndim != 1 + len(shape) or found.shape[1:] != shape:
            yield f"dataset {path} has rows {_rows(found)}; {shape} are needed"
        if row == layout.TEXT:
            if h5py.check_string_dtype(found.dtype) is None or found.dtype.kind != "O":
                yield f"dataset {path} holds no texts"
        elif found.dtype != row:
            yield f"dataset {path} has rows {_rows(found)}; they are of another type"


def _rows(dataset: h5py.Dataset) -> str:
    """Shape and type of the rows of a dataset, briefly."""
    shape = dataset.shape[1:] if dataset.shape else dataset.shape
    return f"{shape} of {_shown(dataset.dtype)}"


def _one_line(error: Exception) -> str:
    return _one_line_of(str(error)) or type(error).__name__


def _one_line_of(text: str) -> str:
    return " ".join(text.split())
