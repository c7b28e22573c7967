"""Memory of the engine's library, as the compiled guard hands it over and reads it."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from pymunk._chipmunk_cffi import ffi, lib

from physim.geometry.shapes import IntArray


class Pile:
    """Numbers that callbacks append, in an array of the engine's library that grows as needed."""

    def __init__(self, columns: int) -> None:
        self._array = ffi.gc(lib.pmIntArrayNew(64 * columns), lib.pmIntArrayFree)
        self._columns = columns
        self._seen: Any = None
        self._view: IntArray = np.zeros((0, columns), dtype=np.int64)
        self.address = address(self._array)

    def take(self) -> IntArray | None:
        """Return the rows since the last call, a copy; None where there are none."""
        count = self._array.num
        if not count:
            return None
        self._array.num = 0
        if self._array.arr != self._seen or count > self._view.size:
            self._seen = self._array.arr
            whole = self._array.max // self._columns * self._columns
            memory = ffi.buffer(self._seen, 8 * whole)
            self._view = np.frombuffer(memory, np.int64).reshape(-1, self._columns)
        return self._view[: count // self._columns].copy()


def address(pointed: Any) -> int:
    """Number of a pointer of the engine's library."""
    return int(ffi.cast("intptr_t", pointed))


@functools.cache
def layout_is_known() -> bool:
    """Whether structures of the engine are laid out as the callbacks write and read them."""
    points = ffi.typeof("cpContactPointSet")
    one = dict(dict(points.fields)["points"].type.item.fields)
    places = [
        (dict(points.fields)[name].offset, at)
        for name, at in (("count", 0), ("normal", 8), ("points", 24))
    ]
    places += [(one[name].offset, at) for name, at in (("pointA", 0), ("pointB", 16))]
    places += [(ffi.offsetof("pmIntArray", "num"), 0), (ffi.offsetof("pmFloatArray", "num"), 0)]
    sizes = [
        ("void *", 8),
        ("cpFloat", 8),
        ("uintptr_t", 8),
        ("int", 4),
        ("cpContactPointSet", 104),
    ]
    return all(found == at for found, at in places) and all(
        ffi.sizeof(name) == size for name, size in sizes
    )
