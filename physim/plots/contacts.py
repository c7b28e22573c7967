"""Contacts on time axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from physim.metrics import contact_episodes, grazes
from physim.plots.style import VERMILION
from physim.record import Record


def mark_contacts(axes: Sequence[Any], record: Record) -> list[Any]:
    """A band for as long as each contact lasts, with a line where it begins; dots for grazes.

    Returns the handles of a legend. All lie under the curves.
    """
    episodes, between = contact_episodes(record), grazes(record)
    style: dict[str, Any] = {"color": VERMILION, "linewidth": 1.1, "zorder": 0.6}
    handles = []
    for axis in axes:
        for episode in episodes:
            last = episode.time + (episode.samples - 1) * record.dt
            axis.axvspan(episode.time, last, color=VERMILION, alpha=0.15, linewidth=0.0, zorder=0.5)
        label = f"contact ({len(episodes)})"
        lines = [axis.axvline(episode.time, label=label, **style) for episode in episodes]
        label = f"graze ({len(between)})"
        dots = [axis.axvline(graze.time, linestyle=":", label=label, **style) for graze in between]
        handles = [*lines[:1], *dots[:1]]
    return handles
