"""One writer a file: a lock that a writer holds from before it begins until it has ended.

The lock is on an empty file beside the record, ``.NAME.lock``, not on the record itself, which
others may read meanwhile: HDF5 locks what it reads. It ends with the process, however that ends; of
one that was killed the empty file is left, which the next writer takes over and removes.
"""

from __future__ import annotations

import errno
import fcntl
import os
from contextlib import suppress
from pathlib import Path

from physim.errors import RecordError


class WriteLock:
    """Holds the right to write a file; `release` it in the end."""

    def __init__(self, path: Path) -> None:
        """Take it; OSError as for any file.

        Raises RecordError where another writer has it, and where its name is that of a link.

        Where the file system knows no locks nothing is held, and nobody refused.
        """
        beside = _beside(path)
        self._path = beside.absolute()  # the run may go to another folder
        while True:
            self._fd = _opened(beside, os.O_CREAT)
            try:
                _take(self._fd, path)
                if self._is_there():
                    return
            except BaseException:
                os.close(self._fd)
                raise
            os.close(self._fd)  # who had it before has just removed the file: take a new one

    def release(self) -> None:
        """Let others write; once is enough."""
        if self._fd >= 0:
            if self._is_there():
                with suppress(OSError):
                    self._path.unlink()
            with suppress(OSError):
                fcntl.flock(self._fd, fcntl.LOCK_UN)  # a fork that goes on has it, too
            os.close(self._fd)
            self._fd = -1

    def _is_there(self) -> bool:
        return is_at(self._fd, self._path)


def check_unwritten(path: Path) -> None:
    """Raise RecordError where somebody is writing a file now."""
    try:
        fd = _opened(_beside(path))
    except OSError:
        return
    try:
        _take(fd, path)
    finally:
        os.close(fd)


def _opened(lock: Path, how: int = 0) -> int:
    """Descriptor of the file of a lock, for more by ``how``.

    Raises RecordError for a link, which may lead anywhere; OSError as for any file.
    """
    try:
        return os.open(lock, os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW | how, 0o666)
    except OSError as error:
        if error.errno != errno.ELOOP:
            raise
    raise RecordError(f"{lock}: is a symbolic link, where a lock is to be; remove it")


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
