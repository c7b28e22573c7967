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
        keys = [_codes(table[name]) for name in CELL]
        seed = table["seed"].to_numpy()
        order = np.lexsort((seed, *(codes for codes, _ in reversed(keys))))
        self.table: pa.Table = table.take(order)
        self.seed: NDArray[np.int64] = seed[order]
        self.cells = _cells([(codes[order], words) for codes, words in keys])

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
    def ended(self) -> tuple[NDArray[np.int64], list[str]]:
        """How each run ended: a code, and the words by code."""
        return _codes(self.table["ended"])

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
        codes, known = self.ended
        return np.isin(codes, [k for k, word in enumerate(known) if word in words])


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


def _codes(column: Any) -> tuple[NDArray[np.int64], list[str]]:
    """Strings as numbers (K,) in the order of the words, and the words, sorted."""
    encoded = column.combine_chunks().dictionary_encode()
    words = [word or "" for word in encoded.dictionary.to_pylist()]
    rank = np.empty(len(words) + 1, np.int64)
    rank[np.argsort(np.array(words, object), kind="stable")] = np.arange(len(words))
    rank[-1] = -1
    codes = encoded.indices.fill_null(len(words)).to_numpy(zero_copy_only=False)
    return rank[codes], sorted(words)


def _cells(keys: list[tuple[NDArray[np.int64], list[str]]]) -> tuple[Cell, ...]:
    """Cells of rows that are sorted by their keys."""
    codes = np.stack([codes for codes, _ in keys])
    count = codes.shape[1]
    if not count:
        return ()
    starts = [0, *(1 + np.flatnonzero(np.any(np.diff(codes, axis=1), axis=0))).tolist()]
    found = []
    for start, stop in zip(starts, [*starts[1:], count], strict=True):
        at = codes[:, start]
        names = [known[k] if k >= 0 else "" for (_, known), k in zip(keys, at, strict=True)]
        found.append(Cell(names[0], names[1], names[2], start, stop))
    return tuple(found)
