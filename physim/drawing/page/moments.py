"""Moments of a run that are worth a look: where what was measured was smallest or largest."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.analysis.metrics import Metric
from physim.analysis.summary import Summary
from physim.drawing.labels import clean, metres
from physim.drawing.timeline import Timeline

MOMENTS = (
    ("shortest_distance", "shortest distance"),
    ("shortest_boundary_distance", "nearest to a wall"),
    ("shortest_collision_time", "shortest collision time"),
    ("first_contact", "first contact"),
    ("deepest_contact", "deepest contact"),
    ("formation_error_peak", "largest formation error"),
    ("farthest_distance", "farthest pair"),
)
"""Metrics that are of a moment, and what they are called."""
CONTACTS = ("first_contact", "deepest_contact")


def moments(timeline: Timeline, summary: Summary) -> list[dict[str, Any]]:
    """What there is to look at: label, words, time [s], and the robot or contact to ask why."""
    found = []
    for name, label in MOMENTS:
        metric = summary.metrics.get(name)
        if metric is None or metric.time is None:
            continue
        one = {"label": label, "time": float(metric.time), "words": _words(summary, metric)}
        contact = _contact(timeline, metric) if name in CONTACTS else None
        found.append(
            {**one, "robot": _who(timeline, metric)} if contact is None
            else {**one, "contact": contact}
        )  # fmt: skip
    return found


def _contact(timeline: Timeline, metric: Metric) -> int | None:
    """Number of the contact of these bodies that lasts at that time."""
    contacts, time = timeline.contacts, metric.time or 0.0
    same = (contacts.bodies == metric.bodies).all(axis=1) & ~contacts.swept
    same &= (contacts.began <= time + 1e-6) & (time < contacts.ended - 1e-6)
    rows = np.flatnonzero(same)
    return int(rows[0]) if len(rows) else None


def _who(timeline: Timeline, metric: Metric) -> int | None:
    """The robot to ask: of two the one that was behind along the reference path."""
    robots = [body for body in metric.bodies if body < timeline.robots]
    if not robots:
        return None
    stations = timeline.record.course[int(timeline.sample(metric.time or 0.0)), :, 2]
    return min(robots, key=lambda i: (stations[i], -i))


def _words(summary: Summary, metric: Metric) -> str:
    value = metres(metric.value) if metric.unit == "m" else f"{metric.value:.2f} {metric.unit}"
    who = " and ".join(clean(name) for name in summary.names_of(*metric.bodies))
    if metric.value == metric.time:
        return f"{value} ({who})"
    return f"{value} ({who}) at {metric.time:.2f} s"
