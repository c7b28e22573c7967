"""What the decisions cost: updates, messages, collision times worked out (14)."""

from __future__ import annotations

import numpy as np

from physim.metrics.values import Each
from physim.metrics.way import active_decisions, active_time, ratio
from physim.record import Record


def decisions(record: Record) -> int | None:
    """Number of decisions of all robots; None where they were not recorded."""
    return len(record.updates) if "updates" in record.tables else None


def messages(record: Record) -> int | None:
    """Messages that the decisions needed: one for each considered robot and decision, (14)."""
    return None if decisions(record) is None else int(record.updates["considered"].sum())


def evaluations(record: Record) -> int | None:
    """Collision times worked out; None where the controller does not report them."""
    count = record.column("evaluations")
    return int(np.nansum(count)) if np.isfinite(count).any() else None


def filtered_steps(record: Record) -> int:
    """Robot-steps over which the filtered command differs from the nominal one."""
    return _differing(record, "nominal", "filtered")


def disturbed_steps(record: Record) -> int:
    """Robot-steps over which the applied command differs from the filtered one."""
    return _differing(record, "filtered", "applied")


def _differing(record: Record, one: str, other: str) -> int:
    rows = record.commands  # at every step at which any stage differs from another
    differ = rows[f"{one}_v"] != rows[f"{other}_v"]
    return int((differ | (rows[f"{one}_omega"] != rows[f"{other}_omega"])).sum())


def updates_per_second(record: Record) -> Each | None:
    """Decisions a second of active time [1/s], of a mean robot and of each, (14)."""
    rows, _ = active_decisions(record)
    return ratio(np.bincount(rows["robot"], minlength=record.robots), active_time(record))
