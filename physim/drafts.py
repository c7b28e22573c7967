"""Names under which files are written until they are whole."""

from __future__ import annotations

import stat
from contextlib import suppress
from pathlib import Path
from uuid import uuid4

from physim.errors import PhysimError

KINDS = {
    stat.S_IFLNK: "a link",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def draft_of(path: Path) -> Path:
    """A hidden name in the folder of a file that nobody else takes for it.

    Raises PhysimError where the file's name is that of something else: `check_regular`.
    """
    check_regular(path)
    if "\0" in str(path):
        raise PhysimError(f"{path}: no file can have this name")
    if path.is_dir():
        raise PhysimError(f"{path}: is a folder; a file is to be written")
    return path.with_name(f".physim-{uuid4().hex}.part")


def check_regular(path: Path) -> None:
    """Raise PhysimError for a device, pipe or link: writing replaces what has the name."""
    try:
        mode = path.lstat().st_mode
    except (OSError, ValueError):
        return  # nothing there, or writing says what is wrong
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        kind = KINDS.get(stat.S_IFMT(mode), "something else")
        raise PhysimError(f"{path}: is not a regular file but {kind}, which is not overwritten")


def discard(draft: Path) -> None:
    """Remove what is left of a draft after an error, which stays the one to be told.

    A folder that is gone or read-only by now would raise another, about a name nobody gave.
    """
    with suppress(OSError):
        draft.unlink(missing_ok=True)


__all__ = ["check_regular", "discard", "draft_of"]
