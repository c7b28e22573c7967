"""Figures of a report: rates with intervals, distances, times, the worst, who did not finish."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from physim.campaigns import own_metrics
from physim.campaigns.asked import Asked, Missing, missing
from physim.campaigns.outcomes import Cell, FloatArray, Outcomes
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
MEASURES = {
    "least_distance": ("least distance", "m"),
    "shortest_distance": ("shortest distance of robots", "m"),
    "shortest_boundary_distance": ("shortest distance to a wall", "m"),
    "closing_speed": ("closing speed of contacts", "m/s"),
    "energy_lost": ("energy lost in contacts", "J"),
    "impulse": ("impulse of contacts", "N s"),
    "shortest_collision_time": ("least collision time", "s"),
    "time_to_finish": ("finish time", "s"),
    "deviation_peak": ("largest deviation", "m"),
    "formation_error_peak": ("largest formation error", "m"),
    "danger_share": ("in danger modes", ""),
    "decisions": ("decisions", ""),
    "messages": ("messages", ""),
    "cpu_seconds": ("processor time", "s"),
}
"""Columns of numbers that a report sums up: what they are, and their units."""
SEVERITY = ("closing_speed", "energy_lost", "impulse")
"""Columns of the severest contact of a run, by which runs with contacts are ranked"""


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
    """runs that crashed: an error, the limit of time, a killed worker"""
    touched: int
    """runs with a contact"""
    unfinished: int
    """runs whose time was up before all robots had arrived"""
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
    """Runs of a cell that crashed for the same reason."""

    cell: Cell
    ended: str
    reason: str
    seeds: tuple[int, ...]


Robots = tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Unfinished:
    """Runs of a cell whose time was up before all robots had arrived."""

    cell: Cell
    seeds: tuple[int, ...]
    stood: Robots
    """robots that stood short of their stops, and in how many runs; the most frequent first"""
    moved: Robots
    """the same of robots that were still on their way"""


@dataclass(frozen=True)
class Report:
    """All figures of a report."""

    title: str
    outcomes: Outcomes = field(repr=False)
    goal: Goal | None
    cells: tuple[CellReport, ...]
    worst: tuple[int, ...]
    """rows of the runs with the severest contacts, then those with the least distances"""
    failures: tuple[Failure, ...]
    """runs that crashed"""
    unfinished: tuple[Unfinished, ...]
    stuck: tuple[int, ...]
    """rows of some runs that did not finish, of every cell in turn"""
    missing: tuple[Missing, ...] = ()
    """cells that lack rows of runs that were asked for"""

    @property
    def runs(self) -> int:
        """Number of all runs."""
        return len(self.outcomes)

    @property
    def pictured(self) -> list[tuple[int, str]]:
        """Rows of which there are pictures, and of which moment: contact, nearest or end."""
        severe = ~np.isnan(self.outcomes.column(SEVERITY[0]))
        worst = [(row, "contact" if severe[row] else "nearest") for row in self.worst]
        return [*worst, *((row, "end") for row in self.stuck)]

    @property
    def cells_of_worst(self) -> int:
        """Number of cells that the worst runs are of."""
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
        title, outcomes, goal, cells, _worst(outcomes), _failures(outcomes),
        *_unfinished(outcomes), missing(asked or {}, outcomes),
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
    near = measures["least_distance"][rows]
    worst = None if np.all(np.isnan(near)) else cell.start + int(np.nanargmin(near))
    return CellReport(
        cell, (rates[0], rates[1], rates[2]), int(np.count_nonzero(outcomes.failed[rows])),
        int(np.count_nonzero(outcomes.touched[rows])),
        int(np.count_nonzero(outcomes.unfinished[rows])),
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


def _worst(outcomes: Outcomes) -> tuple[int, ...]:
    """Rows with the severest contacts, then with the least distances; of equal ones, the first.

    How deep a contact is says nothing: the engine decides that.
    """
    touched, near = outcomes.touched, outcomes.column("least_distance")
    speed, energy, impulse = (np.nan_to_num(outcomes.column(name)) for name in SEVERITY)
    known = np.flatnonzero(touched | ~np.isnan(near))
    keys = (np.where(touched, 0.0, near), -impulse, -energy, -speed, ~touched)
    order = np.lexsort([key[known] for key in keys])
    return tuple(int(row) for row in known[order[:WORST]])


def who_stood(rows: Sequence[Mapping[str, Any]]) -> tuple[Robots, Robots]:
    """Robots that stood short of their stops at the end of runs, and those that still moved."""
    stood, late = (
        Counter(name for row in rows for name in (row[column] or "").split(", ") if name)
        for column in ("stood", "not_arrived")
    )
    return tuple(stood.most_common()), tuple((late - stood).most_common())


def _unfinished(outcomes: Outcomes) -> tuple[tuple[Unfinished, ...], tuple[int, ...]]:
    """Runs that did not finish, by cell; and rows of some, the first of every cell, the second."""
    rows = np.flatnonzero(outcomes.unfinished)
    cell_of = np.searchsorted([cell.stop for cell in outcomes.cells], rows, side="right")
    part = outcomes.table.select(["not_arrived", "stood"]).take(rows).to_pylist()
    found = []
    for k in np.unique(cell_of).tolist():
        mine = np.flatnonzero(cell_of == k).tolist()
        seeds = tuple(outcomes.seed[rows[mine]].tolist())
        found.append(Unfinished(outcomes.cells[k], seeds, *who_stood([part[n] for n in mine])))
    turn = np.arange(len(rows)) - np.searchsorted(cell_of, cell_of)
    return tuple(found), tuple(rows[np.lexsort((cell_of, turn))][:WORST].tolist())


def _failures(outcomes: Outcomes) -> tuple[Failure, ...]:
    """Runs that crashed, by cell, end and reason; the most frequent first."""
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
