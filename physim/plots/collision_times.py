"""Collision times at the decisions over time (Figs. 3c, 6d)."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.metrics import shortest_collision_time
from physim.plots.contacts import mark_contacts
from physim.plots.courses import MOST_LINES
from physim.plots.frame import framed, legend_beside, mark, names_of, nothing, short, time_axis
from physim.plots.style import QUIET, robot_mark
from physim.record import Record

FLOOR = 0.01
"""[s] Least collision time on the axis; smaller ones, and contact, lie on it."""
MOST_MARKS = 4_000
"""Decisions drawn of one robot, or of a crowd; of more, the shortest of each stretch of them."""


def collision_times(record: Record) -> Any:
    """Figure: collision time [s] of each decision that foresaw one, over time [s], log axis."""
    from matplotlib.ticker import LogLocator, NullFormatter

    figure = framed(record, "Collision times at decisions", "Figs. 3c, 6d")
    axis = figure.subplots()
    axis.set_ylabel("collision time [s]")
    time_axis(axis, record)
    rows = record.updates[np.isfinite(record.updates["collision_time"])]
    shortest = shortest_collision_time(record)
    if shortest is None:
        times = record.updates["collision_time"]
        unknown = len(times) and np.isnan(times).all()
        why = "the controller reports none" if unknown else "no decision foresaw a collision"
        nothing(axis, why)
        return figure
    handles = []
    single = record.robots <= MOST_LINES
    for robot in range(record.robots if single else 1):
        mine = rows[rows["robot"] == robot] if single else rows
        if not len(mine):
            continue
        colour, marker = robot_mark(robot) if single else (QUIET, "o")
        handles += axis.plot(
            *_shortest_of_stretches(mine["step"] * record.dt, mine["collision_time"]), marker,
            color=colour, markersize=2.4, markeredgewidth=0.0, rasterized=True, linestyle="none",
            label=short(record.names[robot]) if single else f"decisions of\n{record.robots} robots",
        )  # fmt: skip
    axis.set_yscale("log")
    axis.set_ylim(min(0.5 * max(shortest.value, FLOOR), 0.5), 1.25 * rows["collision_time"].max())
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.yaxis.set_major_formatter("{x:g}")
    axis.yaxis.set_minor_formatter(NullFormatter())
    handles += mark_contacts([axis], record)
    text = f"{shortest.value:.3g} s ({names_of(record, [shortest.a])})"
    mark(axis, shortest.time, max(shortest.value, FLOOR), text, below=True)
    legend_beside(figure, handles, marks=2.0)
    return figure


def _shortest_of_stretches(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """At most `MOST_MARKS` of the values: the least of each stretch, so no dip is lost."""
    edges = np.linspace(0, len(values), MOST_MARKS + 1).astype(int)
    if len(values) > MOST_MARKS:
        at = [a + int(np.argmin(values[a:b])) for a, b in pairwise(edges)]
        time, values = time[at], values[at]
    return time, np.maximum(values, FLOOR)
