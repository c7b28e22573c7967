"""Is A better than B? Two arms on the same seeds: differences of rates and measures, tested.

A comparison is of two cells that are the same in all but what is compared. What both have in
common, the difficulty of a seed, cancels in the differences of its two runs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from physim.campaigns.measures import RATE_TITLES, USUAL
from physim.campaigns.outcomes import CELL, Cell, FloatArray, Outcomes
from physim.campaigns.rows import PREFIX
from physim.campaigns.spec import Label
from physim.errors import PhysimError
from physim.statistics import holm, median_difference, rate_difference, sign_test

ALPHA = 0.05
FEWEST_PAIRS = 6
"""Pairs from which on a test of two sides can reach `ALPHA`: at best its p is 2 / 2^pairs."""
MOST_PAIRS_OF_CELLS = 200


@dataclass(frozen=True)
class Arm:
    """One side of a comparison: a cell of a campaign, and what it is called."""

    label: str
    outcomes: Outcomes
    cell: Cell
    rows: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    """of the seeds that both arms have, in ascending order"""
    alone: tuple[int, ...] = ()
    """seeds that the other has not, which are left out"""

    @property
    def failed(self) -> int:
        """Of its rows, how many failed."""
        return int(np.count_nonzero(self.outcomes.failed[self.rows]))

    def values(self, name: str) -> FloatArray:
        """A measure of its rows, nan where a run has none; of a rate 1 or 0."""
        if name in RATE_TITLES:
            return self.outcomes.successes(name)[self.rows].astype(float)
        return self.outcomes.column(name)[self.rows]


Pair = tuple[Arm, Arm, str]
"""A, B, and what both are the same in, for people"""


@dataclass(frozen=True)
class Finding:
    """What a comparison says of one rate or measure: with more seeds, which one is better.

    That is what ``p`` is of. How much better is another question: ``difference``, B minus A.
    """

    name: str
    pairs: int
    """seeds that both have, with a value on either side"""
    a: float
    """rate, or median over these pairs"""
    b: float
    difference: float
    """of rates, or the median of the differences: B minus A"""
    low: float
    high: float
    p: float
    only_a: int
    """seeds with which A alone succeeds, or A's value is the better one"""
    only_b: int
    p_corrected: float = 1.0
    """p after the correction for all that is looked at"""

    @property
    def better(self) -> str:
        """``a``, ``b``, or nothing where no difference is shown.

        Shown is one that stays significant after the correction; of a rate, whose interval is of
        the same question, one that leaves out 0 as well.
        """
        if self.p_corrected > ALPHA or (self.is_rate and self.low <= 0.0 <= self.high):
            return ""
        return "b" if self.only_b > self.only_a else "a"

    @property
    def ties(self) -> int:
        """Seeds with which neither is better: the test leaves them out."""
        return self.pairs - self.only_a - self.only_b

    @property
    def is_tested(self) -> bool:
        """Whether there are enough pairs for any outcome of them to show a difference."""
        return self.pairs >= FEWEST_PAIRS

    @property
    def is_rate(self) -> bool:
        """Whether it is of a rate."""
        return self.name in RATE_TITLES


@dataclass(frozen=True)
class Comparison:
    """Two arms, the seeds that both have, and what they say."""

    a: Arm
    b: Arm
    common: str
    """what both are the same in, for people"""
    findings: tuple[Finding, ...]
    unlike: tuple[str, ...] = ()
    """in what else A and B differ, though they are called alike; a text each"""

    @property
    def seeds(self) -> int:
        """Number of seeds that both have."""
        return len(self.a.rows)


def by(outcomes: Outcomes, dimension: str, order: Sequence[Label] = ()) -> list[Pair]:
    """All pairs of cells of a campaign that differ in ``dimension`` (one of `CELL`) alone.

    A is the one that comes first in ``order``, cells as they were asked for; others follow by name.
    Raises PhysimError where there is none.
    """
    place = CELL.index(dimension)
    groups: dict[tuple[str, ...], list[Cell]] = {}
    turns = {label: turn for turn, label in enumerate(order)}
    for cell in sorted(outcomes.cells, key=lambda cell: turns.get(cell.names, len(turns))):
        groups.setdefault(_without(cell, [place]), []).append(cell)

    def arm(cell: Cell) -> Arm:
        return Arm(cell.names[place] or "as it is", outcomes, cell)

    found = [
        (arm(one), arm(other), _together(rest))
        for rest, cells in groups.items()
        for one, other in combinations(cells, 2)
    ]
    if not found:
        values = sorted({cell.names[place] for cell in outcomes.cells})
        raise PhysimError(
            f"--by {dimension}: no two cells differ in it alone; given: "
            f"{', '.join(value or 'none' for value in values)}"
        )
    return found


def between(a: Outcomes, b: Outcomes, names: tuple[str, str]) -> list[Pair]:
    """Pairs of cells of two campaigns that are the same in all but what is compared.

    That is what each campaign has a single value of, which is not that of the other. Raises
    PhysimError where no two cells match.
    """
    values = [[{cell.names[k] for cell in side.cells} for side in (a, b)] for k in range(len(CELL))]
    sole = [
        k for k, (one, other) in enumerate(values) if len(one) == len(other) == 1 and one != other
    ]
    matching = {_without(cell, sole): cell for cell in b.cells}

    def arm(campaign: Outcomes, cell: Cell, name: str) -> Arm:
        return Arm(_together([cell.names[k] for k in sole]) or name, campaign, cell)

    found = [
        (arm(a, cell, names[0]), arm(b, matching[rest], names[1]), _together(rest))
        for cell in a.cells
        if (rest := _without(cell, sole)) in matching
    ]
    if not found:
        first, second = ("; ".join(cell.name for cell in side.cells[:3]) for side in (a, b))
        raise PhysimError(
            f"{names[0]}, {names[1]}: no cell of one is like a cell of the other: {first} "
            f"beside {second}"
        )
    return found


def compare(
    arms: Sequence[Pair], names: Mapping[str, int] = USUAL, most: int = MOST_PAIRS_OF_CELLS
) -> list[Comparison]:
    """Compare arms in rates and measures; all p values are corrected together, after Holm.

    Of each of ``names`` it says which is better: 1 where more is, -1 where less is. Findings of
    fewer pairs than `FEWEST_PAIRS`, as of a world in which nothing is random, can show nothing
    whatever they are: they are not tested, and do not count in the correction.

    A rate or measure that no pair has on both sides is left out. Raises PhysimError where two arms
    have no seed in common, for a metric of one's own that no row has, and for more than ``most``
    pairs.
    """
    if len(arms) > most:
        allowed = f"allowed: at most {most}"
        raise PhysimError(f"there are {len(arms)} pairs of cells to compare; {allowed}")
    known = sorted({column for a, b, _ in arms for arm in (a, b) for column in arm.outcomes.own})
    for column in names:
        if column.startswith(PREFIX) and column not in known:
            name, *there = (one.removeprefix(PREFIX) for one in (column, *known))
            raise PhysimError(
                f'no row has a metric "{name}"; rows have {", ".join(there) or "none"}; runs that '
                "were made before it was installed have none"
            )
    made = [_compared(*pair, names) for pair in arms]
    corrected = iter(holm([f.p for one in made for f in one.findings if f.is_tested]))

    def after_holm(found: Finding) -> Finding:
        return replace(found, p_corrected=next(corrected)) if found.is_tested else found

    return [replace(one, findings=tuple(map(after_holm, one.findings))) for one in made]


def _compared(a: Arm, b: Arm, common: str, names: Mapping[str, int]) -> Comparison:
    seeds = [arm.outcomes.seed[arm.cell.rows] for arm in (a, b)]
    both, *places = np.intersect1d(seeds[0], seeds[1], assume_unique=True, return_indices=True)
    if not len(both):
        raise PhysimError(f"{a.cell.name} and {b.cell.name}: have no seed in common")
    a, b = (
        replace(arm, rows=place + arm.cell.start, alone=tuple(np.setdiff1d(mine, both).tolist()))
        for arm, mine, place in zip((a, b), seeds, places, strict=True)
    )
    valued = ((name, better, *pairs(a, b, name)) for name, better in names.items())
    return Comparison(a, b, common, tuple(_finding(*each) for each in valued if len(each[-1])))


def pairs(a: Arm, b: Arm, name: str) -> tuple[FloatArray, FloatArray]:
    """A measure of both arms, pair by pair: pairs that have it on both sides."""
    of_a, of_b = a.values(name), b.values(name)
    known = ~(np.isnan(of_a) | np.isnan(of_b))
    return of_a[known], of_b[known]


def _finding(name: str, better: int, a: FloatArray, b: FloatArray) -> Finding:
    gain = (b - a) * better
    only_a, only_b = int(np.count_nonzero(gain < 0)), int(np.count_nonzero(gain > 0))
    if name in RATE_TITLES:
        low, high = rate_difference(only_b, only_a, len(a))
        a_is, b_is = np.mean(a), np.mean(b)
        shift = (only_b - only_a) / len(a), float(low), float(high)
    else:
        a_is, b_is, shift = np.median(a), np.median(b), median_difference(b - a)
    p = sign_test(only_a, only_b)
    return Finding(name, len(a), float(a_is), float(b_is), *shift, p, only_a, only_b)


def _without(cell: Cell, places: Sequence[int]) -> tuple[str, ...]:
    return tuple("" if k in places else name for k, name in enumerate(cell.names))


def _together(names: Sequence[str]) -> str:
    return ", ".join(filter(None, names))
