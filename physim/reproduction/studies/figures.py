"""Named metrics of a run as plain numbers, and the few that only the experiments need."""

from __future__ import annotations

import math

import numpy as np

from physim.metrics import evaluations, messages, updates_per_second
from physim.metrics import measure as take
from physim.metrics.way import active_time
from physim.record import Record


def figures(record: Record, *names: str) -> dict[str, float]:
    """Metrics by name; nan where one has no meaning for the run."""
    found = take(record, names)
    values = {name: found[name].value if name in found else None for name in names}
    return {name: _number(value) for name, value in values.items()}


def safety(record: Record) -> dict[str, float]:
    """Contacts, and the shortest distance [m] of any robot to another or to a wall."""
    found = figures(record, "contacts", "shortest_distance", "shortest_boundary_distance")
    kept = (found["shortest_distance"], found["shortest_boundary_distance"])
    known = [value for value in kept if not math.isnan(value)]
    return {
        "contacts": found["contacts"],
        "kept": min(known) if known else math.nan,
        "between_robots": found["shortest_distance"],
    }


def rule_shares(record: Record) -> dict[str, float]:
    """Shares of decisions by (12) and by (13); nan where the controller has no such rule."""
    names = [rule.name for rule in record.declared.rules]
    given = record.updates["rule"]
    found = {}
    for key, name in (("by_distance", "distance"), ("by_time", "time")):
        known = name in names and len(given)
        found[key] = float(np.mean(given == names.index(name))) if known else math.nan
    return found


def work(record: Record) -> dict[str, float]:
    """Updates, messages and collision times worked out, each a second of a robot under way."""
    seconds = float(active_time(record).sum())
    updates = updates_per_second(record)
    each = seconds if seconds > 0.0 else math.nan
    return {
        "updates": math.nan if updates is None else updates.value,
        "messages": _number(messages(record)) / each,
        "evaluations": _number(evaluations(record)) / each,
    }


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)
