"""World files on disk: the shipped ones, finding one by path or by name, and its text.

The record of a run is a world, too: the effective one inside it.
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import as_file, files
from pathlib import Path
from types import MappingProxyType

import yaml

from physim.errors import Fault, WorldError
from physim.escaping import escaped
from physim.files import UnreadableError, read_text
from physim.json_text import parse_json
from physim.world.file.document import MOST_BYTES, Document, read_document, refused

SUFFIXES = (".yaml", ".yml")
RECORD = "record.h5"
"""What the record of a run is called in its folder"""
MOST_LISTED = 5
OTHER_KINDS = MappingProxyType(
    {
        **dict.fromkeys((".h5", ".hdf5"), "nor is it a record, which begins as HDF5 files do"),
        **dict.fromkeys((".svg", ".csv", ".wkt", ".geojson"), "physim import makes one of it"),
    }
)
"""What is done with files that are no worlds, by ending."""


def shipped_folder() -> Path:
    """Folder of the shipped worlds."""
    with as_file(files("physim.worlds")) as folder:
        return folder


def shipped_worlds() -> dict[str, str]:
    """Name and one-line description of every shipped world, by name."""
    found = {}
    for file in sorted(shipped_folder().glob("*.yaml")):
        document = yaml.safe_load(file.read_text(encoding="utf-8"))
        found[file.stem] = str(document.get("description", ""))
    return found


def find_world(given: str | os.PathLike[str]) -> Path:
    """Path of a world given as a file, by the name of one in ``worlds/``, or of a shipped one.

    A file goes first, then ``worlds/NAME.yaml`` of the working directory.

    Raises WorldError when there is neither, with the nearest names.
    """
    path, given = Path(given), str(given)
    plain = given.isprintable() and len(path.parts) == 1 and path.suffix not in SUFFIXES
    shipped = [file.stem for file in sorted(shipped_folder().glob("*.yaml"))]
    if plain and (path.is_dir() or not path.exists()):  # a folder of that name may hold its runs
        if (own := Path("worlds", f"{given}.yaml")).is_file():
            return own
        if given in shipped:
            return shipped_folder() / f"{given}.yaml"
    if not plain or path.exists():
        return path  # reading says what is wrong with it
    message = f'{given}: no such file, and no shipped world is called "{given}"'
    near = _nearest(given, [*_worlds(Path()), *shipped]) or f"; shipped: {', '.join(shipped)}"
    raise WorldError([Fault((), message + near)])


def stem_of(file: str | os.PathLike[str]) -> str:
    """What is named after a world file: its name without ending, in one line.

    Of a record.h5 that of its folder. ``world`` where it is dots alone, which name no file or
    folder of their own.
    """
    path = Path(file)
    stem = escaped(path.absolute().parent.name if path.name == RECORD else path.stem)
    return stem if stem.strip(".") else "world"


def world_document(given: str | os.PathLike[str]) -> Document:
    """Document of a world, given as for `find_world`: of its file, or of the record of a run.

    The world of a record is the effective one, with the changes and the seed of its run. Raises
    WorldError where it cannot be read.
    """
    path = find_world(given)
    if not is_record(path):
        return read_document(file_text(path), str(path))
    import h5py

    try:
        with h5py.File(path, "r") as file:
            text, parts = str(file.attrs["world"]), parse_json(str(file.attrs["given"]))
        from_python = tuple((str(kind), str(name)) for kind, name in parts)
    except Exception as error:  # the library raises many kinds for damaged files
        reason = " ".join(str(error).split())[:100]
        raise _unreadable(path, f"is not the record of a run, or damaged: {reason}") from None
    return replace(read_document(text, f"world of {path}"), from_python=from_python)


def is_record(path: Path) -> bool:
    """Whether a file is a record rather than the text of a world, by how it begins."""
    try:
        if not path.is_file():  # nor is a pipe opened, which could wait for ever
            return False
        with path.open("rb") as file:
            return file.read(4) == b"\x89HDF"
    except OSError:
        return False  # reading it says why


def file_text(path: Path) -> str:
    """Text (UTF-8) of a world file.

    Raises `WorldError` when it cannot be read, naming files near it, or is of another kind.
    """
    if (instead := OTHER_KINDS.get(path.suffix)) and os.path.isfile(path):
        raise _unreadable(path, f"is no world file; {instead}")
    try:
        return read_text(path, MOST_BYTES)
    except UnreadableError as error:
        if error.line is not None:
            raise refused(str(path), error.line, error.column, str(error)) from None
        raise _unreadable(path, f"{error}{_instead(path)}") from None


def _unreadable(path: Path, message: str) -> WorldError:
    return WorldError([Fault((), f"{escaped(str(path))}: {message}")])


def _instead(path: Path) -> str:
    """World files that may be meant where one cannot be read."""
    is_folder = os.path.isdir(path)  # those of pathlib raise for names that are too long
    if os.path.lexists(path) and not is_folder:
        return ""
    folder = path if is_folder else path.parent
    if not os.path.exists(folder):
        return f"; there is no folder {folder}"
    worlds = _worlds(folder)
    if near := "" if is_folder else _nearest(path.name, worlds):
        return near
    more = f" and {len(worlds) - MOST_LISTED} more" if len(worlds) > MOST_LISTED else ""
    return f"; world files there: {', '.join(worlds[:MOST_LISTED])}{more}" if worlds else ""


def _worlds(folder: Path) -> list[str]:
    """Names of the world files of a folder."""
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return []
    worlds = [name for name in names if name.endswith(SUFFIXES) and name.isprintable()]
    return [name for name in worlds if os.path.isfile(folder / name)]


def _nearest(given: str, worlds: Sequence[str]) -> str:
    """``; did you mean "x.yaml"?``: those whose names without ending are much like one given."""
    stems = [Path(name).stem for name in worlds]
    close = difflib.get_close_matches(Path(given).stem, dict.fromkeys(stems), n=3, cutoff=0.6)
    near = [name for one in close for name in worlds if Path(name).stem == one][:3]
    named = " or ".join(f'"{name}"' for name in near)
    return f"; did you mean {named}?" if near else ""
