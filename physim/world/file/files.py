"""World files on disk: the shipped ones, finding one by path or by name, and its text.

Kind, size and encoding of a file that a user named are checked before it is read. The record of a
run is a world, too: the effective one inside it.
"""

from __future__ import annotations

import difflib
import os
import stat
from dataclasses import replace
from importlib.resources import as_file, files
from pathlib import Path
from types import MappingProxyType

import yaml

from physim.errors import Fault, WorldError, nearest
from physim.escaping import escaped
from physim.json_text import parse_json
from physim.world.file.document import MOST_BYTES, Document, read_document, refused

SUFFIXES = (".yaml", ".yml")
RECORD = "record.h5"
"""What the record of a run is called in its folder"""


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

    Raises WorldError when there is neither, with the nearest names: of world files here, else of
    shipped ones.
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
    if near := _near(Path(), given):
        raise WorldError([Fault((), f"{message}; did you mean {' or '.join(near)}?")])
    more = f"; shipped: {', '.join(shipped)}{nearest(given, shipped)}"
    raise WorldError([Fault((), message + more)])


def stem_of(file: str | os.PathLike[str]) -> str:
    """What is named after a world file: its name without ending, in one line.

    Of a record.h5 that of its folder. ``world`` where it is dots alone, which name no file or
    folder of their own.
    """
    path = Path(file)
    stem = escaped(path.absolute().parent.name if path.name == RECORD else path.stem)
    return stem if stem.strip(".") else "world"


def _near(folder: Path, given: str) -> list[str]:
    """World files of a folder whose names without ending are the one given, or much like it."""
    try:
        names = sorted(entry.name for entry in os.scandir(folder) if entry.is_file())
    except OSError:
        return []
    worlds = [name for name in names if name.endswith(SUFFIXES) and name.isprintable()]
    if same := [name for name in worlds if Path(name).stem == given]:
        return same
    return [n for n in worlds if difflib.get_close_matches(given, [Path(n).stem], 1, 0.8)][:3]


MOST_LISTED = 5
OTHER_KINDS = MappingProxyType(
    {
        **dict.fromkeys((".h5", ".hdf5"), "nor is it a record, which begins as HDF5 files do"),
        **dict.fromkeys((".svg", ".csv", ".wkt", ".geojson"), "physim import makes one of it"),
    }
)
"""What is done with files that are no worlds, by ending."""


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
        raise _unreadable(str(path), f"is not the record of a run, or damaged: {reason}") from None
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

    Raises `WorldError` when it is missing (naming files near it), a folder, no regular file, too
    large, unreadable or not UTF-8.
    """
    source = str(path)
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise _unreadable(source, f"is a folder, not a world file{_listed(path, '')}")
        if not stat.S_ISREG(status.st_mode):
            raise _unreadable(source, "is not a regular file")
        if instead := OTHER_KINDS.get(path.suffix):
            raise _unreadable(source, f"is no world file; {instead}")
        if status.st_size > MOST_BYTES:
            raise _unreadable(source, _too_large(status.st_size))
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
    except FileNotFoundError:
        raise _unreadable(source, f"no such file{_listed(path.parent, path.name)}") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise _unreadable(source, f"cannot be read: {reason}") from None
    if len(data) > MOST_BYTES:
        raise _unreadable(source, _too_large(len(data)))
    return _decoded(data, source)


def _unreadable(source: str, message: str) -> WorldError:
    return WorldError([Fault((), f"{escaped(source)}: {message}")])


def _too_large(size: int) -> str:
    return f"{size / 1e6:.1f} MB is too large; a world file has at most {MOST_BYTES / 1e6:.0f} MB"


def _decoded(data: bytes, source: str) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        line = before.count(b"\n") + 1
        column = len(before[before.rfind(b"\n") + 1 :].decode("utf-8")) + 1
        message = f"byte 0x{data[error.start]:02x} is not UTF-8; save the file as UTF-8"
        if data.startswith(b"\x1f\x8b"):
            message = "is compressed by gzip; unpack it first"
        raise refused(source, line, column, message) from None


def _listed(folder: Path, name: str) -> str:
    """World files of a folder that may be meant, nearest names first."""
    try:
        names = sorted(entry.name for entry in os.scandir(folder) if entry.is_file())
    except (OSError, ValueError):
        return f"; there is no folder {folder}" if not folder.exists() else ""
    worlds = [n for n in names if n.endswith(SUFFIXES) and n.isprintable()]
    stem = Path(name).stem  # without what all have alike
    alike = difflib.get_close_matches(stem, [Path(n).stem for n in worlds], n=3, cutoff=0.6)
    near = [n for one in dict.fromkeys(alike) for n in worlds if Path(n).stem == one][:3]
    if near:
        return f"; did you mean {' or '.join(near)}?"
    more = f" and {len(worlds) - MOST_LISTED} more" if len(worlds) > MOST_LISTED else ""
    return f"; world files there: {', '.join(worlds[:MOST_LISTED])}{more}" if worlds else ""
