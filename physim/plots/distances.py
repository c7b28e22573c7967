"""Distances over time: of all pairs of robots, and the least of all; minima and contacts marked."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.metrics import (
    farthest_pair,
    pair_distances,
    shortest_boundary_distance,
    shortest_distance,
)
from physim.plots.contacts import mark_contacts
from physim.plots.courses import draw_bands
from physim.plots.frame import (
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
from physim.plots.style import INK, QUIET
from physim.record import Record

MOST_PAIRS = 66
"""Pairs that are drawn one by one: those of 12 robots; of more, bands of the nearest ones."""


def distances(record: Record) -> Any:
    """Figure: distances of all pairs of robots above the least distances [m], over time [s].

    Above: each pair, or of many robots bands of each robot's distance to its nearest other, and
    the largest. Below: the least of all robots to another and to a wall; below 0 are depths.
    """
    figure = framed(record, "Distances", "Figs. 3b, 6c", height=4.4)
    above, below = figure.subplots(2, 1, sharex=True)
    above.set_ylabel("between robots [m]")
    below.set_ylabel("least of all [m]")
    time_axis(below, record)
    handles = _pairs(above, record)
    handles += _least(below, record)
    handles += mark_contacts((above, below), record)
    legend_beside(figure, handles)
    clear_marks(figure)
    return figure


def _pairs(axis: Any, record: Record) -> list[Any]:
    """Distances of every pair, thin, with the largest marked; bands of a crowd."""
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
        handles = axis.plot(time, values, color=QUIET, linewidth=0.5, alpha=0.7)[:1]
        handles[0].set_label("each pair")
        if farthest is not None:
            who = names_of(record, [farthest.a, farthest.b])
            mark(axis, farthest.time, farthest.value, f"farthest {farthest.value:.3g} m ({who})")
    axis.set_ylim(0.0, 1.12 * axis.get_ylim()[1])
    return list(handles)


def _least(axis: Any, record: Record) -> list[Any]:
    """Least distance over all robots to another robot and to a wall, each with its minimum."""
    wall = shortest_boundary_distance(record)
    curves = (
        (record.clearance, INK, "-", "robot to robot", shortest_distance(record)),
        (record.boundary_clearance, QUIET, "--", "robot to wall", wall),
    )
    handles, marked = [], []
    for values, colour, dash, label, shortest in curves:
        least = values.min(axis=1) if values.size else np.zeros(0)
        if np.isfinite(least).any():
            time, least = thinned(np.asarray(record.time), least)
            handles += axis.plot(time, least, dash, color=colour, label=label, linewidth=1.0)
            if shortest is not None:
                who = names_of(record, [shortest.a, shortest.b])
                who = who if len(who) <= LONGEST_NAME else who.replace(" and ", "\nand ")
                handles[-1].set_label(f"{label},\nleast {shortest.value:.3g} m\n({who})")
                marked.append((shortest, colour))
    if not handles:
        nothing(axis, "no sample was recorded")
        return []
    zero_line(axis)
    axis.margins(y=0.2)
    low = min((shortest.value for shortest, _ in marked), default=0.0)
    close = len(marked) == 2 and abs(marked[0][0].time - marked[1][0].time) < 0.3 * record.time[-1]
    bottom, top = axis.get_ylim()
    axis.set_ylim(min(bottom, low - 0.32 * (top - low)), top)  # room for the words
    level = len(marked) == 2 and abs(marked[0][0].value - marked[1][0].value) < 0.1 * (top - low)
    for row, (shortest, colour) in enumerate(sorted(marked, key=lambda pair: pair[0].value)):
        text, below = f"{shortest.value:.3g} m", level or not close or row == 0
        place = row * (level and close)
        mark(axis, shortest.time, shortest.value, text, below=below, colour=colour, row=place)
    return handles
