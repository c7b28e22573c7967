"""What is worked out once for all robots that share a footprint or a path."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from physim.geometry.shapes import FloatArray

Found = TypeVar("Found")


class Shared(Generic[Found]):
    """A function of an array, called once for the robots that hold the very same array.

    A layout gives robots of equal outlines one array, and likewise robots of equal paths.
    """

    def __init__(self, work_out: Callable[[FloatArray], Found]) -> None:
        self._work_out = work_out
        self._known: dict[int, tuple[FloatArray, Found]] = {}

    def __call__(self, array: FloatArray) -> Found:
        """What is known of the array, which is kept, so that no other can have its identity."""
        if id(array) not in self._known:
            self._known[id(array)] = array, self._work_out(array)
        return self._known[id(array)][1]
