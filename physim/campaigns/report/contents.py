"""Figures of a report: rates with their intervals, distances, times, the worst and the failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from physim.campaigns import own_metrics
from physim.campaigns.asked import Asked, Missing, missing
from physim.campaigns.outcomes import Cell, FloatArray, Outcomes
from physim.campaigns.spec import Label
from physim.statistics.goal import RATES, Decision, Goal, decide
from physim.statistics.proportion import clopper_pearson, failure_bound, runs_needed
from physim.statistics.sequence import looks_needed, running

SHOWN = 0.999
"""the rate of which is told how many runs without a failure would show it"""
WORST = 10
MEASURES = {
    "shortest_distance": ("least distance", "m"),
    "shortest_collision_time": ("least collision time", "s"),
    "finish_time": ("finish time", "s"),
    "deviation": ("largest deviation", "m"),
    "formation_error": ("largest formation error", "m"),
    "danger_share": ("in danger modes", ""),
    "updates": ("decisions", ""),
    "messages": ("messages", ""),
    "cpu_seconds": ("processor time", "s"),
}
"""Columns of numbers that a report sums up: what they are, and their units."""


def title_of(column: str) -> tuple[str, str]:
    """What a column of numbers is, and its unit; of a metric of one's own its name."""
    return MEASURES[column] if column in MEASURES else own_metrics.title_of(column)


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

    name: str
    count: int
    """runs that have it; the others failed or never came to it"""
    least: float = np.nan
    quarter: float = np.nan
    median: float = np.nan
    three_quarters: float = np.nan
    most: float = np.nan

    @classmethod
    def of(cls, name: str, values: FloatArray) -> Spread:
        """Quartiles of a column; nan is left out and not counted."""
        known = values[~np.isnan(values)]
        if not len(known):
            return cls(name, 0)
        return cls(name, len(known), *map(float, np.quantile(known, [0, 0.25, 0.5, 0.75, 1])))


@dataclass(frozen=True)
class CellReport:
    """Figures of one cell."""

    cell: Cell
    rates: tuple[Rate, Rate, Rate]
    failed: int
    touched: int
    spreads: tuple[Spread, ...]
    decision: Decision | None
    """what stopped the campaign, where it had a goal"""
    worst: int | None
    """row of the run with the least distance"""
    draws: str = ""
    """what the seed draws, in words"""

    def spread(self, name: str) -> Spread:
        """Distribution of one measure."""
        return next(one for one in self.spreads if one.name == name)


@dataclass(frozen=True)
class Failure:
    """Runs of a cell that failed for the same reason."""

    cell: Cell
    ended: str
    reason: str
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class Report:
    """All figures of a report."""

    title: str
    outcomes: Outcomes = field(repr=False)
    goal: Goal | None
    cells: tuple[CellReport, ...]
    worst: tuple[int, ...]
    """rows of the runs with the least distances, the worst first"""
    failures: tuple[Failure, ...]
    missing: tuple[Missing, ...] = ()
    """cells that lack rows of runs that were asked for"""

    @property
    def runs(self) -> int:
        """Number of all runs."""
        return len(self.outcomes)

    @property
    def cells_of_worst(self) -> int:
        """Number of cells that the runs with the least distances are of."""
        stops = [one.cell.stop for one in self.cells]
        return len(set(np.searchsorted(stops, self.worst, side="right").tolist()))

    def versions(self) -> list[str]:
        """``physim 0.1.0``, ``pymunk 7.3.1``: all that the runs were made with."""
        own, engine = (
            sorted({str(word) for word in self.outcomes.table[name].unique().to_pylist()})
            for name in ("physim", "engine")
        )
        return [f"physim {word}" for word in own] + engine


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
    cells = tuple(
        replace(
            _cell(outcomes, cell, measures, goal, first), draws=(draws or {}).get(cell.names, "")
        )
        for cell in outcomes.cells
    )
    return Report(
        title, outcomes, goal, cells, _worst(outcomes, measures["shortest_distance"]),
        _failures(outcomes), missing(asked or {}, outcomes),
    )  # fmt: skip


def _cell(
    outcomes: Outcomes,
    cell: Cell,
    measures: dict[str, FloatArray],
    goal: Goal | None,
    first: int | None,
) -> CellReport:
    rows = cell.rows
    good = {name: outcomes.successes(name)[rows] for name in RATES}
    decision = None
    if goal is not None:
        alone = cell.count == 1  # where nothing is random a cell has one run, of whatever seed
        count = without_gap(outcomes.seed[rows], None if alone else first)
        decision = decide(goal, good[goal.rate][:count])
    rates = [
        exact(name, int(np.count_nonzero(hits)), cell.count) if decision is None
        else at_any_look(name, hits[: decision.runs])
        for name, hits in good.items()
    ]  # fmt: skip
    near = measures["shortest_distance"][rows]
    worst = None if np.all(np.isnan(near)) else cell.start + int(np.nanargmin(near))
    return CellReport(
        cell, (rates[0], rates[1], rates[2]), int(np.count_nonzero(outcomes.failed[rows])),
        int(np.count_nonzero(outcomes.touched[rows])),
        tuple(Spread.of(name, values[rows]) for name, values in measures.items()),
        decision, worst,
    )  # fmt: skip


def without_gap(seeds: np.ndarray, first: int | None) -> int:
    """How many of sorted seeds follow one another from ``first`` on, or from the smallest."""
    if not len(seeds):
        return 0
    start = int(seeds[0]) if first is None else first
    gaps = np.flatnonzero(seeds != np.arange(len(seeds)) + start)
    return int(gaps[0]) if len(gaps) else len(seeds)


def exact(name: str, good: int, of: int) -> Rate:
    """Rate with the exact interval, which is for a number of runs fixed beforehand."""
    low, high = clopper_pearson(good, of)
    if good < of or not of:
        return Rate(name, good, of, low, high)
    return Rate(name, good, of, low, high, failure_bound(of), runs_needed(SHOWN))


def at_any_look(name: str, hits: np.ndarray) -> Rate:
    """Rate with the confidence sequence, which holds whenever it is looked at."""
    if not len(hits):
        return Rate(name, 0, 0, 0.0, 1.0)
    looks = running(hits)
    good, of, low, high = int(looks.successes[-1]), len(hits), looks.low[-1], looks.high[-1]
    if good < of:
        return Rate(name, good, of, float(low), float(high))
    return Rate(name, good, of, float(low), float(high), 1.0 - float(low), looks_needed(SHOWN))


def _worst(outcomes: Outcomes, near: FloatArray) -> tuple[int, ...]:
    """Rows with the least distances; of equal ones, the first."""
    known = np.flatnonzero(~np.isnan(near))
    if len(known) > WORST:
        limit = np.partition(near[known], WORST - 1)[WORST - 1]
        known = known[near[known] <= limit]
    order = known[np.argsort(near[known], kind="stable")]
    return tuple(int(row) for row in order[:WORST])


def _failures(outcomes: Outcomes) -> tuple[Failure, ...]:
    """Runs that failed, by cell, end and reason; the most frequent first."""
    rows = np.flatnonzero(outcomes.failed)
    part = outcomes.table.select(["ended", "reason"]).take(rows).to_pylist()
    cell_of = np.searchsorted([cell.stop for cell in outcomes.cells], rows, side="right")
    seeds: dict[tuple[int, str, str], list[int]] = {}
    for k, row, of in zip(cell_of.tolist(), rows.tolist(), part, strict=True):
        key = (k, of["ended"] or "", of["reason"] or "")
        seeds.setdefault(key, []).append(int(outcomes.seed[row]))
    counts = Counter({key: len(found) for key, found in seeds.items()})
    return tuple(
        Failure(outcomes.cells[k], ended, reason, tuple(seeds[k, ended, reason]))
        for (k, ended, reason), _ in counts.most_common()
    )
