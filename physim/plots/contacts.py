"""Contacts on time axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from physim.metrics import contact_episodes, grazes
from physim.plots.style import CONTACT
from physim.record import Record

MOST_BANDS = 12
"""Contacts that have a band and a line each; more would cover the curves."""
STRIP = 0.035
"""Share of an axis, at its top, that shows when there is any contact."""
NARROWEST = 0.003
"""Share of the axis: spans are at least as wide, and gaps as narrow are closed."""


def mark_contacts(axes: Sequence[Any], record: Record) -> list[Any]:
    """A strip at the top of each axis, filled for as long as there is any contact.

    Of few contacts each has a pale band and a line where it begins, too; grazes have a dotted
    line, or of many a mark in the strip. Returns the handles of a legend. All lie under the curves.
    """
    episodes, between = contact_episodes(record), grazes(record)
    ends = [(e.time, e.time + (e.samples - 1) * record.dt) for e in episodes]
    least = NARROWEST * max(record.steps_run, 1) * record.dt
    handles: list[Any] = []
    for axis in axes:
        handles = []
        if ends:
            label = f"contact ({len(ends)})"
            handles.append(_strip(axis, merged(ends, least), label))
        for begin, end in ends if len(ends) <= MOST_BANDS else ():
            axis.axvspan(begin, end, color=CONTACT, alpha=0.15, linewidth=0.0, zorder=0.5)
            axis.axvline(begin, color=CONTACT, linewidth=1.1, zorder=0.6)
        low = 0.0 if len(between) <= MOST_BANDS else 1.0 - STRIP
        style: dict[str, Any] = {"color": CONTACT, "linewidth": 1.1, "zorder": 0.6}
        label = f"graze ({len(between)})"
        dots = [axis.axvline(g.time, low, linestyle=":", label=label, **style) for g in between]
        handles += dots[:1]
    return handles


def merged(spans: Sequence[tuple[float, float]], least: float) -> list[tuple[float, float]]:
    """Spans (begin, end) [s] joined where they overlap or less than ``least`` [s] lies between.

    In order, each at least ``least`` long.
    """
    joined: list[tuple[float, float]] = []
    for begin, end in sorted(spans):
        end = max(end, begin + least)
        if joined and begin <= joined[-1][1] + least:
            joined[-1] = (joined[-1][0], max(joined[-1][1], end))
        else:
            joined.append((begin, end))
    return joined


def _strip(axis: Any, spans: list[tuple[float, float]], label: str) -> Any:
    """The spans in a strip just above the axis; outside, so that it covers no curve."""
    from matplotlib.collections import PolyCollection

    low, high = 1.0, 1.0 + STRIP
    corners = [[(a, low), (b, low), (b, high), (a, high)] for a, b in spans]
    strip = PolyCollection(
        corners, facecolor=CONTACT, linewidth=0.0, transform=axis.get_xaxis_transform(),
        clip_on=False, label=label, gid="contacts",
    )  # fmt: skip
    return axis.add_collection(strip, autolim=False)
