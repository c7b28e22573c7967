"""Distances over time: the least of all, with contacts, above those of the pairs of robots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from physim import tolerances
from physim.analysis.metrics import (
    contact_episodes,
    farthest_pair,
    grazes,
    pair_distances,
    shortest_boundary_distance,
    shortest_distance,
)
from physim.drawing.labels import plain, true_minus
from physim.drawing.plots.curves import draw_bands
from physim.drawing.plots.frame import (
    LONGEST_NAME,
    clear_marks,
    framed,
    legend_beside,
    mark,
    names_of,
    nothing,
    thinned,
    time_axis,
    zero_line,
)
from physim.drawing.plots.style import BAND, CONTACT, INK, QUIET, WIDTHS
from physim.record import Record

MOST_BANDS = 12
"""Contacts that have a band and a line each; more would cover the curves."""
STRIP = 0.035
"""Share of an axis, at its top, that shows when there is any contact."""
NARROWEST = 0.003
"""Share of the axis: spans are at least as wide, and gaps as narrow are closed."""


def mark_contacts(axes: Sequence[Any], record: Record) -> list[Any]:
    """A strip at the top of each axis, filled for as long as there is any contact.

    Of few contacts each has a pale band and a line where it begins, too; swept contacts have a
    dotted line, or of many a mark in the strip. All lie under the curves. Returns the handles of a
    legend.
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
        label = f"between samples ({len(between)})"
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


FEW_PAIRS, MOST_PAIRS = 6, 66
"""Pairs that have a line each, those of 4 robots; and a band, those of 12. Of more robots there are
bands of the distances to the nearest other"""


def distances(record: Record) -> Any:
    """Figure: the least distances above those of all pairs of robots [m], over time [s].

    Above: the least of all robots to another and to a wall, down to 0; below 0 are depths. Below:
    each pair, or a band of all, and the largest; of many robots bands of each robot's distance to
    its nearest other.
    """
    figure = framed(record, "Distances", "Figs. 3b, 6c", height=4.4)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    above.set_ylabel("least of all [m]")
    below.set_ylabel("between robots [m]")
    time_axis(below, record)
    handles = _least(above, record) + _pairs(below, record)
    handles += mark_contacts((above, below), record)
    legend_beside(figure, handles)
    clear_marks(figure)
    return figure


def _pairs(axis: Any, record: Record) -> list[Any]:
    """Distances of every pair with the largest marked; bands of a crowd."""
    farthest = farthest_pair(record)
    if record.robots < 2 or not record.samples:
        nothing(axis, "one robot alone" if record.robots == 1 else "no sample was recorded")
        return []
    if record.robots * (record.robots - 1) // 2 > MOST_PAIRS:
        rows = np.unique(np.linspace(0, record.samples - 1, 1000).astype(int))
        handles = draw_bands(
            axis, record.time[rows], record.clearance[rows], "nearest-robot\ndistances"
        )
        axis.set_ylabel("to the nearest robot [m]")
    else:
        (time, values), _ = pair_distances(record)
        if values.shape[1] <= FEW_PAIRS:
            handles = axis.plot(time, values, color=QUIET, linewidth=0.7)[:1]
            handles[0].set_label("each pair")
        else:
            ends, how = (values.min(axis=1), values.max(axis=1)), {"color": BAND, "alpha": 0.25}
            handles = [axis.fill_between(time, *ends, linewidth=0.0, label="all pairs", **how)]
        if farthest is not None:
            who = names_of(record, [farthest.a, farthest.b])
            mark(axis, farthest.time, farthest.value, f"farthest {plain(farthest.value)} m ({who})")
    axis.set_ylim(0.0, 1.3 * axis.get_ylim()[1])
    return list(handles)


def _least(axis: Any, record: Record) -> list[Any]:
    """Least distance over all robots to another robot and to a wall; a ring is at each minimum."""
    wall = shortest_boundary_distance(record)
    curves = (
        (record.clearance, INK, "-", "robot to robot", shortest_distance(record)),
        (record.boundary_clearance, WIDTHS, "-", "robot to wall", wall),
    )
    handles: list[Any] = []
    for values, colour, dash, label, shortest in curves:
        least = values.min(axis=1) if values.size else np.zeros(0)
        if np.isfinite(least).any():
            time, least = thinned(np.asarray(record.time), least)
            handles += axis.plot(time, least, dash, color=colour, label=label, linewidth=1.0)
            if shortest is not None:
                who = names_of(record, [shortest.a, shortest.b])
                who = who if len(who) <= LONGEST_NAME else who.replace(" and ", "\nand ")
                least_of = _metres(shortest.value)
                handles[-1].set_label(f"{label},\nleast {least_of}\n({who})")
                axis.plot(
                    shortest.time, shortest.value, "o", color=colour, markersize=4.5,
                    markerfacecolor="white", zorder=5, clip_on=False,
                )  # fmt: skip
    if not handles:
        nothing(axis, "no sample was recorded")
        return []
    zero_line(axis)
    axis.margins(y=0.08)
    return handles


def _metres(value: float) -> str:
    """A distance as labels have it; of bodies that touch within the tolerance 0."""
    return true_minus(f"{plain(value if abs(value) > tolerances.CONTACT else 0.0)} m")
