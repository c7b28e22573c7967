"""Is A better than B? Two arms on the same seeds: differences of rates and measures, tested.

A comparison is of two cells that are the same in all but what is compared. What both have in
common, the difficulty of a seed, cancels in the differences of its two runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from physim.campaigns.outcomes import CELL, Cell, FloatArray, Outcomes
from physim.campaigns.own_metrics import PREFIX
from physim.campaigns.spec import Label
from physim.errors import PhysimError
from physim.statistics import (
    RATES,
    holm,
    mcnemar,
    median_difference,
    rate_difference,
    sign_test,
)

ALPHA = 0.05
FEWEST_PAIRS = 6
"""Pairs from which on a test of two sides can reach `ALPHA`: at best its p is 2 / 2^pairs."""
MEASURES = {
    "least_distance": 1,
    "shortest_distance": 1,
    "shortest_boundary_distance": 1,
    "closing_speed": -1,
    "energy_lost": -1,
    "impulse": -1,
    "shortest_collision_time": 1,
    "time_to_finish": -1,
    "deviation_peak": -1,
    "formation_error_peak": -1,
    "danger_share": -1,
    "messages": -1,
    "cpu_seconds": -1,
}
"""Columns that can be compared: 1 where more is better, -1 where less is."""
DIRECTIONS = dict.fromkeys(RATES, 1) | MEASURES
USUAL = (*RATES, "least_distance", "time_to_finish", "deviation_peak", "formation_error_peak")
"""What is compared where nothing else is asked for."""
MOST_PAIRS_OF_CELLS = 200


@dataclass(frozen=True)
class Arm:
    """One side of a comparison: a cell of a campaign, and what it is called."""

    label: str
    outcomes: Outcomes
    cell: Cell


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
    direction: int = 1
    """1 where more is better, -1 where less is"""
    corrected: float = 1.0
    """p after the correction for all that is looked at"""

    @property
    def better(self) -> str:
        """``a``, ``b``, or nothing where no difference is shown.

        Shown is one that stays significant after the correction; of a rate, whose interval is of
        the same question, one that leaves out 0 as well.
        """
        if self.corrected > ALPHA or (self.is_rate and self.low <= 0.0 <= self.high):
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
        return self.name in RATES


@dataclass(frozen=True)
class Comparison:
    """Two arms, the seeds that both have, and what they say."""

    a: Arm
    b: Arm
    common: str
    """what both are the same in, for people"""
    seeds: int
    only_a: tuple[int, ...]
    """seeds that A alone has, which are left out"""
    only_b: tuple[int, ...]
    failed_a: int
    """of the common seeds, runs that failed"""
    failed_b: int
    findings: tuple[Finding, ...]
    rows: tuple[NDArray[np.int64], NDArray[np.int64]]
    """rows of the common seeds, in A's and B's outcomes"""
    unlike: tuple[str, ...] = ()
    """in what else A and B differ, though they are called alike; a text each"""

    def values(self, name: str) -> tuple[FloatArray, FloatArray]:
        """A measure of both arms, pair by pair; nan where a run has none."""
        a, b = self.rows
        return self.a.outcomes.column(name)[a], self.b.outcomes.column(name)[b]


def by(
    outcomes: Outcomes, dimension: str, order: Sequence[Label] = ()
) -> list[tuple[Arm, Arm, str]]:
    """All pairs of cells of a campaign that differ in ``dimension`` (one of `CELL`) alone.

    A is the one that comes first in ``order``, cells as they were asked for; others follow by name.
    Raises PhysimError where there is none, or more than can be looked at.
    """
    place = CELL.index(dimension)
    groups: dict[tuple[str, ...], list[Cell]] = {}
    turns = {label: turn for turn, label in enumerate(order)}
    for cell in sorted(outcomes.cells, key=lambda cell: turns.get(cell.names, len(turns))):
        rest = tuple(name for k, name in enumerate(cell.names) if k != place)
        groups.setdefault(rest, []).append(cell)
    found = [
        (_arm(outcomes, one, place), _arm(outcomes, other, place), _common(rest))
        for rest, cells in groups.items()
        for one, other in combinations(cells, 2)
    ]
    if not found:
        values = sorted({cell.names[place] for cell in outcomes.cells})
        raise PhysimError(
            f"--by {dimension}: no two cells differ in it alone; given: "
            f"{', '.join(value or 'none' for value in values)}"
        )
    return _not_too_many(found)


def between(a: Outcomes, b: Outcomes, names: tuple[str, str]) -> list[tuple[Arm, Arm, str]]:
    """Pairs of cells of two campaigns that are the same in all but what is compared.

    That is what each campaign has a single value of, which is not that of the other. Raises
    PhysimError where no two cells match.
    """
    sole = [
        len(values := {c.names[k] for c in a.cells}) == 1
        and len(others := {c.names[k] for c in b.cells}) == 1
        and values != others
        for k in range(len(CELL))
    ]
    matching: dict[tuple[str, ...], Cell] = {}
    for cell in b.cells:
        matching[_key(cell, sole)] = cell
    found = []
    for cell in a.cells:
        if (other := matching.get(_key(cell, sole))) is not None:
            one = Arm(_differing(cell, sole) or names[0], a, cell)
            another = Arm(_differing(other, sole) or names[1], b, other)
            found.append((one, another, _common(_key(cell, sole))))
    if not found:
        raise PhysimError(
            f"{names[0]}, {names[1]}: no cell of one is like a cell of the other: {_list(a)} "
            f"beside {_list(b)}"
        )
    return _not_too_many(found)


def compare(
    pairs: Sequence[tuple[Arm, Arm, str]],
    names: Sequence[str] = USUAL,
    own: Mapping[str, int] = MappingProxyType({}),
) -> list[Comparison]:
    """Compare arms in rates and measures; all p values are corrected together, after Holm.

    Findings of fewer pairs than `FEWEST_PAIRS`, as of a world in which nothing is random, can show
    nothing whatever they are: they are not tested, and do not count in the correction.

    ``own`` are directions of those of ``names`` that are metrics of one's own (`Outcomes.own`). A
    rate or measure that no pair has on both sides is left out. Raises PhysimError where two arms
    have no seed in common, and for a metric that no row has.
    """
    _check_own(pairs, own)
    directions = {**DIRECTIONS, **own}
    chosen = {name: directions[name] for name in names}
    made = [_compared(a, b, common, chosen) for a, b, common in pairs]
    tested = [f.p for comparison in made for f in comparison.findings if f.is_tested]
    corrected = iter(holm(tested))
    return [
        replace(
            one,
            findings=tuple(
                replace(f, corrected=next(corrected)) if f.is_tested else f for f in one.findings
            ),
        )
        for one in made
    ]


def _check_own(pairs: Sequence[tuple[Arm, Arm, str]], own: Mapping[str, int]) -> None:
    known = sorted({column for a, b, _ in pairs for arm in (a, b) for column in arm.outcomes.own})
    for column in own:
        if column not in known:
            name, *names = (one.removeprefix(PREFIX) for one in (column, *known))
            raise PhysimError(
                f'no row has a metric "{name}"; rows have {", ".join(names) or "none"}; runs that '
                "were made before it was installed have none"
            )


def _compared(a: Arm, b: Arm, common: str, names: Mapping[str, int]) -> Comparison:
    seeds_a, seeds_b = (arm.outcomes.seed[arm.cell.rows] for arm in (a, b))
    both, at_a, at_b = np.intersect1d(seeds_a, seeds_b, assume_unique=True, return_indices=True)
    if not len(both):
        raise PhysimError(f"{a.cell.name} and {b.cell.name}: have no seed in common")
    rows = at_a + a.cell.start, at_b + b.cell.start
    findings = list(_findings(a, b, rows, names))
    return Comparison(
        a, b, common, len(both), _seeds(np.setdiff1d(seeds_a, both)),
        _seeds(np.setdiff1d(seeds_b, both)),
        int(np.count_nonzero(a.outcomes.failed[rows[0]])),
        int(np.count_nonzero(b.outcomes.failed[rows[1]])), tuple(findings), rows,
    )  # fmt: skip


def _findings(
    a: Arm,
    b: Arm,
    rows: tuple[NDArray[np.int64], NDArray[np.int64]],
    names: Mapping[str, int],
) -> Iterator[Finding]:
    for name, direction in names.items():
        if name in RATES:
            good_a = a.outcomes.successes(name)[rows[0]]
            good_b = b.outcomes.successes(name)[rows[1]]
            only_a = int(np.count_nonzero(good_a & ~good_b))
            only_b = int(np.count_nonzero(good_b & ~good_a))
            found = rate_difference(only_b, only_a, len(good_a))
            yield Finding(
                name, len(good_a), float(good_a.mean()), float(good_b.mean()), *found,
                mcnemar(only_a, only_b), only_a, only_b,
            )  # fmt: skip
            continue
        values_a, values_b = a.outcomes.column(name)[rows[0]], b.outcomes.column(name)[rows[1]]
        known = ~(np.isnan(values_a) | np.isnan(values_b))
        if not known.any():
            continue
        values_a, values_b = values_a[known], values_b[known]
        difference = values_b - values_a
        gain = difference * direction
        yield Finding(
            name, len(difference), float(np.median(values_a)), float(np.median(values_b)),
            *median_difference(difference), sign_test(difference),
            int(np.count_nonzero(gain < 0)), int(np.count_nonzero(gain > 0)), direction,
        )  # fmt: skip


def _arm(outcomes: Outcomes, cell: Cell, place: int) -> Arm:
    return Arm(cell.names[place] or "as it is", outcomes, cell)


def _key(cell: Cell, sole: Sequence[bool]) -> tuple[str, ...]:
    return tuple(name for name, differs in zip(cell.names, sole, strict=True) if not differs)


def _differing(cell: Cell, sole: Sequence[bool]) -> str:
    return ", ".join(
        name for name, differs in zip(cell.names, sole, strict=True) if differs and name
    )


def _common(names: tuple[str, ...]) -> str:
    return ", ".join(name for name in names if name)


def _list(outcomes: Outcomes) -> str:
    names = [cell.name for cell in outcomes.cells]
    return "; ".join(names[:3]) + (" ..." if len(names) > 3 else "")


def _seeds(values: NDArray[np.int64]) -> tuple[int, ...]:
    return tuple(int(value) for value in values)


def _not_too_many(pairs: list[tuple[Arm, Arm, str]]) -> list[tuple[Arm, Arm, str]]:
    if len(pairs) > MOST_PAIRS_OF_CELLS:
        raise PhysimError(
            f"there are {len(pairs)} pairs of cells to compare; allowed: at most "
            f"{MOST_PAIRS_OF_CELLS}"
        )
    return pairs
