"""The rows of a campaign as arrays, cell by cell: a cell is a world, settings and a controller."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.campaigns.folder import Asked
from physim.campaigns.rows import DURATION, FINISHED, PREFIX, Row, own_columns
from physim.campaigns.spec import Label
from physim.geometry.shapes import read_only

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

CELL = ("world", "settings", "controller")


@dataclass(frozen=True)
class Cell:
    """A part of a campaign: rows ``start`` to ``stop`` of its `Outcomes`, by seed."""

    world: str
    settings: str
    controller: str
    start: int
    stop: int

    @property
    def rows(self) -> slice:
        """Its rows."""
        return slice(self.start, self.stop)

    @property
    def count(self) -> int:
        """Number of its runs."""
        return self.stop - self.start

    @property
    def name(self) -> str:
        """``ten_robots, gain=0.1, mode_switching``."""
        return ", ".join(part for part in self.names if part)

    @property
    def names(self) -> tuple[str, str, str]:
        """World, settings, controller."""
        return self.world, self.settings, self.controller


class Outcomes:
    """All rows of a campaign, sorted by cell and seed; columns are arrays (K,)."""

    def __init__(self, rows: Iterable[Row]) -> None:
        self.rows = sorted(rows, key=attrgetter(*CELL, "seed"))
        self.seed: NDArray[np.int64] = np.array([row.seed for row in self.rows], np.int64)
        found, start = [], 0
        for names, group in groupby(self.rows, attrgetter(*CELL)):
            stop = start + sum(1 for _ in group)
            found.append(Cell(*names, start, stop))
            start = stop
        self.cells = tuple(found)
        self._columns: dict[str, FloatArray] = {}

    def __len__(self) -> int:
        """Number of runs."""
        return len(self.rows)

    def column(self, name: str) -> FloatArray:
        """A column of numbers, read-only; nan where it has no meaning, and of a metric that no row
        has."""
        if name not in self._columns:
            own = name.removeprefix(PREFIX)
            values = [
                row.metrics.get(own) if own != name else getattr(row, name) for row in self.rows
            ]
            self._columns[name] = read_only(np.array(values, float))
        return self._columns[name]

    @cached_property
    def own(self) -> list[str]:
        """Columns of metrics that packages registered."""
        return own_columns(self.rows)

    @cached_property
    def keys(self) -> list[str]:
        """Keys of all runs, in their own order."""
        return sorted(row.run for row in self.rows)

    @cached_property
    def failed(self) -> BoolArray:
        """Runs that did not come to an end of their own: error, timeout, killed, interrupted."""
        return np.array([row.failed for row in self.rows], bool)

    @cached_property
    def touched(self) -> BoolArray:
        """Runs with any contact, between robots or with walls, at samples or between them."""
        return np.asarray((self.column("contacts") > 0) | (self.column("grazes") > 0))

    @cached_property
    def contact_free(self) -> BoolArray:
        """Runs without any contact that came to their end."""
        return np.array([row.contact_free for row in self.rows], bool)

    @cached_property
    def finished(self) -> BoolArray:
        """Runs in which all robots arrived."""
        return np.array([row.ended == FINISHED for row in self.rows], bool)

    @cached_property
    def unfinished(self) -> BoolArray:
        """Runs whose time was up before all robots had arrived."""
        return np.array([row.ended == DURATION for row in self.rows], bool)

    @cached_property
    def rate(self) -> BoolArray:
        """Runs that were contact-free and finished."""
        return self.contact_free & self.finished

    def successes(self, rate: str) -> BoolArray:
        """Runs that count as successes for ``rate``, ``contact_free`` or ``finished``."""
        found: BoolArray = getattr(self, rate)
        return found


class Missing(NamedTuple):
    """Runs of a cell that were asked for and have no row."""

    cell: Label
    runs: int
    of: int
    """how many were asked for"""


def missing(asked: Asked, outcomes: Outcomes) -> tuple[Missing, ...]:
    """Cells that lack rows, in the order in which they were asked for."""
    there = {cell.names: outcomes.seed[cell.rows] for cell in outcomes.cells}
    found = []
    for label, ranges in asked.items():
        seeds: Any = there.get(label, np.zeros(0, np.int64))
        of = sum(one.stop - one.start for one in ranges)
        have = sum(np.count_nonzero((seeds >= r.start) & (seeds < r.stop)) for r in ranges)
        if have < of:
            found.append(Missing(label, of - int(have), of))
    return tuple(found)
