"""Text of a file that a user named: its kind, size and encoding checked before it is read."""

from __future__ import annotations

import difflib
import os
import stat
from pathlib import Path

from physim.errors import Fault, WorldError
from physim.world_file.reading import MOST_BYTES, refused

MOST_LISTED = 5


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
    printable = "".join(c if c.isprintable() else "�" for c in source)
    return WorldError([Fault((), f"{printable}: {message}")])


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
        raise refused(source, line, column, message) from None


def _listed(folder: Path, name: str) -> str:
    """World files of a folder that may be meant, nearest names first."""
    try:
        names = sorted(entry.name for entry in os.scandir(folder) if entry.is_file())
    except (OSError, ValueError):
        return f"; there is no folder {folder}" if not folder.exists() else ""
    worlds = [n for n in names if n.endswith((".yaml", ".yml")) and n.isprintable()]
    near = difflib.get_close_matches(name, [n for n in names if n.isprintable()], n=3, cutoff=0.6)
    listed = list(dict.fromkeys([*near, *worlds]))[:MOST_LISTED]
    if near:
        return f"; did you mean {' or '.join(near)}?"
    return f"; world files there: {', '.join(listed)}" if listed else ""
