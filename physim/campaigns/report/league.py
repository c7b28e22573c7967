"""Figures of a league: what came of every cell, who is surely better than whom, and the verdict."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import exp, nan
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from physim.campaigns.compare import Arm, Finding, Pair, compare
from physim.campaigns.folder import Asked
from physim.campaigns.league import OUTCOMES, Entrant, League, outcome_of
from physim.campaigns.outcomes import Cell, FloatArray, Missing, Outcomes, missing
from physim.campaigns.report.contents import Rate, exact
from physim.campaigns.rows import Row
from physim.json_text import plain
from physim.statistics import Duel, duels, median_difference

COSTS = ("deviation_rms", "formation_error_rms", "speed_changes", "rotation_changes", "messages")
"""What is paid for arriving, beside time; messages are of a robot and second"""
FEWEST_SOLVED = 3
"""Seeds of a world that two must both solve before time and costs there count in means"""
HOLDS, FAILS, PARTLY, OPEN = "holds", "does not hold", "holds in part", "cannot be told"


class Criterion(NamedTuple):
    """What entrants are ranked by."""

    name: str
    title: str
    value: str
    """what the value of an entrant is"""


CRITERIA = (
    Criterion("contact_free", "runs without contact", "mean share over worlds"),
    Criterion("rate", "runs that arrive without contact", "mean share over worlds"),
    Criterion("time", "makespan where both arrive", "mean ratio to the reference"),
)


@dataclass(frozen=True)
class CellFigures:
    """What came of an entrant in a world."""

    runs: int
    came: Mapping[str, int]
    """runs by outcome"""
    contact_free: Rate
    arrived: Rate
    """contact-free and finished"""
    own: Mapping[str, float]
    """means over its own successes: makespan [s] and `COSTS`"""
    decision: tuple[float, float]
    """[s] medians over runs of the median and the 99 % quantile of a decision"""
    both: int = 0
    """seeds that it and the reference solve"""
    ratio: tuple[float, float, float] = (nan, nan, nan)
    """makespan over that of the reference, median over these, with its interval"""
    pace: float = nan
    """the same as the mean of logarithms"""
    beside: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """means over these of `COSTS`: its own, and the reference's"""
    against: Mapping[str, Finding] = field(default_factory=dict)
    """`contact_free`, ``rate`` and time to finish where both solve, beside the reference, A"""


class Ranking(NamedTuple):
    """Entrants by one criterion."""

    criterion: Criterion
    values: tuple[float, ...]
    """of each entrant: mean over worlds of a rate; of time, makespan over the reference's"""
    duels: Mapping[tuple[int, int], Duel]

    def sure(self, a: int, b: int) -> int:
        """1 where entrant a is surely better than b, -1 where surely worse, 0 where not told."""
        return self.duels[a, b].sure if a < b else -self.duels[b, a].sure

    def difference(self, a: int, b: int) -> float:
        """Mean of a's values less b's."""
        return self.duels[a, b].difference if a < b else -self.duels[b, a].difference


class Verdict(NamedTuple):
    """Whether the reference outperforms an entrant: surely better in contacts or arrivals, in
    neither surely worse; time is a price that is told beside it."""

    entrant: str
    verdict: str
    """one of `HOLDS`, `FAILS`, `PARTLY`, `OPEN`"""
    better: tuple[str, ...]
    """names of criteria in which the reference is surely better"""
    worse: tuple[str, ...]
    wins: tuple[str, ...]
    """worlds in which the reference is shown to be better in contacts or arrivals"""
    loses: tuple[str, ...]


@dataclass(frozen=True)
class Standings:
    """All figures of a league."""

    league: League
    outcomes: Outcomes = field(repr=False)
    entrants: tuple[Entrant, ...]
    worlds: tuple[str, ...]
    cells: Mapping[tuple[str, str], CellFigures]
    """by world and entrant; of a world that refuses one there is none"""
    rows: Mapping[tuple[str, str], Cell]
    rankings: tuple[Ranking, ...]
    verdicts: tuple[Verdict, ...]
    """of all but reference and null arm; empty without the reference"""
    missing: tuple[Missing, ...] = ()
    """cells that lack runs which were asked for"""

    @property
    def reference(self) -> str:
        """Name of the reference."""
        return self.league.reference

    def place(self, name: str) -> int:
        """Number of an entrant."""
        return [one.name for one in self.entrants].index(name)

    def films(self, entrant: str) -> list[tuple[str, Row]]:
        """Best and worst run of an entrant.

        Worst: the contact of the greatest closing speed; without contacts the longest standstill of
        a deadlock, then a run whose time was up. Best: it arrived, the fastest beside the median of
        all that arrived in that world.
        """
        rows = self._rows_of(1, entrant)
        good = [row for row in rows if outcome_of(row) == "arrived"]
        bad = [row for row in rows if outcome_of(row) in ("contact", "deadlock", "timeout")]
        found = []
        if good:
            pace = {
                world: median(_makespan(row) for row in self._rows_of(0, world)
                              if outcome_of(row) == "arrived")
                for world in {row.world for row in good}
            }  # fmt: skip
            found.append(("best", min(good, key=lambda row: _makespan(row) / pace[row.world])))
        if bad:
            found.append(("worst", max(bad, key=_badness)))
        return found

    def _rows_of(self, place: int, name: str) -> list[Row]:
        """Rows of a world (place 0) or of an entrant (1)."""
        cells = (cell for key, cell in self.rows.items() if key[place] == name)
        return [row for cell in cells for row in self.outcomes.rows[cell.rows]]


def _makespan(row: Row) -> float:
    return nan if row.time_to_finish is None else row.time_to_finish


def _badness(row: Row) -> tuple[bool, float, float]:
    return not row.contact_free, row.closing_speed or 0.0, row.standstill or 0.0


class _Solved(Arm):
    """An arm whose measures are of the runs that it solved."""

    def values(self, name: str) -> FloatArray:
        found = super().values(name)
        solved = self.outcomes.rate[self.rows]
        return np.where(solved, found, nan) if name == "time_to_finish" else found


def standings(league: League, outcomes: Outcomes, asked: Asked | None = None) -> Standings:
    """All figures, of the entrants and worlds that have rows or were refused; ``asked`` are the
    seeds that each cell is to have."""
    cells = {cell.names: cell for cell in outcomes.cells}
    rows = {
        (world, one.name): cells[one.label(world)]
        for world in league.worlds for one in league.entrants if one.label(world) in cells
    }  # fmt: skip
    there = {*rows, *((one.world, one.entrant) for one in league.refused)}
    entrants = tuple(one for one in league.entrants if one.name in {name for _, name in there})
    worlds = tuple(world for world in league.worlds if world in {world for world, _ in there})
    costs = _costs(league, outcomes, rows)
    pairs: dict[tuple[str, str], Pair] = {}
    for (world, name), cell in rows.items():
        reference = rows.get((world, league.reference))
        if reference is not None and name != league.reference:
            arms = (_Solved(league.reference, outcomes, reference), _Solved(name, outcomes, cell))
            if {*outcomes.seed[cell.rows].tolist()} & {*outcomes.seed[reference.rows].tolist()}:
                pairs[world, name] = (*arms, world)
    compared = compare(
        list(pairs.values()), {"contact_free": 1, "rate": 1, "time_to_finish": -1}, len(pairs)
    )
    beside = dict(zip(pairs, compared, strict=True))
    figures = {}
    for key, cell in rows.items():
        found = _of_cell(outcomes, cell, costs)
        if key in beside:
            one = beside[key]
            both = outcomes.rate[one.a.rows] & outcomes.rate[one.b.rows]
            a, b = one.a.rows[both], one.b.rows[both]
            time = outcomes.column("time_to_finish")
            found |= {
                "both": int(both.sum()),
                "ratio": tuple(map(_exp, median_difference(np.log(time[b] / time[a])))),
                "pace": _mean(np.log(time[b] / time[a])),
                "beside": {name: (_mean(values[b]), _mean(values[a]))
                           for name, values in costs.items()},
                "against": {f.name: f for f in one.findings},
            }  # fmt: skip
        figures[key] = CellFigures(**found)
    rankings = tuple(_ranking(one, league, outcomes, entrants, worlds, rows) for one in CRITERIA)
    verdicts = _verdicts(league, entrants, rankings, figures)
    return Standings(
        league, outcomes, entrants, worlds, figures, rows, rankings, verdicts,
        missing(asked or {}, outcomes),
    )  # fmt: skip


def _costs(
    league: League, outcomes: Outcomes, rows: Mapping[tuple[str, str], Cell]
) -> dict[str, FloatArray]:
    """Columns of `COSTS`; messages a robot and second, nan where the controller does not say."""
    found = {name: outcomes.column(name) for name in COSTS}
    with np.errstate(invalid="ignore", divide="ignore"):
        each = outcomes.column("robots") * outcomes.column("seconds")
        found["messages"] = found["messages"] / each
    alone = np.isnan(found["formation_error_rms"])
    when = {one.name: one.told for one in league.entrants}
    for (_, name), cell in rows.items():
        of = found["messages"][cell.rows]  # a view
        if not when[name] or (when[name] == "always" and not np.nan_to_num(of).any()):
            of[:] = nan  # nor does one whose decisions name nobody
        elif when[name] != "always":
            of[alone[cell.rows] | (when[name] == "never")] = 0.0
    return found


def _of_cell(outcomes: Outcomes, cell: Cell, costs: Mapping[str, FloatArray]) -> dict[str, Any]:
    rows = outcomes.rows[cell.rows]
    came = Counter(map(outcome_of, rows))
    arrived = outcomes.rate[cell.rows]
    columns = {"time_to_finish": outcomes.column("time_to_finish"), **costs}
    times = (outcomes.column(f"decision_{name}")[cell.rows] for name in ("median", "99"))
    return {
        "runs": len(rows),
        "came": {name: came[name] for name in OUTCOMES},
        "contact_free": exact("contact_free", outcomes.contact_free[cell.rows]),
        "arrived": exact("rate", arrived),
        "own": {name: _mean(values[cell.rows][arrived]) for name, values in columns.items()},
        "decision": tuple(float(np.median(t[~np.isnan(t)])) if (~np.isnan(t)).any() else nan
                          for t in times),
    }  # fmt: skip


def _ranking(
    criterion: Criterion, league: League, outcomes: Outcomes, entrants: Sequence[Entrant],
    worlds: Sequence[str], rows: Mapping[tuple[str, str], Cell],
) -> Ranking:  # fmt: skip
    is_time = criterion.name == "time"
    if is_time:  # more is better
        column = np.where(outcomes.rate, -np.log(outcomes.column("time_to_finish")), nan)
    else:
        column = outcomes.successes(criterion.name).astype(float)
    tables = []
    for world in worlds:
        mine = [rows.get((world, one.name)) for one in entrants]
        known = [outcomes.seed[cell.rows] for cell in mine if cell is not None]
        seeds = np.unique(np.concatenate([np.zeros(0, np.int64), *known]))
        table = np.full((len(entrants), len(seeds)), nan)
        for k, cell in enumerate(mine):
            if cell is not None:
                table[k, np.searchsorted(seeds, outcomes.seed[cell.rows])] = column[cell.rows]
        tables.append(table)
    found = Ranking(criterion, (), duels(tables, FEWEST_SOLVED if is_time else 1))
    if not is_time:
        means = [[_mean(table[k]) for table in tables] for k in range(len(entrants))]
        return found._replace(values=tuple(_mean(np.array(one)) for one in means))
    names = [one.name for one in entrants]
    if league.reference not in names:
        return found._replace(values=(nan,) * len(names))
    of = names.index(league.reference)
    return found._replace(values=tuple(
        1.0 if k == of else exp(found.difference(of, k)) for k in range(len(names))
    ))  # fmt: skip


def _verdicts(
    league: League, entrants: Sequence[Entrant], rankings: Sequence[Ranking],
    cells: Mapping[tuple[str, str], CellFigures],
) -> tuple[Verdict, ...]:  # fmt: skip
    names = [one.name for one in entrants]
    if league.reference not in names:
        return ()
    of, found = names.index(league.reference), []
    for k, name in enumerate(names):
        if name in (league.reference, league.null):
            continue
        better = [r.criterion.name for r in rankings if r.sure(of, k) > 0]
        worse = [r.criterion.name for r in rankings if r.sure(of, k) < 0]
        plus, minus = ({*one} & {"contact_free", "rate"} for one in (better, worse))
        verdict = {(True, False): HOLDS, (False, True): FAILS, (True, True): PARTLY}.get(
            (bool(plus), bool(minus)), OPEN
        )
        won, lost = (
            [world for (world, one), cell in cells.items()
             if one == name and any(f.better == side and f.is_rate for f in cell.against.values())]
            for side in ("a", "b")
        )  # fmt: skip
        found.append(Verdict(name, verdict, tuple(better), tuple(worse), tuple(won), tuple(lost)))
    return tuple(found)


class Together(NamedTuple):
    """An entrant over several worlds, which weigh alike."""

    worlds: int
    """in which it ran"""
    refused: int
    came: Mapping[str, int]
    contact_free: float
    arrived: float
    both: int
    """seeds that it and the reference solve, of worlds with `FEWEST_SOLVED` or more; what follows
    is of these"""
    ratio: float
    beside: Mapping[str, tuple[float, float]]
    own: Mapping[str, float]
    decision: tuple[float, float]


def together(found: Standings, name: str, worlds: Iterable[str]) -> Together:
    """An entrant over worlds: counts added up, rates and costs as means over worlds."""
    worlds = list(worlds)
    cells = [found.cells[world, name] for world in worlds if (world, name) in found.cells]

    def mean(values: Iterable[float]) -> float:
        return _mean(np.array([*values], float))

    solved = [one for one in cells if one.both >= FEWEST_SOLVED]
    return Together(
        len(cells),
        sum(one.entrant == name and one.world in worlds for one in found.league.refused),
        {word: sum(one.came[word] for one in cells) for word in OUTCOMES},
        mean(one.contact_free.share for one in cells),
        mean(one.arrived.share for one in cells),
        sum(one.both for one in solved),
        _exp(mean(one.pace for one in solved)),
        {cost: (mean(one.beside[cost][0] for one in solved),
                mean(one.beside[cost][1] for one in solved)) for cost in COSTS},
        {cost: mean(one.own[cost] for one in cells) for cost in COSTS},
        (mean(one.decision[0] for one in cells), mean(one.decision[1] for one in cells)),
    )  # fmt: skip


def _mean(values: FloatArray) -> float:
    """Mean of what is not nan; nan of nothing."""
    known = values[~np.isnan(values)]
    return float(known.mean()) if len(known) else nan


def _exp(value: float) -> float:
    return float(np.exp(value))


def standings_values(found: Standings) -> dict[str, Any]:
    """All figures in types that JSON knows; nan is null. Units: m, s; shares from 0 to 1."""
    names = [one.name for one in found.entrants]
    values: dict[str, Any] = plain({
        "format": "physim-league-standings",
        "version": 1,
        "reference": found.reference,
        "verdicts": found.verdicts,
        "rankings": [
            {
                "criterion": one.criterion.name,
                "values": dict(zip(names, one.values, strict=True)),
                "duels": [
                    {"a": names[a], "b": names[b], **plain(duel), "sure": duel.sure}
                    for (a, b), duel in one.duels.items()
                ],
            }
            for one in found.rankings
        ],
        "cells": [
            {"world": world, "entrant": name, **plain(cell)}
            for (world, name), cell in found.cells.items()
        ],
        "refused": [one.model_dump() for one in found.league.refused],
        "entrants": [one.model_dump() for one in found.entrants],
        "machines": found.league.machines,
    })  # fmt: skip
    return values
