"""A report as text for the terminal, and as values for `--json`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from physim.campaigns.report.contents import (
    SEVERITY,
    CellReport,
    Failure,
    Rate,
    Report,
    Unfinished,
    title_of,
)
from physim.campaigns.report.wording import (
    RATE_NAMES,
    decision_words,
    interval,
    measured,
    method,
    missing_words,
    note_of,
    number,
    of_cells,
    over_seeds,
    pair_and_time,
    percent,
    robots_words,
    severity_words,
)
from physim.errors import plural
from physim.escaping import escaped

LONGEST_REASON = 160
MOST_SEEDS = 5
TOLD = (
    "least_distance",
    "closing_speed",
    "time_to_finish",
    "deviation_peak",
    "formation_error_peak",
)
"""Measures that the text tells; the page and the values have all."""


def report_text(report: Report, commands: list[str]) -> str:
    """All cells, what did not finish or crashed, and the worst, whose ``commands`` show them."""
    lines = [*opening(report), ""]
    for one in report.cells:
        lines += [*_cell(report, one), ""]
    if report.unfinished:
        lines.append("runs that did not finish, with the robots that had not arrived (runs):")
        lines += [f"  {unfinished_line(one)}" for one in report.unfinished]
        lines.append("")
    if report.failures:
        lines.append("runs that crashed, each counted above as neither contact-free nor finished:")
        lines += [f"  {failure_line(one)}" for one in report.failures]
        lines.append("")
    if report.worst:
        lines.append(f"the severest contacts, then the least distances{of_cells(report)}:")
        for index, again in zip(report.worst, commands, strict=False):  # then those of the stuck
            row = report.outcomes.row(index)
            lines.append(
                f"  {severity_words(row):>9}  {escaped(where(row))}, "
                f"{escaped(run_name(row))}: {escaped(again)}"
            )
        lines.append("")
    lines.append(method(report.goal))
    return "\n".join(lines) + "\n"


def opening(report: Report) -> list[str]:
    """How many runs of how many cells, and what made them."""
    failed = sum(one.failed for one in report.cells)
    seeds = report.outcomes.seed
    between = f", seeds {seeds.min()} to {seeds.max()}" if len(seeds) else ""
    line = f"{number(report.runs)} runs of {plural(len(report.cells), 'cell')}{between}"
    if failed:
        line += f"; {plural(failed, 'run')} crashed"
    lines = [f"{escaped(report.title)}: {line}", escaped(", ".join(report.versions()))]
    return [*lines, escaped(missing_words(report.missing))] if report.missing else lines


def _cell(report: Report, one: CellReport) -> Iterator[str]:
    counts = {
        "with contacts": one.touched, "did not finish": one.unfinished, "crashed": one.failed,
    }  # fmt: skip
    some = [f"{number(count)} {what}" for what, count in counts.items() if count]
    of = f", of which {', '.join(some)}" if some else ""
    yield f"{escaped(one.cell.name)}: {plural(one.cell.count, 'run')}{of}"
    if over := over_seeds(one.cell.count, one.draws):
        yield f"  {escaped(over)}"
    told = ""
    for rate in one.rates:
        yield f"  {RATE_NAMES[rate.name]:<26}{rate_text(rate)}"
        if one.decision is not None and report.goal is not None and rate.name == report.goal.rate:
            yield f"  {'':<26}{decision_words(one.decision, report.goal)}"
        note = note_of(rate)
        if note and note != told:  # one line stands for rates that have the same
            yield f"  {'':<26}{note}"
        told = note
    for name in (*TOLD, *report.outcomes.own):
        spread = one.spread(name)
        if spread.count:
            what, unit = title_of(name)
            values = [measured(name, x, unit) for x in (spread.median, spread.least, spread.most)]
            of = "" if spread.count == one.cell.count else f", of {spread.count} that have one"
            yield f"  {what:<26}median {values[0]}, {values[1]} to {values[2]}{of}"


def rate_text(rate: Rate) -> str:
    """``98 of 100 = 98.0 % [92.9 %, 99.8 %]``."""
    return (
        f"{number(rate.good)} of {number(rate.of)} = {percent(rate.share)} "
        f"{interval(rate.low, rate.high)}"
    )


def where(row: dict[str, Any]) -> str:
    """``r1, r2 at 3.20 s``: of the severest contact, or else of the least distance."""
    pair, time = pair_and_time(row)
    return f"{pair} at {time:.2f} s" if time is not None else pair


def run_name(row: dict[str, Any]) -> str:
    """World, settings, controller and seed of a run."""
    names = [row[name] for name in ("world", "settings", "controller") if row[name]]
    return f"{', '.join(names)}, seed {row['seed']}"


def unfinished_line(one: Unfinished) -> str:
    """Runs of a cell that did not finish, in one line."""
    return (
        f"{plural(len(one.seeds), 'run')} of {escaped(one.cell.name)}, {seeds_text(one.seeds)}: "
        f"{escaped(robots_words(one.stood, one.moved, len(one.seeds)))}"
    )


def failure_line(one: Failure) -> str:
    """Runs of a cell that crashed alike, in one line."""
    reason = escaped(one.reason)
    if len(reason) > LONGEST_REASON:
        reason = reason[: LONGEST_REASON - 1] + "…"
    return (
        f"{plural(len(one.seeds), 'run')} of {escaped(one.cell.name)}, {seeds_text(one.seeds)}: "
        f"{escaped(one.ended)}{': ' if reason else ''}{reason}"
    )


def seeds_text(seeds: tuple[int, ...]) -> str:
    """``seeds 3, 8, 9 and 12 more``."""
    shown = ", ".join(str(seed) for seed in seeds[:MOST_SEEDS])
    more = len(seeds) - MOST_SEEDS
    return f"seed{'s' if len(seeds) > 1 else ''} {shown}" + (
        f" and {more} more" if more > 0 else ""
    )


def report_values(report: Report) -> dict[str, Any]:
    """All figures, in types that JSON knows; nan is null. Units: m, s; shares from 0 to 1."""
    near = report.outcomes.column("least_distance")
    return {
        "format": "physim-campaign-report",
        "version": 1,
        "units": "m, s; shares from 0 to 1",
        "title": report.title,
        "runs": report.runs,
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
                "world": one.cell.world,
                "settings": one.cell.settings,
                "controller": one.cell.controller,
                "runs": one.cell.count,
                "failed": one.failed,
                "with_contacts": one.touched,
                "unfinished": one.unfinished,
                "draws": one.draws,
                "rates": [
                    {"share": plain(rate.share), **{k: plain(v) for k, v in asdict(rate).items()}}
                    for rate in one.rates
                ],
                "measures": {
                    spread.name: {
                        k: plain(v) for k, v in asdict(spread).items() if k != "name"
                    }
                    for spread in one.spreads
                },
                "decision": None if one.decision is None else asdict(one.decision),
            }
            for one in report.cells
        ],
        "worst": [
            {"run": (row := report.outcomes.row(index))["run"], "name": run_name(row),
             "least_distance": plain(near[index]), **{name: row[name] for name in SEVERITY}}
            for index in report.worst
        ],
        "unfinished": [
            {"cell": one.cell.name, "seeds": list(one.seeds), "stood": dict(one.stood),
             "moved": dict(one.moved)}
            for one in report.unfinished
        ],
        "failures": [
            {"cell": one.cell.name, "ended": one.ended, "reason": one.reason,
             "seeds": list(one.seeds)}
            for one in report.failures
        ],
    }  # fmt: skip


def plain(value: Any) -> Any:
    """A number that JSON knows; nan and infinity are null."""
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
