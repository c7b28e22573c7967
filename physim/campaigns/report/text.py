"""What reports and comparisons say: sentences, tables, and values for `--json`."""

from __future__ import annotations

import io
import math
import shlex
import shutil
import sys
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, astuple
from itertools import compress
from typing import Any, NamedTuple

from physim.campaigns.compare import ALPHA, FEWEST_PAIRS, Comparison
from physim.campaigns.measures import MEASURES, RATE_TITLES, SEVERITY, TOLD, measure_of
from physim.campaigns.outcomes import CELL, Missing, Outcomes
from physim.campaigns.report.contents import SHOWN, CellReport, Rate, Report, Robots
from physim.campaigns.rows import Row
from physim.errors import plural
from physim.escaping import escaped
from physim.json_text import plain
from physim.statistics import Decision, Goal
from physim.units import amount, count, interval, percent

MOST_ROWS = 200
"""Rows of a table; of more it is told how many, and `--json` has all"""
MOST_SEEDS, MOST_ROBOTS, MOST_MISSING = 5, 6, 3
LEAST_KEY, LONGEST_ROW_NUMBER = 6, 8
"""Digits of a run that are shown; and of the number of a row, which no digits of a run may be"""
TO_THE_RIGHT = {"runs", "median", "middle half", "least", "most", "of", "A", "B", "B - A [95 %]",
                "p", "won A:B"}  # fmt: skip
"""Heads of columns of numbers"""
LEAST_WIDTH = 80
"""Signs that a table may take in the narrowest terminal"""
EXACT = (
    "95 % intervals are exact (Clopper and Pearson), for a number of runs fixed in advance. They "
    "are not valid if a campaign was stopped because of its results; those of physim sweep --until "
    "are. Each interval is valid by itself, not all at once. Where no run failed, the bound is "
    "one-sided."
)
SEQUENCE = (
    "95 % intervals are a confidence sequence (beta-binomial mixture), which is valid at every "
    "look. This campaign (sweep --until) looked at its results after every run. Exact intervals, "
    "for a number of runs fixed in advance, would be narrower but not valid. In each cell only the "
    "runs up to the decision count, in the order of seeds."
)
PAIRED = (
    "Differences are B minus A on the same seeds. Rates differ by percentage points (conservative "
    "interval, from exact parts), measures by the median of the differences (interval by order "
    "statistics). Each 95 % interval is valid by itself, for a number of seeds fixed in advance. "
    "The better one succeeds alone (rates) or has the better value (measures) with more seeds; "
    "ties are left out. The tests are exact and two-sided (McNemar's test, the sign test). p is "
    f"corrected for the number of findings with at least {FEWEST_PAIRS} pairs (Holm). A difference "
    f"is shown if p is at most {ALPHA:g} and, for a rate, the interval does not contain 0. If none "
    "is shown, there may still be one: the interval says how large it may be."
)
LOOKED = (
    "A campaign was stopped because of its results (sweep --until): its intervals are too narrow "
    "and its p values too small here; compare campaigns with a number of runs fixed in advance."
)


class Table(NamedTuple):
    """A table for people, on terminals and pages."""

    title: str
    head: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]

    def some(self) -> Iterator[tuple[str, ...]]:
        """Rows that are shown."""
        yield from self.rows[:MOST_ROWS]
        if (more := len(self.rows) - MOST_ROWS) > 0:
            yield f"… and {count(more)} more: --json has all", *[""] * (len(self.head) - 1)

    def __str__(self) -> str:
        """In columns, as wide as it needs to be; in a terminal as wide as that."""
        from rich.console import Console
        from rich.table import Table as Columns

        columns = Columns(box=None, pad_edge=False, show_header=any(self.head))
        for name in self.head:
            number = name in TO_THE_RIGHT
            columns.add_column(name, justify="right" if number else "left", no_wrap=number)
        for row in self.some():
            columns.add_row(*map(escaped, row))
        out = io.StringIO()
        width = max(LEAST_WIDTH, shutil.get_terminal_size().columns)
        width = width if sys.stdout.isatty() else 10_000
        Console(
            file=out, width=width, color_system=None, markup=False, emoji=False, highlight=False
        ).print(columns)
        lines = [line.rstrip() for line in out.getvalue().splitlines()]
        return "\n".join([f"{self.title}:", *lines] if self.title else lines)


def report_text(report: Report, explain: bool = False) -> str:
    """A sentence on each cell, then measures, what did not finish or crashed, and the worst."""
    parts = [escaped(f"{report.title}: {opening(report)}")]
    if report.missing:
        parts[0] += f"\n{escaped(missing_words(report.missing))}"
    parts.append(
        "\n".join(
            escaped(f"{one.cell.name}: {'; '.join(verdict(report, one))}") for one in report.cells
        )
    )
    tables = (measure_table(report, (*TOLD, *report.outcomes.own)), late_table(report),
              crash_table(report), worst_table(report))  # fmt: skip
    parts += [str(table) for table in tables if table.rows]
    method = EXACT if report.goal is None else SEQUENCE
    parts.append(method if explain else method.partition(". ")[0])
    return "\n\n".join(parts) + "\n"


def opening(report: Report) -> str:
    """``32 runs of 4 cells, seeds 1 to 8, which draw the starts; physim 0.1.0, pymunk 7.3.1``."""
    failed, seeds = sum(one.failed for one in report.cells), report.outcomes.seed
    between = f", seeds {seeds.min()} to {seeds.max()}" if len(seeds) else ""
    between += f", which draw {report.draws}" if report.draws else ""
    crashed = f"; {plural(failed, 'run')} crashed" if failed else ""
    return (
        f"{count(len(seeds))} runs of {plural(len(report.cells), 'cell')}{between}{crashed}; "
        f"{', '.join(report.versions())}"
    )


def verdict(report: Report, one: CellReport) -> list[str]:
    """What came of a cell: first how often it went well, then all else; an interval once."""
    said = [
        f"{count(rate.good)} of {plural(rate.of, 'run')} {RATE_TITLES[rate.name]}, "
        f"{percent(rate.share)} {interval(rate.low, rate.high)}"
        for k, rate in enumerate(one.rates)
        if (rate.good, rate.of) not in [(before.good, before.of) for before in one.rates[:k]]
    ]
    if one.decision and report.goal:
        said.append(decision_words(one.decision, report.goal))
    counts = {
        "runs in all": one.cell.count if one.decision else 0,
        "with contacts": one.touched,
        "did not finish": len(one.unfinished),
        "crashed": one.failed,
    }
    said += [f"{count(number)} {what}" for what, number in counts.items() if number]
    draws = "" if report.draws else over_seeds(one.cell.count, one.draws)
    return [*said, *filter(None, (note_of(one.rates[0]), draws))]


def note_of(rate: Rate) -> str:
    """What a single run tells, or what it means that none went wrong; else empty."""
    if rate.of == 1:
        return "only one run, as nothing is random: the interval has no meaning"
    if rate.at_most is None or rate.needed is None:
        return ""
    more, shown = rate.needed - rate.of, percent(SHOWN)
    few = f"at most {percent(rate.at_most, None, 1)} fail"
    if more > 0:
        return f"{few} ({count(more)} more runs without a failure would show {shown})"
    return f"{few}: {shown} is shown"


def over_seeds(runs: int, draws: str) -> str:
    """``over 100 seeds, which draw the starts``; empty where nothing is drawn."""
    return f"over {count(runs)} seeds, which draw {draws}" if draws and runs > 1 else ""


def measure_table(report: Report, names: Iterable[str]) -> Table:
    """Medians of measures over the runs of each cell, and between what they lie."""
    rows: list[tuple[str, ...]] = []
    several, cells = len(report.cells) > 1, brief_names(report)
    for name in names:
        measure, found = measure_of(name), [one.spreads[name] for one in report.cells]
        if several and any(spread.count for spread in found):
            rows.append((measure.label, *[""] * 5))
        for one, cell, spread in zip(report.cells, cells, found, strict=True):
            if spread.count:
                least, low, median, high, most = (
                    bare(value, measure.unit) for value in astuple(spread)[1:]
                )
                first = f"· {cell}" if several else measure.label
                few = count(spread.count) if spread.count < one.cell.count else ""
                rows.append((first, median, f"{low} to {high}", least, most, few))
    return Table("", ("over runs", "median", "middle half", "least", "most", "of"), rows)


def bare(value: float, unit: str) -> str:
    """A measured value without its unit; a share in percent."""
    return (percent(value) if unit == "%" else amount(value, unit)).removesuffix(f" {unit}")


def brief_names(report: Report) -> list[str]:
    """Names of the cells without what all have in common."""
    names = [one.cell.names for one in report.cells]
    varies = [len(set(column)) > 1 for column in zip(*names, strict=True)]
    return [", ".join(word for word in compress(one, varies) if word) for one in names]


def late_table(report: Report) -> Table:
    """Cells with runs that did not finish."""
    return Table(
        "runs that did not finish, with the robots that had not arrived (runs)",
        ("cell", "runs", "robots", "seeds"),
        [
            (one.cell.name, count(len(one.unfinished)),
             robots_words(one.stood, one.moved, len(one.unfinished)), seeds_text(one.unfinished))
            for one in report.cells if one.unfinished
        ],
    )  # fmt: skip


def crash_table(report: Report) -> Table:
    """Kinds of crashes."""
    return Table(
        "runs that crashed, each counted above as neither contact-free nor finished",
        ("cell", "runs", "ended by", "reason", "seeds"),
        [
            (one.cell.name, count(len(one.seeds)), one.ended, one.reason, seeds_text(one.seeds))
            for one in report.failures
        ],
    )  # fmt: skip


def worst_table(report: Report) -> Table:
    """The worst runs of each cell, with the commands that make them again."""
    rows: list[tuple[str, ...]] = []
    for one, cell in zip(report.cells[:MOST_ROWS], brief_names(report), strict=False):
        rows += [(cell, "", "", "")] if cell and one.worst else []
        for row in map(report.outcomes.rows.__getitem__, one.worst):
            again = replay(report.title, report.outcomes, row)
            rows.append((f"· seed {row.seed}", severity_words(row), where(row), again))
    return Table("the worst runs of each cell", ("", "", "", ""), rows)


def replay(folder: str, outcomes: Outcomes, row: Row) -> str:
    """The command that makes a run again; code of one's own is run only when named."""
    keys, key, digits = outcomes.keys, row.run, LEAST_KEY
    k = bisect_left(keys, key)
    beside = [*keys[max(k - 1, 0) : k], *keys[k + 1 : k + 2]]  # the ones most like it
    while digits < len(key) and (
        any(one.startswith(key[:digits]) for one in beside)
        or (digits <= LONGEST_ROW_NUMBER and key[:digits].isdecimal())
    ):
        digits += 1
    own = row.controller if ":" in row.controller else ""
    named = ["--controller", own] if own else []
    return shlex.join(["physim", "replay", f"{folder}:{key[:digits]}", *named])


def severity_words(row: Row) -> str:
    """How hard the severest contact of a run was, or how near anything came."""
    found = {name: getattr(row, name) for name in SEVERITY}
    known = {name: float(f"{value:.3g}") for name, value in found.items() if value is not None}
    if known:
        return ", ".join(amount(value, MEASURES[name].unit) for name, value in known.items())
    if row.contacts or row.grazes or row.least_distance is None:
        return "contact"
    return amount(row.least_distance, "m")


def pair_and_time(row: Row) -> tuple[str, float | None]:
    """Whose the severest contact of a run was and when [s], or else the least distance."""
    if row.severest_contact_time is None:
        return row.least_distance_pair, row.least_distance_time
    return row.severest_contact_pair, row.severest_contact_time


def where(row: Row) -> str:
    """``r1, r2 at 3.20 s``: of the severest contact, or else of the least distance."""
    pair, time = pair_and_time(row)
    return f"{pair} at {time:.2f} s" if time is not None else pair


def run_name(row: Row) -> str:
    """World, settings, controller and seed of a run."""
    return ", ".join([*filter(None, (row.world, row.settings, row.controller)), f"seed {row.seed}"])


def robots_words(stood: Robots, moved: Robots, runs: int) -> str:
    """Which robots stood short of their stops and which still moved, each in how many runs."""
    parts = []
    for verb, names in (("stood", stood), ("still moved", moved)):
        said = [name if runs == 1 else f"{name} ({count(often)})" for name, often in names]
        more = len(said) - MOST_ROBOTS
        rest = f" and {count(more)} more" if more > 0 else ""
        parts += [f"{verb}: {', '.join(said[:MOST_ROBOTS])}{rest}"] if said else []
    return "; ".join(parts) or "robots not known"


def seeds_text(seeds: Sequence[int]) -> str:
    """``3, 8, 9 and 12 more``."""
    more = len(seeds) - MOST_SEEDS
    return ", ".join(map(str, seeds[:MOST_SEEDS])) + (f" and {more} more" if more > 0 else "")


def missing_words(missing: Sequence[Missing]) -> str:
    """What a campaign was asked for and has no rows of; empty where it has all."""
    if not missing:
        return ""
    few = "; ".join(
        f"{', '.join(filter(None, one.cell))}: {count(one.runs)} of {count(one.of)}"
        for one in missing[:MOST_MISSING]
    )
    more = len(missing) - MOST_MISSING
    rest = f"; {plural(more, 'further cell')}" if more > 0 else ""
    return (
        f"Not complete: {count(sum(one.runs for one in missing))} of the runs that were asked for "
        f"have no row ({few}{rest}). The sweep is under way, was interrupted or lacks a shard; the "
        "same command does the rest."
    )


def decision_words(decision: Decision, goal: Goal) -> str:
    """What came of a goal in a cell."""
    runs = plural(decision.runs, "run")
    if not decision.decided:
        return f"undecided after {runs}"
    if decision.holds is None:
        return f"narrow enough after {runs}"
    than = "above" if (goal.sign == ">") == decision.holds else "below"
    return f"decided after {runs}: {RATE_TITLES[goal.rate]} {than} {percent(goal.number)}"


def report_values(report: Report) -> dict[str, Any]:
    """All figures, in types that JSON knows; nan is null. Units: m, s; shares from 0 to 1."""
    rows = [report.outcomes.rows[index] for one in report.cells for index in one.worst]
    values: dict[str, Any] = plain({
        "format": "physim-campaign-report",
        "version": 1,
        "units": "m, s; shares from 0 to 1",
        "title": report.title,
        "runs": len(report.outcomes),
        "missing": [
            {"cell": ", ".join(filter(None, one.cell)), "runs": one.runs, "of": one.of}
            for one in report.missing
        ],
        "versions": report.versions(),
        "interval": "Clopper-Pearson" if report.goal is None else "beta-binomial sequence",
        "confidence": 0.95,
        "until": None if report.goal is None else str(report.goal),
        "cells": [
            {
                **dict(zip(CELL, one.cell.names, strict=True)),
                "runs": one.cell.count,
                "failed": one.failed,
                "with_contacts": one.touched,
                "unfinished": len(one.unfinished),
                "draws": one.draws,
                "rates": [{"share": rate.share, **asdict(rate)} for rate in one.rates],
                "measures": {name: asdict(spread) for name, spread in one.spreads.items()},
                "decision": None if one.decision is None else asdict(one.decision),
            }
            for one in report.cells
        ],
        "worst": [
            {"run": row.run, "name": run_name(row),
             **{name: getattr(row, name) for name in ("least_distance", *SEVERITY)}}
            for row in rows
        ],
        "unfinished": [
            {"cell": one.cell.name, "seeds": one.unfinished, "stood": dict(one.stood),
             "moved": dict(one.moved)}
            for one in report.cells if one.unfinished
        ],
        "failures": [{**asdict(one), "cell": one.cell.name} for one in report.failures],
    })  # fmt: skip
    return values


def comparison_text(
    comparisons: Sequence[Comparison], looked: bool = False, explain: bool = False
) -> str:
    """All comparisons: which is better in what, then by how much."""
    parts = []
    for one in comparisons:
        common = f" ({one.common})" if one.common else ""
        lines = [f"{headline(one)}{common}", f"  {sides(one)}: {told(one)}"]
        lines += [f"  note: {difference}" for difference in one.unlike]
        table = [str(finding_table(one))] if one.findings else []
        parts.append("\n".join([*map(escaped, lines), *table]))
    parts += [PAIRED] * explain + [LOOKED] * looked
    return "\n\n".join(parts) + "\n"


def sides(one: Comparison) -> str:
    """Which is A, and which is B."""
    return f"A {one.a.label}, B {one.b.label}"


def headline(one: Comparison) -> str:
    """Which arm is better in what; one sentence."""
    if not any(f.is_tested for f in one.findings):
        return "too few pairs to tell"
    said = [
        f"{arm.label} ({side.upper()}) is better in {', '.join(names)}"
        for side, arm in (("a", one.a), ("b", one.b))
        if (names := [measure_of(f.name).title for f in one.findings if f.better == side])
    ]
    rest = ", ".join(measure_of(f.name).title for f in one.findings if not f.better)
    if not said:
        tested = [f.pairs for f in one.findings if f.is_tested]
        needed = 1 + math.ceil(math.log2(len(tested) / ALPHA))  # p of n pairs is 2^(1 - n) at least
        if max(tested) >= needed:
            return "no difference shown"
        findings = plural(len(tested), "finding")
        return f"no difference shown: among {findings} it takes at least {needed} pairs to show one"
    return "; ".join([*said, *([f"no difference shown in {rest}"] if rest else [])])


def told(one: Comparison) -> str:
    """How many seeds are compared, and what is left out."""
    text = f"{plural(one.seeds, 'seed')} in common"
    if one.seeds == 1:
        text += ": nothing in the world is random"
    for name, arm in (("A", one.a), ("B", one.b)):
        if arm.alone:
            only = f"{count(len(arm.alone))} that only {name} has are left out"
            text += f"; {only} ({seeds_text(arm.alone)})"
        if arm.failed:
            text += f"; {plural(arm.failed, 'run')} of {name} crashed"
    return text


def finding_table(one: Comparison) -> Table:
    """A row for each rate and measure: both sides, by how much, with how many seeds."""
    rows = []
    for found in one.findings:
        measure = measure_of(found.name)
        a, b = bare(found.a, measure.unit), bare(found.b, measure.unit)
        shift, low, high = (
            _signed(value, measure.unit) for value in (found.difference, found.low, found.high)
        )
        p, better = "", "not tested"
        if found.is_tested:
            shift += f" [{low}, {high}]"
            p, better = f"{found.p_corrected:.2f}", found.better.upper()
            if found.p_corrected < 0.1:
                p = f"{found.p_corrected:.2g}" if found.p_corrected >= 1e-4 else "< 0.0001"
        if found.pairs < (one.seeds if found.is_tested else FEWEST_PAIRS):
            better += f"{': ' if better else ''}{plural(found.pairs, 'pair')}"
        won = f"{found.only_a}:{found.only_b}" if found.only_a or found.only_b else ""
        rows.append((measure.label, a, b, shift, won, p, better))
    return Table("", ("", "A", "B", "B - A [95 %]", "won A:B", "p", "better"), rows)


def _signed(value: float, unit: str) -> str:
    """A difference without its unit; of shares in percentage points."""
    if math.isinf(value):
        return "unbounded"
    text = f"{100.0 * abs(value):.1f}" if unit == "%" else bare(abs(value), unit)
    sign = "" if not text.strip("0.,") else "-" if value < 0.0 else "+"  # rounded to 0
    return f"{sign}{text}"


def comparison_values(comparisons: Sequence[Comparison], looked: bool = False) -> dict[str, Any]:
    """All comparisons in types that JSON knows; what is infinite or has no value is null."""
    values: dict[str, Any] = plain({
        "format": "physim-comparison",
        "version": 1,
        "units": "m, s; shares from 0 to 1; differences are b minus a",
        "confidence": 0.95,
        "number_of_runs_fixed_in_advance": not looked,
        "tests": {"rates": "McNemar, exact", "measures": "sign", "correction": "Holm"},
        "comparisons": [
            {
                "common": one.common,
                "verdict": headline(one),
                **{
                    key: {"label": arm.label, **dict(zip(CELL, arm.cell.names, strict=True))}
                    for key, arm in (("a", one.a), ("b", one.b))
                },
                "seeds": one.seeds,
                "seeds_only_a": one.a.alone,
                "seeds_only_b": one.b.alone,
                "failed_a": one.a.failed,
                "failed_b": one.b.failed,
                "unlike": one.unlike,
                "findings": [
                    {**asdict(f), "ties": f.ties, "tested": f.is_tested, "better": f.better or None}
                    for f in one.findings
                ],
            }
            for one in comparisons
        ],
    })  # fmt: skip
    return values
