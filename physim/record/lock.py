"""One writer a file: a lock that a writer holds from before it begins until it has ended.

The lock is on an empty file beside the record, ``.NAME.lock``, not on the record itself, which
others may read meanwhile: HDF5 locks what it reads. It ends with the process, however that ends; of
one that was killed the empty file is left, which the next writer takes over and removes.
"""

from __future__ import annotations

import fcntl
import os
from contextlib import suppress
from pathlib import Path

from physim.errors import RecordError

_HOW = os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW


class WriteLock:
    """Holds the right to write a file; `release` it in the end."""

    def __init__(self, path: Path) -> None:
        """Take it. Raises RecordError where another writer has it; OSError as for any file.

        Where the file system knows no locks nothing is held, and nobody refused.
        """
        self._path = _beside(path).absolute()  # the run may go to another folder
        self._fd = -1
        while not is_at(self._fd, self._path):  # who had it before may just have removed the file
            self._close()
            self._fd = os.open(self._path, _HOW | os.O_CREAT, 0o666)
            try:
                _take(self._fd, path)
            except BaseException:
                self._close()
                raise

    def __enter__(self) -> WriteLock:
        """Hold it in a ``with`` block."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Release it."""
        self.release()

    def release(self) -> None:
        """Let others write; once is enough."""
        with suppress(OSError):
            if is_at(self._fd, self._path):
                self._path.unlink()
            fcntl.flock(self._fd, fcntl.LOCK_UN)  # a fork that goes on has it, too
        self._close()

    def _close(self) -> None:
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1


def check_unwritten(path: Path) -> None:
    """Raise RecordError where somebody is writing a file now."""
    try:
        fd = os.open(_beside(path), _HOW)
    except OSError:
        return
    try:
        _take(fd, path)
    finally:
        os.close(fd)


def is_at(fd: int, path: Path) -> bool:
    """Whether an open file is still the one that has the name."""
    try:
        return os.path.samestat(os.fstat(fd), os.stat(path))
    except OSError:
        return False


def _beside(path: Path) -> Path:
    return path.with_name(f".{path.name}.lock")


def _take(fd: int, path: Path) -> None:
    try:
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise RecordError(
            f"{path}: another run is writing it; wait until that has ended, or write elsewhere"
        ) from None
    except OSError:
        return  # this file system knows no locks


__all__ = ["WriteLock", "check_unwritten", "is_at"]
