"""What a sweep says when it ends: counts of each cell, and the runs to look at."""

from __future__ import annotations

import shlex
from collections.abc import Collection, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.campaigns.columns import FAILED
from physim.campaigns.outcomes import Cell, Outcomes
from physim.campaigns.report.wording import over_seeds
from physim.campaigns.spec import Label
from physim.campaigns.sweep import Tally
from physim.errors import plural
from physim.statistics import Decision

MOST_NAMED = 10
"""Runs that are named"""


def counts_of(outcomes: Outcomes, draws: Mapping[Label, str]) -> list[dict[str, Any]]:
    """What came of every cell, with all rows that there are of it, and what the seed draws."""
    return [{**_count(outcomes, label), "draws": words} for label, words in draws.items()]


def _count(outcomes: Outcomes, label: Label) -> dict[str, Any]:
    names = dict(zip(("world", "settings", "controller"), label, strict=True))
    rows = np.concatenate([np.zeros(0, np.int64), *(_rows(one) for one in _cells(outcomes, label))])
    codes, words = outcomes.ended
    ends = [words[code] for code in codes[rows]]
    return {
        **names,
        "runs": len(rows),
        "contact_free": int(np.count_nonzero(outcomes.contact_free[rows])),
        "finished": int(np.count_nonzero(outcomes.finished[rows])),
        "failed": sum(ends.count(word) for word in FAILED),
        **{word: ends.count(word) for word in FAILED},
    }


def to_look_at(outcomes: Outcomes, labels: Collection[Label]) -> NDArray[np.int64]:
    """Rows with a contact, then those that failed, then those that did not finish where some did.

    In a cell in which no run finished it says nothing of a run that it did not either.
    """
    found = []
    for label in labels:
        for cell in _cells(outcomes, label):
            rows = _rows(cell)
            unfinished = ~outcomes.finished[rows]
            if unfinished.all():
                unfinished = outcomes.failed[rows]
            found.append(rows[outcomes.touched[rows] | outcomes.failed[rows] | unfinished])
    every = np.concatenate([np.zeros(0, np.int64), *found])
    order = np.where(outcomes.failed[every], 1, np.where(outcomes.touched[every], 0, 2))
    return every[np.argsort(order, kind="stable")]


def what_came(row: Mapping[str, Any]) -> str:
    """What there is to look at in a run, in a few words."""
    if row["ended"] in FAILED:
        return f"{row['ended']}: {row['reason']}" if row["reason"] else str(row["ended"])
    said = []
    if row["contacts"] or row["grazes"]:
        when = row["first_contact"]
        said.append("contact" if when is None else f"contact at {when:.2f} s")
        if row["first_contact_pair"]:
            said[-1] += f" ({row['first_contact_pair']})"
    if row["ended"] != "finished":
        said.append("not finished")
    return ", ".join(said)


def sweep_text(folder: Path, outcomes: Outcomes, draws: Mapping[Label, str], tally: Tally) -> str:
    """A line for each cell, where the rows are, and the first runs to look at.

    ``draws`` are the cells, and in words what the seed draws in each.
    """
    lines = []
    for one in counts_of(outcomes, draws):
        label = ", ".join(one[key] for key in ("world", "settings", "controller") if one[key])
        reasons = [f"{one[key]} {key}" for key in FAILED if one[key]]
        failed = f", {one['failed']} crashed ({', '.join(reasons)})" if one["failed"] else ""
        lines.append(
            f"{label}: {plural(one['runs'], 'run')}, {one['contact_free']} contact-free, "
            f"{one['finished']} finished{failed}"
        )
        if over := over_seeds(one["runs"], one["draws"]):
            lines.append(f"  {over}")
    before = (
        f" ({tally.before} {'was' if tally.before == 1 else 'were'} there before)"
        if tally.before
        else ""
    )
    lines.append(f"{plural(tally.known, 'run')}{before}; rows in {folder}/results.parquet")
    rows, where = to_look_at(outcomes, draws), shlex.quote(str(folder))
    if len(rows):
        shown = [outcomes.row(int(k)) for k in rows[:MOST_NAMED]]
        lines += ["to look at:", *(f"  {_named(row)}: {what_came(row)}" for row in shown)]
        if (more := len(rows) - len(shown)) > 0:
            lines.append(f"  … and {more:,} more: physim report {where}")
        own = shown[0]["controller"]
        code = f" --controller {shlex.quote(own)}" if ":" in own else ""
        lines.append(f"the first of them watched: physim replay {where}:{shown[0]['run']}{code}")
    return "\n".join(lines) + "\n"


def sweep_values(
    folder: Path,
    outcomes: Outcomes,
    draws: Mapping[Label, str],
    tally: Tally,
    decisions: Mapping[Label, Decision],
) -> dict[str, Any]:
    """The same for programs."""
    cells = counts_of(outcomes, draws)
    for one, label in zip(cells, draws, strict=True):
        found = decisions.get(label)
        one["decision"] = None if found is None else asdict(found)
    rows = to_look_at(outcomes, draws)
    keys = ("world", "settings", "controller", "seed", "run", "ended")
    return {
        "format": "physim-sweep",
        "version": 1,
        "folder": str(folder),
        "asked": tally.asked,
        "there_before": tally.before,
        "run_now": tally.done,
        "run_elsewhere_meanwhile": tally.elsewhere,
        "interrupted": tally.interrupted,
        "cells": cells,
        "to_look_at": {
            "runs": len(rows),
            "first": [
                {**{key: row[key] for key in keys}, "what": what_came(row)}
                for row in (outcomes.row(int(k)) for k in rows[:MOST_NAMED])
            ],
        },
    }


def _cells(outcomes: Outcomes, label: Label) -> list[Cell]:
    return [cell for cell in outcomes.cells if cell.names == label]


def _rows(cell: Cell) -> NDArray[np.int64]:
    return np.arange(cell.start, cell.stop)


def _named(row: Mapping[str, Any]) -> str:
    parts = (row["world"], row["settings"], row["controller"], f"seed {row['seed']}")
    return ", ".join(part for part in parts if part)
