"""Named metrics of a run as plain numbers, and the few that only the experiments need."""

from __future__ import annotations

import math

import numpy as np

from physim.metrics import evaluations
from physim.metrics import measure as take
from physim.metrics.way import active_time
from physim.record import Record

GROUP = (
    "contacts", "shortest_distance", "shortest_boundary_distance", "farthest_distance", "finished",
    "time_to_finish", "danger_share", "mode_switches", "averaged_speed_min", "formation_error_peak",
    "updates_per_second", "messages",
)  # fmt: skip
"""Metrics that experiments with a group compare."""


def figures(record: Record, *names: str) -> dict[str, float]:
    """Metrics by name; nan where one has no meaning for the run."""
    found = take(record, names)
    values = {name: found[name].value if name in found else None for name in names}
    return {name: math.nan if value is None else float(value) for name, value in values.items()}


def rule_shares(record: Record) -> dict[str, float]:
    """Shares of decisions by (12) and by (13); nan where the controller has no such rule."""
    names = [rule.name for rule in record.declared.rules]
    given = record.updates["rule"]
    found = {}
    for key, name in (("by_distance", "distance"), ("by_time", "time")):
        known = name in names and len(given)
        found[key] = float(np.mean(given == names.index(name))) if known else math.nan
    return found


def measure_group(record: Record) -> dict[str, float]:
    """What experiments with a group compare: safety, arrival, modes, formation and work.

    ``kept`` is the shortest distance [m] of any robot to another or to a wall; ``updates``,
    ``messages`` and ``evaluations`` (collision times computed) are per robot and second until it
    has arrived.
    """
    found = figures(record, *GROUP)
    distances = (found["shortest_distance"], found["shortest_boundary_distance"])
    seconds = float(active_time(record).sum()) or math.nan
    computed = evaluations(record)
    return {
        **found,
        "kept": min((value for value in distances if not math.isnan(value)), default=math.nan),
        "updates": found["updates_per_second"],
        "messages": found["messages"] / seconds,
        "evaluations": (math.nan if computed is None else computed) / seconds,
        **rule_shares(record),
    }
