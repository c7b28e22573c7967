"""Collision times at the decisions over time (Figs. 3c, 6d)."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.metrics import shortest_collision_time
from physim.metrics.values import Moment
from physim.plots.collision_rows import draw_rows, least_of_stretches, stretches
from physim.plots.contacts import mark_contacts
from physim.plots.frame import (
    framed,
    legend_beside,
    mark,
    names_of,
    nothing,
    short,
    thinned,
    time_axis,
)
from physim.plots.style import BAND, INK, NARROW, robot_mark
from physim.record import Record

FLOOR = 0.01
"""[s] Least collision time on the axis; smaller ones, and contact, lie on it."""
MOST_SINGLE = 4
"""Robots whose decisions are drawn one by one; those of more would cover each other."""
STRETCHES = 240
"""Stretches of the run of which many robots have one value each."""


def collision_times(record: Record) -> Any:
    """Figure: collision times [s] of the decisions that foresaw one, over time [s], log axis.

    Of up to `MOST_SINGLE` robots every decision. Of more: above, the shortest of all robots and a
    band of nine tenths of the decisions; below, a row a robot in shades of its shortest, with the
    least of the run at the end. The shortest of all is marked.
    """
    times = record.column("collision_time")
    rows = record.updates[np.isfinite(times)]
    shortest = shortest_collision_time(record)
    many = record.robots > MOST_SINGLE and shortest is not None
    tall = 2.9 + (min(4.6, 0.45 + 0.2 * record.robots) if many else 0.0)
    wide = 5.6 if many else NARROW
    title = "Collision times at decisions"
    figure = framed(record, title, "Figs. 3c, 6d", height=tall, width=wide)
    if many:
        axis, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, tall - 2.9))
    else:
        axis = below = figure.subplots()
    time_axis(below, record)
    axis.set_ylabel("collision time [s]")
    if shortest is None:
        unknown = len(times) and np.isnan(times).all()
        why = "the controller reports none" if unknown else "no decision foresaw a collision"
        nothing(axis, why)
        return figure
    handles = _together(axis, record, rows) if many else _one_by_one(axis, record, rows)
    _seconds(axis, shortest, float(rows["collision_time"].max()))
    handles += mark_contacts([axis], record)
    if many:
        handles += draw_rows(below, record, rows, STRETCHES)
    text = f"{shortest.value:.3g} s ({names_of(record, [shortest.a])})"
    mark(axis, shortest.time, max(shortest.value, FLOOR), text, below=True)
    legend_beside(figure, handles, marks=1.0 if many else 2.0)
    return figure


def _seconds(axis: Any, shortest: Moment, longest: float) -> None:
    """Logarithmic axis from below the shortest collision time to above the longest."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set_yscale("log")
    axis.set_ylim(min(0.5 * max(shortest.value, FLOOR), 0.5), 1.25 * longest)
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.yaxis.set_major_formatter("{x:g}")
    axis.yaxis.set_minor_formatter(NullFormatter())


def _one_by_one(axis: Any, record: Record, rows: Any) -> list[Any]:
    """A mark a decision, in the colours of the robots."""
    handles = []
    for robot in range(record.robots):
        mine = rows[rows["robot"] == robot]
        if not len(mine):
            continue
        colour, marker = robot_mark(robot)
        time, values = thinned(mine["step"] * record.dt, mine["collision_time"])
        handles += axis.plot(
            time, np.maximum(values, FLOOR), marker, color=colour, markersize=2.4,
            markeredgewidth=0.0, rasterized=True, linestyle="none",
            label=short(record.names[robot]),
        )  # fmt: skip
    return handles


def _together(axis: Any, record: Record, rows: Any) -> list[Any]:
    """The shortest of all robots in each stretch of the run, and where most decisions lie."""
    _, place = stretches(record, rows, STRETCHES)
    edges, least = least_of_stretches(record, rows, STRETCHES)
    order = np.lexsort((rows["collision_time"], place))
    counts = np.bincount(place, minlength=STRETCHES)
    first = np.concatenate(([0], np.cumsum(counts)[:-1]))
    values, known = rows["collision_time"][order], counts > 0
    low, high = (
        np.where(known, values[np.minimum(first + at, len(values) - 1)], np.nan)
        for at in ((0.05 * (counts - 1)).astype(int), np.ceil(0.95 * (counts - 1)).astype(int))
    )
    time, shortest = edges * record.dt, np.fmin.reduce(least, axis=0)
    how = {"step": "post", "linewidth": 0.0, "alpha": 0.3, "color": BAND}
    band = axis.fill_between(time, *(np.append(v, v[-1]) for v in (low, high)), **how)
    band.set_label("middle 90 % of\nthe decisions")
    line = axis.stairs(np.maximum(shortest, FLOOR), time, color=INK, linewidth=1.0, baseline=None)
    line.set_label("shortest of\nall robots")
    return [line, band]
