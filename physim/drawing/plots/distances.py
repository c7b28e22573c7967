"""Distances over time: the least of all, with contacts, above those of the pairs of robots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from physim import tolerances
from physim.analysis.metrics import Figures, pair_distances
from physim.drawing.plots.curves import draw_bands
from physim.drawing.plots.frame import (
    LONGEST_NAME,
    USUAL,
    Paper,
    finished,
    framed,
    mark,
    names_of,
    nothing,
    thinned,
    time_axis,
    zero_line,
)
from physim.drawing.plots.style import BAND, CONTACT, INK, QUIET, WIDTHS
from physim.record import Record
from physim.units import amount, true_minus

STRIP = 0.035
"""Share of an axis, above its top, that shows when there is any contact."""
NARROWEST = 0.003
"""Share of the axis: spans are at least as wide, and gaps as narrow are closed."""
FEW_PAIRS, MOST_PAIRS = 6, 66
"""Pairs that have a line each, those of 4 robots; and a band, those of 12. Of more robots there are
bands of the distances to the nearest other"""


def mark_contacts(axes: Sequence[Any], record: Record) -> list[Any]:
    """A strip above each axis, filled for as long as there is any contact, outside of the curves.

    Swept contacts have a mark there. Returns the handles of a legend.
    """
    from matplotlib.collections import PolyCollection

    run = Figures(record)
    ends = [(e.time, e.time + (e.samples - 1) * record.dt) for e in run.episodes]
    spans = merged(ends, NARROWEST * max(record.steps_made, 1) * record.dt)
    low, high = 1.0, 1.0 + STRIP
    corners = [[(a, low), (b, low), (b, high), (a, high)] for a, b in spans]
    handles: list[Any] = []
    for axis in axes:
        outside = {"transform": axis.get_xaxis_transform(), "clip_on": False, "color": CONTACT}
        strip = PolyCollection(corners, linewidth=0.0, label=f"contact ({len(ends)})",
                               gid="contacts", **outside)  # fmt: skip
        handles = []
        if ends:
            handles.append(axis.add_collection(strip, autolim=False))
        times = [graze.time for graze in run.grazes]
        if times:
            handles += axis.plot(
                times, [1.0 + STRIP / 2.0] * len(times), "D", markersize=3.0,
                label=f"contact between samples ({len(times)})", **outside,
            )  # fmt: skip
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


def distances(record: Record, paper: Paper = USUAL) -> Any:
    """Figure: the least distances above those of all pairs of robots [m], over time [s].

    Above: the least of all robots to another and to a wall, down to 0; below 0 are depths. Below:
    each pair, or a band of all, and the largest; of many robots bands of each robot's distance to
    its nearest other.
    """
    figure = framed(record, "Distances", "Figs. 3b, 6c", paper=paper, height=4.1)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    above.set_ylabel("least of all [m]")
    below.set_ylabel("between robots [m]")
    time_axis(below, record)
    handles = _least(above, record) + _pairs(below, record)
    return finished(figure, handles + mark_contacts((above, below), record), 3)


def _pairs(axis: Any, record: Record) -> list[Any]:
    """Distances of every pair with the largest marked; bands of a crowd."""
    if record.robots < 2 or not record.samples:
        nothing(axis, "one robot alone" if record.robots == 1 else "no sample was recorded")
        return []
    is_alone = record.moving == record.robots
    if record.robots * (record.robots - 1) // 2 > MOST_PAIRS:
        rows = np.unique(np.linspace(0, record.samples - 1, 1000).astype(int))
        handles = draw_bands(
            axis, record.time[rows], record.clearance[rows],
            "nearest-robot distances" if is_alone else "distances to the nearest that moves",
        )  # fmt: skip
        axis.set_ylabel("to the nearest robot [m]" if is_alone else "to the nearest [m]")
    else:
        (time, values), _ = pair_distances(record)
        if values.shape[1] <= FEW_PAIRS:
            handles = axis.plot(time, values, color=QUIET, linewidth=0.7)[:1]
            handles[0].set_label("each pair")
        else:
            ends, how = (values.min(axis=1), values.max(axis=1)), {"color": BAND, "alpha": 0.25}
            handles = [axis.fill_between(time, *ends, linewidth=0.0, label="all pairs", **how)]
        farthest = Figures(record).farthest
        if farthest is not None:
            who = names_of(record, [farthest.a, farthest.b])
            mark(
                axis,
                farthest.time,
                farthest.value,
                f"farthest {amount(farthest.value, 'm')} ({who})",
            )
    axis.set_ylim(0.0, 1.3 * axis.get_ylim()[1])
    return list(handles)


def _least(axis: Any, record: Record) -> list[Any]:
    """Least distance over all robots to another robot and to a wall; a ring is at each minimum."""
    run = Figures(record)
    others = "robot to robot" if record.moving == record.robots else "robot to what moves"
    curves = (
        (record.clearance, INK, others, run.nearest),
        (record.boundary_clearance, WIDTHS, "robot to wall", run.nearest_wall),
    )
    handles: list[Any] = []
    for values, colour, label, shortest in curves:
        least = values.min(axis=1) if values.size else np.zeros(0)
        if np.isfinite(least).any():
            time, least = thinned(np.asarray(record.time), least)
            handles += axis.plot(time, least, color=colour, label=label, linewidth=1.0)
            if shortest is not None:
                who = names_of(record, [shortest.a, shortest.b])
                apart = " " if len(who) <= LONGEST_NAME else "\n"
                # bodies that touch within the tolerance are 0 apart
                value = shortest.value if abs(shortest.value) > tolerances.CONTACT else 0.0
                text = true_minus(f"least {amount(value, 'm')}")
                handles[-1].set_label(f"{label}, {text}{apart}({who})")
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
