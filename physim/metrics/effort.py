"""What the decisions cost: updates, messages, collision times worked out (14)."""

from __future__ import annotations

import numpy as np

from physim.metrics.modes import time_under_way
from physim.metrics.values import Each
from physim.metrics.way import under_way
from physim.record import Record


def decisions(record: Record) -> int:
    """Number of decisions of all robots."""
    return len(record.updates)


def messages(record: Record) -> int:
    """Messages that the decisions needed: one for each considered robot and decision, (14)."""
    return int(record.updates["considered"].sum())


def evaluations(record: Record) -> int:
    """Collision times worked out."""
    return int(record.updates["evaluations"].sum())


def updates_per_second(record: Record) -> Each | None:
    """Decisions a second under way [1/s], of a mean robot and of each, (14)."""
    rows, _ = under_way(record)
    count, seconds = np.bincount(rows["robot"], minlength=record.robots), time_under_way(record)
    if not seconds.sum() > 0:
        return None
    each = tuple(float(c / s) if s > 0 else None for c, s in zip(count, seconds, strict=True))
    return Each(float(count.sum() / seconds.sum()), each)
