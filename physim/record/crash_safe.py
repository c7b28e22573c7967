"""A file that stays readable when the process that writes it is killed at any moment.

HDF5 changes its index in place, in many small writes; a process killed between two of them leaves
a file that does not open, or opens with data missing. `CrashSafeFile` stands between the library
and the disk and orders the writes, so that at every moment the file is a complete one:

1. What is new lies beyond the end that the committed index knows of, or in rows beyond its row
   counts: nobody reads it yet, so it is written at once.
2. What changes the index is held back in memory while the library flushes, then `commit` writes
   it in an order in which every prefix is valid: the superblock (the file is longer), then the
   nodes of the chunk trees, parents first (more chunks), then object headers (more rows).
3. A block of the index that lies in one page goes to disk in one write, which a signal does not
   split. One that crosses pages is written last page first: trees and headers only ever gain
   entries, and what counts the entries stands before them.

The file appears under its name with its first commit, and nobody else may write it until it is
closed (`WriteLock`). Against loss of power nothing is done.
"""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from physim.files import discard, draft_of
from physim.record.lock import WriteLock, is_at

PAGE = 4096
"""[bytes] What the system writes without a break; the library aligns larger blocks to it."""
_SUPERBLOCK = 0
_TREE = b"TREE"


class CrashSafeFile(io.RawIOBase):
    """File object for ``h5py.File(file, "w", libver="earliest")``; created anew, for writing.

    Set ``holding`` while the library flushes or closes, then call `commit`, which raises OSError
    when anything since the last one could not be written; the file then stays as it was. So it does
    where somebody has moved, removed or replaced the file meanwhile.
    """

    def __init__(self, path: Path) -> None:
        """Begin a new file that takes the place of ``path`` at the first commit.

        Raises RecordError where another writer is at it, OSError where it cannot be written.
        """
        super().__init__()
        self.holding = False
        self._failure: OSError | None = None
        self._path = path.absolute()  # the run may go to another folder
        self._draft: Path | None = draft_of(self._path)
        self._lock = WriteLock(path)
        try:
            self._fd = os.open(self._draft, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o666)
        except BaseException:
            self._lock.close()
            raise
        self._position = 0
        self._length = 0
        self._committed = 0
        self._held: dict[int, bytes] = {}
        self._index: set[int] = set()
        """addresses of the committed blocks of the index"""

    def commit(self) -> None:
        """Make the last flush of the library what a reader finds."""
        self.holding = False
        if self._draft is None and not is_at(self._fd, self._path):
            self._failure = self._failure or OSError(errno.ESTALE, "it is no longer there")
        if self._failure is None:
            with self._noting_failure():
                for address, block in sorted(self._held.items(), key=self._rank):
                    _write_last_page_first(self._fd, block, address)
        if self._failure is not None:
            raise self._failure
        self._index.update(self._held)
        self._held.clear()
        if os.fstat(self._fd).st_size != self._length:
            os.ftruncate(self._fd, self._length)
        self._committed = self._length
        if self._draft is not None:
            os.replace(self._draft, self._path)
            self._draft = None

    def close(self) -> None:
        """Close the file; without any commit nothing is left of it."""
        if not self.closed:
            os.close(self._fd)
            if self._draft is not None:
                discard(self._draft)
            self._lock.close()
        super().close()

    # What h5py asks of a file object:

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place [bytes]."""
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self._position, os.SEEK_END: self._length}[whence]
        self._position = base + offset
        return self._position

    def write(self, data: Any) -> int:
        """Write at the present place, at once or with the next commit."""
        address, size = self._position, len(data)
        is_held = self.holding and address < self._committed
        if self._failure is None and not is_held:
            with self._noting_failure():
                _write_all(self._fd, memoryview(data), address)
        if is_held or self._failure is not None:  # after a failure to be read back until the end
            before = self._held.pop(address, b"")
            self._held[address] = bytes(data) + before[size:]
        elif self.holding:
            self._index.add(address)
        self._position += size
        self._length = max(self._length, self._position)
        return size

    def readinto(self, buffer: Any) -> int:
        """Read from the present place, held blocks included."""
        view = memoryview(buffer).cast("B")
        start, size = self._position, len(view)
        data = os.pread(self._fd, size, start)
        view[: len(data)] = data
        view[len(data) :] = bytes(size - len(data))  # the disk was full: nothing is there yet
        for address, block in self._held.items():
            first, last = max(address, start), min(address + len(block), start + size)
            if first < last:
                view[first - start : last - start] = block[first - address : last - address]
        self._position += size
        return size

    def truncate(self, size: int | None = None) -> int:
        """Set the length [bytes]: longer at once, shorter with the next commit."""
        self._length = self._position if size is None else size
        if self._length > os.fstat(self._fd).st_size:
            with self._noting_failure():
                os.ftruncate(self._fd, self._length)
        return self._length

    @contextmanager
    def _noting_failure(self) -> Iterator[None]:
        """Keep a failure of the disk for `commit`: the library would be left half-way by it."""
        try:
            yield
        except OSError as error:
            self._failure = self._failure or error

    def _rank(self, item: tuple[int, bytes]) -> tuple[int, int, int]:
        """Order of the held blocks, see the module's text; byte 5 of a tree node is its level."""
        address, block = item
        if address not in self._index:
            return 0, 0, address  # new, in a gap: nothing refers to it yet
        if address == _SUPERBLOCK:
            return 1, 0, 0
        if block.startswith(_TREE):
            return 2, -block[5], address
        return 3, 0, address


def _write_last_page_first(fd: int, block: bytes, address: int) -> None:
    end = address + len(block)
    while end > address:
        start = max(address, (end - 1) // PAGE * PAGE)
        _write_all(fd, memoryview(block)[start - address : end - address], start)
        end = start


def _write_all(fd: int, data: memoryview, address: int) -> None:
    data = data.cast("B")
    while len(data):
        written = os.pwrite(fd, data, address)
        data, address = data[written:], address + written
