"""Files that users name: read with every check of what they are, written whole or not at all."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO
from uuid import uuid4

from physim.errors import PhysimError

GZIP = b"\x1f\x8b"
"""How a compressed file begins."""
KINDS = {
    stat.S_IFLNK: "a link",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


class UnreadableError(PhysimError):
    """A file that cannot be read: why, without its name, and where in it, if anywhere (from 1)."""

    def __init__(self, message: str, line: int | None = None, column: int = 1) -> None:
        self.line, self.column = line, column
        super().__init__(message)


def read_bytes(path: Path, most: int) -> bytes:
    """Bytes of a regular file of at most ``most``; UnreadableError otherwise."""
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise UnreadableError("is a folder, not a file")
        if not stat.S_ISREG(status.st_mode):
            raise UnreadableError("is not a regular file")
        with path.open("rb") as file:
            data = file.read(most + 1)
    except FileNotFoundError:
        raise UnreadableError("no such file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise UnreadableError(f"cannot be read: {reason}") from None
    if len(data) > most:
        size = max(status.st_size, len(data)) / 1e6
        raise UnreadableError(f"{size:.1f} MB is too large; at most {most / 1e6:.0f} MB are read")
    return data


def read_text(path: Path, most: int) -> str:
    """Text (UTF-8) of a regular file of at most ``most`` bytes; UnreadableError otherwise."""
    data = read_bytes(path, most)
    if data.startswith(GZIP):
        raise UnreadableError("is compressed by gzip; unpack it first")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        column = len(before[before.rfind(b"\n") + 1 :].decode("utf-8-sig")) + 1
        message = f"byte 0x{data[error.start]:02x} is not UTF-8; save the file as UTF-8"
        raise UnreadableError(message, before.count(b"\n") + 1, column) from None


def check_regular(path: Path) -> None:
    """Raise PhysimError for a device, pipe or link: writing replaces what has the name."""
    try:
        mode = path.lstat().st_mode
    except (OSError, ValueError):
        return  # nothing there, or writing says what is wrong
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        kind = KINDS.get(stat.S_IFMT(mode), "something else")
        raise PhysimError(f"{path}: is not a regular file but {kind}, which is not overwritten")


def draft_of(path: Path) -> Path:
    """A hidden name in the folder of a file, under which it is written until it is whole.

    Raises PhysimError where the file's name is that of something else: `check_regular`.
    """
    check_regular(path)
    if "\0" in str(path):
        raise PhysimError(f"{path}: no file can have this name")
    if path.is_dir():
        raise PhysimError(f"{path}: is a folder; a file is to be written")
    return path.with_name(f".physim-{uuid4().hex}.part")


def discard(draft: Path) -> None:
    """Remove what is left of a draft after an error, which stays the one to be told.

    A folder that is gone or read-only by now would raise another, about a name nobody gave.
    """
    with suppress(OSError):
        draft.unlink(missing_ok=True)


@contextmanager
def draft(path: Path) -> Iterator[Path]:
    """A draft to write to, which takes the place of ``path`` when the block ends without an error.

    Of an error or Ctrl-C nothing is left. Raises PhysimError as `draft_of`.
    """
    part = draft_of(path)
    try:
        yield part
        part.replace(path)
    finally:
        discard(part)


@contextmanager
def written(path: Path) -> Iterator[BinaryIO]:
    """A stream to a file that is in its place, whole and on the disk, when the block has ended.

    One that is replaced leaves its permissions. Raises PhysimError where it cannot be written; of
    an error nothing is left.
    """
    try:
        with draft(path) as part, open(part, "wb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
            with suppress(FileNotFoundError):
                part.chmod(stat.S_IMODE(path.stat().st_mode))
    except OSError as error:
        raise PhysimError(f"{path}: cannot be written: {error.strerror or error}") from error


def write_whole(path: Path, data: bytes | memoryview) -> None:
    """As `written`, at once."""
    with written(path) as stream:
        stream.write(data)


def write_text(path: Path, text: str) -> None:
    """As `write_whole`, in UTF-8; half of a pair of surrogates is escaped."""
    write_whole(path, text.encode("utf-8", "backslashreplace"))
