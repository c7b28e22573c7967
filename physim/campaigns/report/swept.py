"""What a sweep says when it ends: counts of each cell, and the runs to look at."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.campaigns.folder import RESULTS
from physim.campaigns.outcomes import CELL, Outcomes
from physim.campaigns.report.text import decision_words, over_seeds, replay, run_name
from physim.campaigns.rows import FAILED, FINISHED, Row
from physim.campaigns.spec import Label
from physim.campaigns.sweep import Tally
from physim.errors import plural
from physim.statistics import Decision, Goal
from physim.units import interval

MOST_NAMED = 10
"""Runs that are named"""


def sweep_text(folder: Path, outcomes: Outcomes, draws: Mapping[Label, str], tally: Tally) -> str:
    """A line for each cell, where the rows are, and the first runs to look at.

    ``draws`` are the cells, and in words what the seed draws in each.
    """
    lines = []
    for one in counts_of(outcomes, draws):
        reasons = ", ".join(f"{one[key]} {key}" for key in FAILED if one[key])
        failed = f", {one['failed']} crashed ({reasons})" if reasons else ""
        lines.append(
            f"{', '.join(one[key] for key in CELL if one[key])}: {plural(one['runs'], 'run')}, "
            f"{one['contact_free']} contact-free, {one['finished']} finished{failed}"
        )
        if over := over_seeds(one["runs"], one["draws"]):
            lines.append(f"  {over}")
    were = "was" if tally.before == 1 else "were"
    before = f" ({tally.before} {were} there before)" if tally.before else ""
    lines.append(f"{plural(tally.known, 'run')}{before}; rows in {folder}/{RESULTS}")
    rows = to_look_at(outcomes, draws)
    if len(rows):
        shown = [outcomes.rows[k] for k in rows[:MOST_NAMED]]
        lines += ["to look at:", *(f"  {run_name(row)}: {what_came(row)}" for row in shown)]
        if (more := len(rows) - len(shown)) > 0:
            lines.append(f"  … and {more:,} more: physim report {shlex.quote(str(folder))}")
        lines.append(f"to watch the first: {replay(str(folder), outcomes, shown[0])}")
    return "\n".join(lines) + "\n"


def sweep_values(
    folder: Path,
    outcomes: Outcomes,
    draws: Mapping[Label, str],
    tally: Tally,
    decisions: Mapping[Label, Decision],
) -> dict[str, Any]:
    """The same for programs."""
    rows = to_look_at(outcomes, draws)
    keys = ("world", "settings", "controller", "seed", "run", "ended")
    return {
        "format": "physim-sweep",
        "version": 1,
        "folder": str(folder),
        "asked": tally.asked,
        "there_before": tally.before,
        "run_now": tally.done,
        "interrupted": tally.interrupted,
        "cells": [
            {**one, "decision": asdict(decisions[label]) if label in decisions else None}
            for one, label in zip(counts_of(outcomes, draws), draws, strict=True)
        ],
        "to_look_at": {
            "runs": len(rows),
            "first": [
                {**{key: getattr(row, key) for key in keys}, "what": what_came(row)}
                for row in (outcomes.rows[k] for k in rows[:MOST_NAMED])
            ],
        },
    }


def decided_text(label: Label, one: Decision, goal: Goal) -> str:
    """A line of what came of the goal in a cell."""
    text = f"{decision_words(one, goal)}, {goal.rate} in {interval(one.low, one.high)} at any look"
    more = "" if one.decided else "; more --seeds may decide it"
    return f"{', '.join(filter(None, label))}: {text}{more}\n"


def disagreeing(outcomes: Outcomes) -> list[str]:
    """A line for each of the first runs that were validated and in which the checks disagree."""
    rows = [row for row in outcomes.rows if row.verdict.startswith("checks disagree")]
    return [f"{run_name(row)}: {row.verdict}" for row in rows[:MOST_NAMED]]


def counts_of(outcomes: Outcomes, draws: Mapping[Label, str]) -> list[dict[str, Any]]:
    """What came of every cell, with all rows that there are of it, and what the seed draws."""
    found = []
    for label, drawn in draws.items():
        rows = _rows(outcomes, label)
        ends = Counter(outcomes.rows[k].ended for k in rows)
        found.append({
            **dict(zip(CELL, label, strict=True)),
            "runs": len(rows),
            "contact_free": int(np.count_nonzero(outcomes.contact_free[rows])),
            "finished": int(np.count_nonzero(outcomes.finished[rows])),
            "failed": sum(ends[word] for word in FAILED),
            **{word: ends[word] for word in FAILED},
            "draws": drawn,
        })  # fmt: skip
    return found


def to_look_at(outcomes: Outcomes, labels: Iterable[Label]) -> NDArray[np.int64]:
    """Rows with a contact, then those that failed, then those that did not finish where some did.

    In a cell in which no run finished it says nothing of a run that it did not either.
    """
    found = [np.zeros(0, np.int64)]
    for label in labels:
        rows = _rows(outcomes, label)
        late = ~outcomes.finished[rows]
        late = late & ~late.all()
        found.append(rows[outcomes.touched[rows] | outcomes.failed[rows] | late])
    every = np.concatenate(found)
    order = np.where(outcomes.failed[every], 1, np.where(outcomes.touched[every], 0, 2))
    return every[np.argsort(order, kind="stable")]


def _rows(outcomes: Outcomes, label: Label) -> NDArray[np.int64]:
    found = [np.arange(one.start, one.stop) for one in outcomes.cells if one.names == label]
    return found[0] if found else np.zeros(0, np.int64)


def what_came(row: Row) -> str:
    """What there is to look at in a run, in a few words."""
    if row.failed:
        return f"{row.ended}: {row.reason}" if row.reason else row.ended
    said = []
    if row.contacts or row.grazes:
        when = row.first_contact
        said.append("contact" if when is None else f"contact at {when:.2f} s")
        if row.first_contact_pair:
            said[-1] += f" ({row.first_contact_pair})"
    return ", ".join([*said, *["not finished"] * (row.ended != FINISHED)])
