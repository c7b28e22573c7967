"""The rows of a campaign as arrays, cell by cell: a cell is a world, settings and a controller."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.campaigns.folder import Asked
from physim.campaigns.rows import DONE, FINISHED, PREFIX, columns_of
from physim.campaigns.spec import Label

if TYPE_CHECKING:
    import pyarrow as pa

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
    """All rows of a campaign, sorted by cell and seed, each column as an array (K,)."""

    def __init__(self, table: pa.Table) -> None:
        self.table = table.sort_by([(name, "ascending") for name in (*CELL, "seed")])
        self.seed: NDArray[np.int64] = self.table["seed"].to_numpy()
        groups = self.table.group_by(list(CELL), use_threads=False).aggregate([("seed", "count")])
        found, start = [], 0
        for one in groups.to_pylist():
            stop = start + one["seed_count"]
            found.append(Cell(one["world"], one["settings"], one["controller"], start, stop))
            start = stop
        self.cells = tuple(found)

    def __len__(self) -> int:
        """Number of runs."""
        return len(self.seed)

    def column(self, name: str) -> FloatArray:
        """A column of numbers; nan where it has no meaning, and of a metric that no row has."""
        if name.startswith(PREFIX) and name not in self.own:
            return np.full(len(self), np.nan)
        return np.asarray(self.table[name].to_numpy(), float)

    @property
    def own(self) -> list[str]:
        """Columns of metrics that packages registered."""
        return columns_of(self.table)

    def row(self, index: int) -> dict[str, Any]:
        """One row by names of columns."""
        found: dict[str, Any] = self.table.slice(index, 1).to_pylist()[0]
        return found

    @cached_property
    def ended(self) -> NDArray[np.object_]:
        """How each run ended."""
        return np.array(self.table["ended"].to_pylist(), object)

    @cached_property
    def failed(self) -> BoolArray:
        """Runs that did not come to an end of their own: error, timeout, killed, interrupted."""
        return ~self._ended_in(*DONE)

    @cached_property
    def touched(self) -> BoolArray:
        """Runs with any contact, between robots or with walls, at samples or between them."""
        return np.asarray((self.column("contacts") > 0) | (self.column("grazes") > 0))

    @cached_property
    def contact_free(self) -> BoolArray:
        """Runs without any contact that came to their end."""
        none = (self.column("contacts") == 0) & (self.column("grazes") == 0)
        return np.asarray(none & ~self.failed)

    @cached_property
    def finished(self) -> BoolArray:
        """Runs in which all robots arrived."""
        return self._ended_in(FINISHED)

    @cached_property
    def unfinished(self) -> BoolArray:
        """Runs whose time was up before all robots had arrived."""
        return self._ended_in("duration")

    @cached_property
    def rate(self) -> BoolArray:
        """Runs that were contact-free and finished."""
        return self.contact_free & self.finished

    def successes(self, rate: str) -> BoolArray:
        """Runs that count as successes for ``rate``, ``contact_free`` or ``finished``."""
        found: BoolArray = getattr(self, rate)
        return found

    def _ended_in(self, *words: str) -> BoolArray:
        return np.asarray(np.any([self.ended == word for word in words], axis=0))


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
