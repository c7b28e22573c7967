"""Which seeds a campaign was asked for: what it has no rows of is told, not taken for done."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from physim.campaigns.spec import Label

if TYPE_CHECKING:
    from physim.campaigns.outcomes import Outcomes

Asked = Mapping[Label, tuple[range, ...]]
"""Seeds of each cell, in ranges that neither touch nor overlap, in ascending order"""
MOST_RANGES = 1_000


class Missing(NamedTuple):
    """Runs of a cell that were asked for and have no row."""

    cell: Label
    runs: int
    of: int
    """how many were asked for"""


def merged(ranges: Iterable[range]) -> tuple[range, ...]:
    """Ranges of step 1 as few as they can be, in ascending order; empty ones are left out."""
    found: list[range] = []
    for one in sorted((one for one in ranges if one), key=lambda one: one.start):
        if found and one.start <= found[-1].stop:
            found[-1] = range(found[-1].start, max(found[-1].stop, one.stop))
        else:
            found.append(one)
    return tuple(found)


def ranges_of(value: Any) -> tuple[range, ...]:
    """Ranges as they stand in a file, ``[[0, 100], [200, 300]]``. Raises ValueError."""
    if not isinstance(value, list) or len(value) > MOST_RANGES:
        raise ValueError(f"seeds: must be a list of at most {MOST_RANGES:,} ranges")
    for one in value:
        if not isinstance(one, list) or len(one) != 2 or not all(map(_is_seed, one)):
            raise ValueError("seeds: each must be [first, end], whole numbers from 0 to 2^63")
    return merged(range(first, end) for first, end in value)


def missing(asked: Asked, outcomes: Outcomes) -> tuple[Missing, ...]:
    """Cells that lack rows, in the order in which they were asked for."""
    there = {cell.names: outcomes.seed[cell.rows] for cell in outcomes.cells}
    found = []
    for label, ranges in asked.items():
        seeds: Any = there.get(label, np.zeros(0, np.int64))
        of = sum(one.stop - one.start for one in ranges)
        have = sum(_within(seeds, one) for one in ranges)
        if have < of:
            found.append(Missing(label, of - have, of))
    return tuple(found)


def _is_seed(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= 2**63


def _within(seeds: np.ndarray, one: range) -> int:
    """How many of ascending seeds, none twice, are in a range."""
    first, end = np.searchsorted(seeds, [one.start, one.stop - 1], side="left")
    return int(end - first) + bool(end < len(seeds) and seeds[end] == one.stop - 1)


def as_stored(ranges: Sequence[range]) -> list[list[int]]:
    """Ranges as `ranges_of` reads them."""
    return [[one.start, one.stop] for one in ranges]


__all__ = ["Asked", "Missing", "as_stored", "merged", "missing", "ranges_of"]
