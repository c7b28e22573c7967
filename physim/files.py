"""Files that users name: read with every check of what they are, written whole or not at all."""

from __future__ import annotations

import stat
from contextlib import suppress
from pathlib import Path

from physim.drafts import discard, draft_of
from physim.errors import PhysimError

GZIP = b"\x1f\x8b"
"""How a compressed file begins."""


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


def write_text(path: Path, text: str) -> None:
    """Put ``text`` (UTF-8) into a file, whole or not at all; PhysimError when that fails.

    One that is replaced leaves its permissions.
    """
    draft = draft_of(path)
    try:
        draft.write_text(text, encoding="utf-8", newline="\n")
        with suppress(FileNotFoundError):
            draft.chmod(stat.S_IMODE(path.stat().st_mode))
        draft.replace(path)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise PhysimError(f"{path}: cannot be written: {reason}") from error
    finally:  # of an error or Ctrl-C nothing is left
        discard(draft)
