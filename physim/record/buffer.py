"""Rows on their way to a growing dataset: gathered in memory, written in bursts."""

from __future__ import annotations

from typing import Any

import h5py
import numpy as np
from numpy.typing import ArrayLike, NDArray


class RowBuffer:
    """Gathers rows of one growing dataset; `flush` appends them all at once."""

    def __init__(self, dataset: h5py.Dataset, rows: int) -> None:
        """Keep up to ``rows`` rows (at least one) in memory."""
        self.dataset = dataset
        self._rows: NDArray[Any] = np.empty((max(1, rows), *dataset.shape[1:]), dataset.dtype)
        self._count = 0
        self._written = 0

    def append(self, rows: ArrayLike) -> None:
        """Take rows of the dataset's type; goes to the file when the memory is full.

        Raises ValueError for rows of another shape.
        """
        given = np.asarray(rows, dtype=self._rows.dtype)
        if given.shape[1:] != self._rows.shape[1:]:
            wanted = self._rows.shape[1:]
            raise ValueError(f"{self.dataset.name}: rows {given.shape[1:]}; {wanted} expected")
        taken = 0
        while taken < len(given):
            part = given[taken : taken + len(self._rows) - self._count]
            self._rows[self._count : self._count + len(part)] = part
            self._count += len(part)
            taken += len(part)
            if self._count == len(self._rows):
                self.flush()

    def flush(self) -> None:
        """Hand what was gathered to the library."""
        if self._count:
            total = self._written + self._count
            self.dataset.resize(total, axis=0)
            self.dataset[self._written : total] = self._rows[: self._count]
            self._written, self._count = total, 0
