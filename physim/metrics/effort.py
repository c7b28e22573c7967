"""What the decisions cost: updates, messages, collision times worked out (14)."""

from __future__ import annotations

import numpy as np

from physim.metrics.modes import time_under_way
from physim.metrics.values import Each
from physim.metrics.way import under_way
from physim.record import Record


def decisions(record: Record) -> int | None:
    """Number of decisions of all robots; None where they were not recorded."""
    return len(record.updates) if "updates" in record.tables else None


def messages(record: Record) -> int | None:
    """Messages that the decisions needed: one for each considered robot and decision, (14)."""
    return None if decisions(record) is None else int(record.updates["considered"].sum())


def evaluations(record: Record) -> int | None:
    """Collision times worked out; None where the controller does not tell."""
    told = record.column("evaluations")
    return int(np.nansum(told)) if np.isfinite(told).any() else None


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
    """Decisions a second under way [1/s], of a mean robot and of each, (14)."""
    rows, _ = under_way(record)
    count, seconds = np.bincount(rows["robot"], minlength=record.robots), time_under_way(record)
    if not seconds.sum() > 0:
        return None
    each = tuple(float(c / s) if s > 0 else None for c, s in zip(count, seconds, strict=True))
    return Each(float(count.sum() / seconds.sum()), each)
