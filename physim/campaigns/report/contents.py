"""Figures of a report, cell by cell: rates with intervals, measures, the worst, who was late."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from physim.campaigns.folder import Asked
from physim.campaigns.measures import MEASURES, NEAREST, SEVERITY
from physim.campaigns.outcomes import Cell, FloatArray, Missing, Outcomes, missing
from physim.campaigns.rows import Row
from physim.campaigns.spec import Label
from physim.statistics import (
    RATES,
    Decision,
    Goal,
    clopper_pearson,
    decide,
    failure_bound,
    looks_needed,
    running,
    runs_needed,
)

SHOWN = 0.999
"""the rate of which is told how many runs without a failure would show it"""
WORST = 10
"""Worst runs that are shown, the same number of each cell and of each one at least"""
MOST_PICTURED = 20
"""Cells whose worst runs have pictures"""
Robots = tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Rate:
    """A share of the runs of a cell with its interval."""

    name: str
    """``rate`` (contact-free and finished), ``contact_free`` or ``finished``"""
    good: int
    of: int
    low: float
    high: float
    at_most: float | None = None
    """where no run failed: upper bound of the rate of failures"""
    needed: int | None = None
    """where no run failed: runs in all without a failure that show `SHOWN`"""

    @property
    def share(self) -> float:
        """[-]; nan without runs"""
        return self.good / self.of if self.of else np.nan


@dataclass(frozen=True)
class Spread:
    """How a measure is distributed over the runs of a cell that have it."""

    count: int
    """runs that have it; the others failed or never came to it"""
    least: float = np.nan
    quarter: float = np.nan
    median: float = np.nan
    three_quarters: float = np.nan
    most: float = np.nan

    @classmethod
    def of(cls, values: FloatArray) -> Spread:
        """Quartiles of a column; nan is left out and not counted."""
        known = values[~np.isnan(values)]
        if not len(known):
            return cls(0)
        return cls(len(known), *map(float, np.quantile(known, [0, 0.25, 0.5, 0.75, 1])))


@dataclass(frozen=True)
class Failure:
    """Runs of a cell that crashed for the same reason: an error, the limit of time, a kill."""

    cell: Cell
    ended: str
    reason: str
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class CellReport:
    """Figures of one cell."""

    cell: Cell
    rates: tuple[Rate, Rate, Rate]
    spreads: Mapping[str, Spread]
    decision: Decision | None
    """what stopped the campaign, where it had a goal"""
    touched: int
    """runs with a contact"""
    unfinished: tuple[int, ...]
    """seeds of the runs whose time was up before all robots had arrived"""
    stood: Robots
    """robots that stood short of their stops then, and in how many runs; most frequent first"""
    moved: Robots
    """the same of robots that were still on their way"""
    failures: tuple[Failure, ...]
    worst: tuple[int, ...]
    """rows of the runs with the severest contacts, then of those with the least distances"""
    late: tuple[int, ...]
    """rows of some runs that did not finish"""
    draws: str
    """what the seed draws, in words"""

    @property
    def failed(self) -> int:
        """Number of runs that crashed."""
        return sum(len(one.seeds) for one in self.failures)


@dataclass(frozen=True)
class Report:
    """All figures of a report."""

    title: str
    outcomes: Outcomes = field(repr=False)
    goal: Goal | None
    cells: tuple[CellReport, ...]
    missing: tuple[Missing, ...]
    """cells that lack rows of runs that were asked for"""
    draws: str
    """what the seed draws, where that is the same in all cells"""

    @property
    def pictured(self) -> list[tuple[int, str]]:
        """Rows of which there are pictures, and of which moment: contact, nearest or end."""
        severe = ~np.isnan(self.outcomes.column(SEVERITY[0]))
        cells = self.cells[:MOST_PICTURED]
        worst = [(k, "contact" if severe[k] else "nearest") for one in cells for k in one.worst]
        return [*worst, *((k, "end") for one in cells for k in one.late)]

    @property
    def failures(self) -> list[Failure]:
        """Crashes of all cells, the most frequent first."""
        found = [failure for one in self.cells for failure in one.failures]
        return sorted(found, key=lambda failure: -len(failure.seeds))

    def versions(self) -> list[str]:
        """``physim 0.1.0``, ``pymunk 7.3.1``: all that the runs were made with."""
        rows = self.outcomes.rows
        own = sorted({f"physim {row.physim}" for row in rows})
        return own + sorted({row.engine for row in rows})


def report_of(
    outcomes: Outcomes,
    title: str,
    goal: Goal | None = None,
    first: int | None = None,
    asked: Asked | None = None,
    draws: Mapping[Label, str] | None = None,
) -> Report:
    """All figures. With a ``goal``, that of ``sweep --until``, by the confidence sequence.

    ``asked`` are the seeds that the campaign is to have, ``draws`` is what they draw. With a goal
    only runs without a gap from seed ``first`` on count in rates: which runs after a gap are there
    depends on how long they took.
    """
    measures = {name: outcomes.column(name) for name in (*MEASURES, *outcomes.own)}

    def report(cell: Cell) -> CellReport:
        decision, rates = _rates(outcomes, cell, goal, first)
        seeds, rows = outcomes.seed[cell.rows], np.arange(cell.start, cell.stop)
        late = outcomes.unfinished[cell.rows]
        each = max(1, WORST // len(outcomes.cells))
        ends = [outcomes.rows[k] for k in rows[late]]
        return CellReport(
            cell, rates, {name: Spread.of(one[cell.rows]) for name, one in measures.items()},
            decision, int(np.count_nonzero(outcomes.touched[cell.rows])),
            tuple(seeds[late].tolist()), *who_stood(ends), _failures(outcomes, cell),
            _worst_first(outcomes.touched, measures, rows)[:each],
            tuple(rows[late][:each].tolist()), (draws or {}).get(cell.names, ""),
        )  # fmt: skip

    cells = tuple(map(report, outcomes.cells))
    same = {one.draws if one.cell.count > 1 else "" for one in cells}
    return Report(
        title, outcomes, goal, cells, missing(asked or {}, outcomes),
        same.pop() if len(same) == 1 else "",
    )  # fmt: skip


def _rates(
    outcomes: Outcomes, cell: Cell, goal: Goal | None, first: int | None
) -> tuple[Decision | None, tuple[Rate, Rate, Rate]]:
    good = {name: outcomes.successes(name)[cell.rows] for name in RATES}
    decision, runs, rate = None, cell.count, exact
    if goal is not None:
        seeds = outcomes.seed[cell.rows]
        alone = cell.count == 1  # where nothing is random a cell has one run, of whatever seed
        start = seeds[0] if alone or first is None else first
        gaps = np.flatnonzero(seeds != np.arange(len(seeds)) + start)
        decision = decide(goal, good[goal.rate][: int(gaps[0]) if len(gaps) else len(seeds)])
        runs, rate = decision.runs, at_any_look
    both, free, finished = (rate(name, hits[:runs]) for name, hits in good.items())
    return decision, (both, free, finished)


def exact(name: str, hits: NDArray[np.bool_]) -> Rate:
    """Rate with the exact interval, which is for a number of runs fixed beforehand."""
    good, of = int(np.count_nonzero(hits)), len(hits)
    none_failed = (failure_bound(of), runs_needed(SHOWN)) if good == of > 0 else (None, None)
    low, high = map(float, clopper_pearson(good, of))
    return Rate(name, good, of, low, high, *none_failed)


def at_any_look(name: str, hits: NDArray[np.bool_]) -> Rate:
    """Rate with the confidence sequence, which holds whenever it is looked at.

    Ends of earlier looks may leave the share of now out, so they are moved out to it.
    """
    if not len(hits):
        return Rate(name, 0, 0, 0.0, 1.0)
    looks = running(hits)
    good, low, high = int(looks.successes[-1]), float(looks.low[-1]), float(looks.high[-1])
    none_failed = (1.0 - low, looks_needed(SHOWN)) if good == len(hits) else (None, None)
    share = good / len(hits)
    return Rate(name, good, len(hits), min(low, share), max(high, share), *none_failed)


def _worst_first(
    touched: NDArray[np.bool_], measures: Mapping[str, FloatArray], rows: NDArray[np.int64]
) -> tuple[int, ...]:
    """Rows with the severest contacts, then with the least distances; of equal ones, the first.

    How deep a contact is says nothing: the engine decides that.
    """
    rows = rows[touched[rows] | ~np.isnan(measures[NEAREST][rows])]
    hit = touched[rows]
    near = np.where(hit, 0.0, measures[NEAREST][rows])
    speed, energy, impulse = (-np.nan_to_num(measures[name][rows]) for name in SEVERITY)
    return tuple(rows[np.lexsort((near, impulse, energy, speed, ~hit))].tolist())


def who_stood(rows: Sequence[Row]) -> tuple[Robots, Robots]:
    """Robots that stood short of their stops at the end of runs, and those that still moved."""
    stood = Counter(name for row in rows for name in row.stood.split(", ") if name)
    late = Counter(name for row in rows for name in row.not_arrived.split(", ") if name)
    return tuple(stood.most_common()), tuple((late - stood).most_common())


def _failures(outcomes: Outcomes, cell: Cell) -> tuple[Failure, ...]:
    seeds: dict[tuple[str, str], list[int]] = {}
    for row in outcomes.rows[cell.rows]:
        if row.failed:
            seeds.setdefault((row.ended, row.reason), []).append(row.seed)
    return tuple(Failure(cell, *key, tuple(found)) for key, found in seeds.items())
