"""World files on disk: the shipped ones, finding one by path or by name, and its text.

The record of a run is a world, too: the effective one inside it.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import as_file, files
from pathlib import Path

import yaml

from physim.errors import Fault, Position, WorldError, nearest
from physim.escaping import escaped
from physim.files import UnreadableError, read_text
from physim.json_text import parse_json
from physim.world.file.document import MOST_BYTES, Document, read_document, refused

SUFFIXES = (".yaml", ".yml")
RECORD = "record.h5"
"""What the record of a run is called in its folder"""
GROUPS = ("league", "training")
"""Folders of shipped worlds beside the gallery's: those of the league, and those for tuning"""
PROGRAMME = "league.yaml"
"""In the folder of the league's worlds: who meets where; no world"""
IMPORTED = (".svg", ".csv", ".wkt", ".geojson")
"""Endings of files of which physim import makes worlds."""


def shipped_folder() -> Path:
    """Folder of the shipped worlds."""
    with as_file(files("physim.worlds")) as folder:
        return folder


def shipped_worlds(group: str = "") -> dict[str, str]:
    """Name and one-line description of every shipped world, or of those of a group, by name."""
    found = {}
    for name in _names(group):
        document = yaml.safe_load(_shipped(name).read_text(encoding="utf-8"))
        found[name] = str(document.get("description", ""))
    return found


def _names(group: str) -> list[str]:
    """Names of the shipped worlds of a group, as ``league/NAME``; without one plain."""
    files = sorted((shipped_folder() / group).glob("*.yaml"))
    names = (file.stem for file in files if file.name != PROGRAMME)
    return [f"{group}/{name}" if group else name for name in names]


def _shipped(name: str) -> Path:
    return shipped_folder() / f"{name}.yaml"


def find_world(given: str | os.PathLike[str]) -> Path:
    """Path of a world given as a file, by the name of one in ``worlds/``, or of a shipped one.

    A file goes first, then ``worlds/NAME.yaml`` of the working directory. Of the folder of a run it
    is the record. Names of grouped worlds are ``league/NAME`` and ``training/NAME``.

    Raises WorldError when there is neither, with the nearest names.
    """
    path, given = Path(given), str(given)
    is_grouped = len(path.parts) == 2 and path.parts[0] in GROUPS
    plain = given.isprintable() and path.suffix not in SUFFIXES
    plain = plain and (len(path.parts) == 1 or is_grouped)
    shipped = _names(path.parts[0] if is_grouped else "")
    if plain and (path.is_dir() or not path.exists()):  # a folder of that name may hold its runs
        if (own := Path("worlds", f"{given}.yaml")).is_file():
            return own
        if given in shipped:
            return _shipped(given)
    if not plain or path.exists():
        run = path / RECORD
        return run if is_record(run) else path  # reading says what is wrong with it
    message = f'{given}: no such file, and no shipped world is called "{given}"'
    near = _nearest(path, shipped) or f"; shipped: {', '.join(shipped)}"
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

    Raises `WorldError` when it cannot be read, naming the nearest file, or is of another kind.
    """
    if path.suffix in IMPORTED and os.path.isfile(path):
        raise _unreadable(path, "is no world file; physim import makes one of it")
    try:
        return read_text(path, MOST_BYTES)
    except UnreadableError as error:
        if error.line is not None:
            raise refused(Position(path, error.line, error.column), str(error)) from None
        near = "" if os.path.lexists(path) else _nearest(path)
        raise _unreadable(path, f"{error}{near}") from None


def _unreadable(path: Path, message: str) -> WorldError:
    return WorldError([Fault((), f"{escaped(str(path))}: {message}")])


def _nearest(path: Path, shipped: Sequence[str] = ()) -> str:
    """``; did you mean "x.yaml"?``: a world file of the same folder, or a shipped world."""
    try:
        names = sorted(os.listdir(path.parent))
    except (OSError, ValueError):
        names = []
    return nearest(path.name, [*(name for name in names if name.endswith(SUFFIXES)), *shipped])
