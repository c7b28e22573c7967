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


class WriteLock:
    """Holds the right to write a file; `close` it in the end."""

    def __init__(self, path: Path) -> None:
        """Take it. Raises RecordError where another writer has it; OSError as for any file.

        Where the file system knows no locks nothing is held, and nobody refused.
        """
        self._path = _beside(path).absolute()  # the run may go to another folder
        self._fd = _taken(path, os.O_CREAT)
        while not is_at(self._fd, self._path):  # who had it before may just have removed the file
            os.close(self._fd)
            self._fd = _taken(path, os.O_CREAT)

    def close(self) -> None:
        """Let others write."""
        with suppress(OSError):
            if is_at(self._fd, self._path):
                self._path.unlink()
            fcntl.flock(self._fd, fcntl.LOCK_UN)  # a fork that goes on has it, too
        os.close(self._fd)


def check_unwritten(path: Path) -> None:
    """Raise RecordError where somebody is writing a file now."""
    with suppress(OSError):
        os.close(_taken(path))


def is_at(fd: int, path: Path) -> bool:
    """Whether an open file is still the one that has the name."""
    try:
        return os.path.samestat(os.fstat(fd), os.stat(path))
    except OSError:
        return False


def _beside(path: Path) -> Path:
    return path.with_name(f".{path.name}.lock")


def _taken(path: Path, create: int = 0) -> int:
    """The file beside another, open and locked; see `WriteLock`."""
    fd = os.open(_beside(path), os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW | create, 0o666)
    try:
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(fd)
        raise RecordError(
            f"{path}: another run is writing it; wait until that has ended, or write elsewhere"
        ) from None
    except OSError:
        pass  # this file system knows no locks
    return fd
