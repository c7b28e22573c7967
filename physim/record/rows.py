"""Rows of the datasets of a record file, checked as they are read."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from physim.errors import RecordError
from physim.geometry.shapes import FloatArray
from physim.record import layout
from physim.record.checks import damaged
from physim.record.row_checks import (
    STATIONS,
    Bounds,
    Source,
    check_extremes,
    check_finite,
    check_points,
    check_starts,
    check_steps,
    check_table,
)

NO_END = int(np.iinfo(np.int64).max)
"""Last step of a run that was killed: its tables are cut off instead."""


class RecordFile:
    """Datasets of an open record file, read a piece at a time.

    ``where`` names the file in messages, ``samples`` is how many rows the samples have.
    """

    def __init__(self, file: h5py.File, where: str, bounds: Bounds, samples: int) -> None:
        self._handle, self.where, self._bounds = file, where, bounds
        self.samples, self.robots = samples, bounds.robots
        self._killed_at: int | None = None

    @property
    def _file(self) -> h5py.File:
        """The open file. Raises RecordError where the record was closed."""
        if not self._handle:
            raise RecordError(
                f"{self.where}: the record was closed, so that nothing more is read of it; read "
                "before the end of its with block, or load it again"
            )
        return self._handle

    def _cut_tables(self) -> int:
        """End tables with the last sample, as in a run that was killed; its step, -1 without any.

        Raises RecordError when the steps cannot be read.
        """
        steps = self.read("/steps/step")
        self._killed_at = int(steps[-1]) if len(steps) else -1
        return self._killed_at

    def read(
        self, path: str, first: int = 0, last: int | None = None, *, check: bool = True
    ) -> NDArray[Any]:
        """Rows ``first`` to ``last - 1`` of a dataset, read-only, without keeping them.

        Raises RecordError when they cannot be read, and, with ``check``, for values that no run
        writes.
        """
        try:
            dataset = self._file[path]
            if path in layout.STEPS:
                last = self.samples if last is None else min(last, self.samples)
            rows = np.asarray(dataset[first:last] if dataset.ndim else dataset[()], dataset.dtype)
        except (OSError, RuntimeError, KeyError, ValueError, MemoryError) as error:
            raise damaged(self.where, path, error) from error
        if self._killed_at is not None:
            rows = self._cut(path, first, rows)
        if check:
            self._check(Source(self.where, path, first), rows)
        return frozen(rows)

    def _cut(self, path: str, first: int, rows: NDArray[Any]) -> NDArray[Any]:
        """Rows, from row ``first`` on, up to the last sample of a run that was killed."""
        if path in layout.TABLES:
            rows = rows[rows["step"] <= self._killed_at]
            if path == "/considered":  # what a decision counts may not have been written
                before = int(self._file[path][:first]["count"].sum(dtype=np.int64)) if first else 0
                counted = before + np.cumsum(rows["count"], dtype=np.int64)
                rows = rows[counted <= self._file[layout.OTHERS].size]
            return rows
        if path == layout.OTHERS:
            counted = self.read("/considered", check=False)["count"].sum(dtype=np.int64)
            return rows[: max(0, counted - first)]
        return rows

    def _check(self, source: Source, rows: NDArray[Any]) -> None:
        """Check that rows have values such as a run writes."""
        if source.path in layout.STEPS:
            check_steps(source, rows, self._bounds.every)
        elif source.path in layout.TABLES:
            check_table(source, rows, self._bounds)
        elif source.path in (layout.EXTREMES, layout.EXTREMES_FARTHEST):
            check_extremes(source, rows, self._bounds)
        elif source.path in STATIONS:
            check_finite(source, "it", rows)
        elif source.path == layout.ARRIVED:
            source.within("it", rows, -1, self._bounds.last_step)

    def _points(self, path: str) -> FloatArray:
        """Points (n, 2) [m] of a dataset."""
        points = self.read(path)
        check_points(Source(self.where, path), points)
        return points

    def _starts(
        self, path: str, whole: int, *, empty: bool = True, runs: int | None = None
    ) -> NDArray[Any]:
        """Starts of packed runs, see `check_starts`."""
        start = self.read(path)
        check_starts(Source(self.where, path), start, whole, empty=empty, runs=runs)
        return start

    def _runs(self, group: str, fewest: int, runs: int | None = None) -> list[FloatArray]:
        """Polylines or rings of a packed group, each of ``fewest`` points or more; ``runs`` of
        them, if that is known."""
        points = self._points(f"{group}/points")
        start = self._starts(f"{group}/start", len(points), runs=runs)
        found = np.diff(start)
        Source(self.where, f"{group}/start").refuse(
            found < fewest, lambda k: f"{found[k]} points; {fewest} are needed"
        )
        return [points[first:last] for first, last in pairwise(start)]


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Make an array read-only and return it."""
    array.flags.writeable = False
    return array
