"""Rows of the datasets of a record file, checked as they are read."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray
from physim.record import layout
from physim.record.checks import damaged
from physim.record.values import (
    Bounds,
    check_arrived,
    check_extremes,
    check_points,
    check_start,
    check_steps,
    check_table,
)

NO_END = int(np.iinfo(np.int64).max)
"""Last step of a run that was killed: its tables are cut off instead."""


class Rows:
    """Datasets of an open record file, read a piece at a time.

    ``where`` names the file in messages, ``samples`` is how many rows the samples have.
    """

    def __init__(self, file: h5py.File, where: str, bounds: Bounds, samples: int) -> None:
        self._file, self._where, self._bounds, self._samples = file, where, bounds, samples
        self._killed_at: int | None = None

    def cut_tables(self) -> int:
        """End tables with the last sample, as in a run that was killed; its step, -1 without any.

        Raises RecordError when the steps cannot be read.
        """
        steps = self.read("/steps/step")
        self._killed_at = int(steps[-1]) if len(steps) else -1
        return self._killed_at

    def read(
        self, path: str, first: int = 0, last: int | None = None, *, check: bool = True
    ) -> NDArray[Any]:
        """Rows ``first`` to ``last - 1`` of a dataset, read-only; see `Record.read`."""
        try:
            dataset = self._file[path]
            if dataset.ndim == 0:
                row = np.asarray(dataset[()], dtype=dataset.dtype)
                return frozen(self._checked(path, row, 0) if check else row)
            if path in layout.STEPS:
                last = self._samples if last is None else min(last, self._samples)
            rows = np.asarray(dataset[first:last])
        except (OSError, RuntimeError, KeyError, ValueError) as error:
            raise damaged(self._where, path, error) from error
        if path in layout.TABLES and self._killed_at is not None:
            rows = rows[rows["step"] <= self._killed_at]
        return frozen(self._checked(path, rows, first) if check else rows)

    def runs(self, group: str, runs: int | None = None) -> list[FloatArray]:
        """Polylines or rings of a packed group; ``runs`` of them, if that is known."""
        points, start = self.read(f"{group}/points"), self.read(f"{group}/start")
        check_points(f"{group}/points", points, self._where)
        check_start(
            f"{group}/start", start, len(points), self._where, empty=runs is None, runs=runs
        )
        return [points[first:last] for first, last in pairwise(start)]

    def parts(self, group: str) -> tuple[FloatArray, ...]:
        """Polygons of a group, one dataset each, by number."""
        found = []
        for part in sorted(self._file[group], key=int):
            path = f"{group}/{part}"
            found.append(self.read(path))
            check_points(path, found[-1], self._where)
        return tuple(found)

    def _checked(self, path: str, rows: NDArray[Any], first: int) -> NDArray[Any]:
        """Rows as they are, when their values are such as a run writes."""
        if path in layout.STEPS:
            check_steps(path, rows, self._where, first)
        elif path in layout.TABLES:
            check_table(path, rows, self._bounds, self._where, first)
        elif path in (layout.EXTREMES, layout.EXTREMES_FARTHEST):
            check_extremes(path, rows, self._bounds, self._where)
        elif path == layout.ARRIVED:
            check_arrived(rows, self._bounds, self._where)
        return rows


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Make an array read-only and return it."""
    array.flags.writeable = False
    return array
