"""Tables of a league: rows of words, the head first, for Markdown, pages and the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isnan

from physim.campaigns.league import OUTCOMES
from physim.campaigns.report.league import COSTS, Ranking, Standings, Together, together
from physim.units import count, interval, percent, span

Rows = list[tuple[str, ...]]
"""Rows of a table, the head first"""
SIGNS = {1: "+", -1: "−", 0: "·"}
COST_HEADS = ("deviation, rms [m]", "formation error, rms [m]", "speed changes [m/s²]",
              "rotation changes [rad/s²]", "messages [1/s]")  # fmt: skip


def value_of(ranking: Ranking, k: int) -> str:
    """What an entrant has in a ranking."""
    value = ranking.values[k]
    if isnan(value):
        return "-"
    return f"{value:.2f}" if ranking.criterion.name == "time" else percent(value, 0)


def matrix(found: Standings, ranking: Ranking) -> Rows:
    """Who is surely better than whom; entrants from the best value on."""
    sign = 1.0 if ranking.criterion.name == "time" else -1.0
    order = sorted(range(len(found.entrants)), key=lambda k: (
        isnan(ranking.values[k]), sign * ranking.values[k]))  # fmt: skip
    head = ("", "value", *(str(place) for place in range(1, len(order) + 1)))
    return [head, *(
        (f"{place}. {found.entrants[a].name}", value_of(ranking, a),
         *("" if a == b else SIGNS[ranking.sure(a, b)] for b in order))
        for place, a in enumerate(order, 1)
    )]  # fmt: skip


def world_table(found: Standings, name: str) -> Rows:
    """World by world with how many seeds the reference alone succeeds, and how many it alone."""
    names = [one.name for one in found.entrants if one.name != found.reference]

    def told(world: str, entrant: str) -> str:
        cell = found.cells.get((world, entrant))
        finding = cell and cell.against.get(name)
        if not finding:
            return "" if cell else "cannot"
        sign = SIGNS[{"a": 1, "b": -1}.get(finding.better, 0)]
        return f"{sign} {finding.only_a} : {finding.only_b}"

    return [("world", *names), *(
        (world, *(told(world, entrant) for entrant in names)) for world in found.worlds
    )]  # fmt: skip


def outcome_table(found: Standings, worlds: Iterable[str], costs: bool = False) -> Rows:
    """What came of the runs of each entrant in some worlds, and in short what they cost."""
    worlds = list(worlds)
    more = ("makespan ratio", "messages [1/s]", "decision") if costs else ()
    rows: Rows = [
        ("entrant", "worlds", *OUTCOMES, "without contact", "arrived without contact", *more)
    ]
    for name, of in by_arrival(found, worlds):
        where = str(of.worlds) + (f" ({of.refused} cannot)" if of.refused else "")
        rows.append((name, where, *(count(of.came[word]) for word in OUTCOMES),
                     percent(of.contact_free), percent(of.arrived),
                     *((_ratio(found, name, of.ratio), _number(of.own["messages"]),
                        _span(of.decision[0])) if costs else ())))  # fmt: skip
    return rows


def by_arrival(found: Standings, worlds: Sequence[str]) -> list[tuple[str, Together]]:
    """Entrants over some worlds, those that arrive most often first."""
    each = [(one.name, together(found, one.name, worlds)) for one in found.entrants]
    each = [pair for pair in each if pair[1].worlds or pair[1].refused]
    return sorted(each, key=lambda pair: (isnan(pair[1].arrived), -pair[1].arrived))


def cost_table(found: Standings, worlds: Iterable[str]) -> Rows:
    """What arriving costs over some worlds, beside the reference."""
    rows: Rows = [
        ("entrant", "runs both solve", "makespan ratio", *COST_HEADS, "decision, median", "99 %")
    ]
    for name, of in by_arrival(found, list(worlds)):
        is_reference = name == found.reference
        rows.append((
            name, "" if is_reference else count(of.both), _ratio(found, name, of.ratio),
            *(_number(of.own[c]) if is_reference else _pair(of.beside[c]) for c in COSTS),
            *map(_span, of.decision),
        ))  # fmt: skip
    return rows


def cell_table(found: Standings, world: str) -> Rows:
    """What came of each entrant in a world, with intervals and test."""
    rows: Rows = [(
        "entrant", "runs", *OUTCOMES, "without contact [95 %]", "arrived without contact [95 %]",
        f"arrives alone: {found.reference} : it", "p",
    )]  # fmt: skip
    refused = {one.entrant for one in found.league.refused if one.world == world}
    for one in found.entrants:
        cell = found.cells.get((world, one.name))
        if cell is None:
            if one.name in refused:
                rows.append((one.name, "cannot", *[""] * (len(rows[0]) - 2)))
            continue
        test = cell.against.get("rate")
        rates = (f"{percent(rate.share)} {interval(rate.low, rate.high)}"
                 for rate in (cell.contact_free, cell.arrived))  # fmt: skip
        rows.append((
            one.name, count(cell.runs), *(count(cell.came[word]) for word in OUTCOMES), *rates,
            *(("", "") if test is None else (f"{test.only_a} : {test.only_b}", _p(test.p_corrected)
              if test.is_tested else "too few")),
        ))  # fmt: skip
    return rows


def cell_costs(found: Standings, world: str) -> Rows:
    """What arriving costs in a world, beside the reference and by itself."""
    rows: Rows = [(
        "entrant", "runs both solve", "makespan ratio [95 %]", *COST_HEADS, "own makespan [s]",
        "own deviation [m]", "decision, median", "99 %",
    )]  # fmt: skip
    for one in found.entrants:
        cell = found.cells.get((world, one.name))
        if cell is None:
            continue
        ratio, low, high = cell.ratio
        is_reference = one.name == found.reference
        beside = cell.beside or {cost: (cell.own[cost] if is_reference else float("nan"),) * 2
                                 for cost in COSTS}  # fmt: skip
        span_ = "" if isnan(ratio) else f" [{_number(low)}, {_number(high)}]"
        rows.append((
            one.name, "" if is_reference else count(cell.both),
            "1" if is_reference else f"{_number(ratio)}{span_}",
            *(_number(beside[c][0]) if is_reference else _pair(beside[c]) for c in COSTS),
            _number(cell.own["time_to_finish"], 1), _number(cell.own["deviation_rms"]),
            *map(_span, cell.decision),
        ))  # fmt: skip
    return rows


def _ratio(found: Standings, name: str, ratio: float) -> str:
    return "1" if name == found.reference else _number(ratio)


def _number(value: float, digits: int = 2) -> str:
    if isnan(value):
        return "-"
    return "unbounded" if value in (float("inf"), float("-inf")) else f"{value:.{digits}f}"


def _pair(values: tuple[float, float]) -> str:
    return "-" if isnan(values[0]) else f"{_number(values[0])} ({_number(values[1])})"


def _span(seconds: float) -> str:
    return "-" if isnan(seconds) else span(seconds)


def _p(value: float) -> str:
    return f"{value:.2g}" if value >= 1e-4 else "< 0.0001"
