"""Distances and collision time over time, contacts marked."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.metrics import contact_episodes, grazes
from physim.plots.style import BLUE, GREEN, INK, VERMILION, WIDTH
from physim.record import Record

MOST_POINTS = 4000
"""Points of a curve; of more samples the least of each stretch is drawn, so no dip is lost."""


def distances(record: Record) -> Any:
    """Figure: least distance robot to robot and robot to wall, and least collision time, over time.

    Distances below 0 are depths. Both are the least over all robots.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, 4.4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    figure.suptitle(
        f"{record.name}, seed {record.seed}: distances and collision time",
        x=0.01, ha="left", fontsize=10.5, fontweight="bold",
    )  # fmt: skip
    _distance_axis(above, record)
    _time_axis(below, record)
    _mark_contacts((above, below), record)
    above.legend(loc="upper left", bbox_to_anchor=(0.0, 1.16), ncols=4, borderaxespad=0.0)
    below.set_xlabel("time [s]")
    end = max(record.steps_run, 1) * record.dt
    below.set_xlim(0.0, end)
    return figure


def _distance_axis(axis: Any, record: Record) -> None:
    curves = (
        (record.clearance, BLUE, "-", "robot to robot"),
        (record.boundary_clearance, GREEN, "--", "robot to boundary or obstacle"),
    )
    for values, colour, dash, label in curves:
        least = values.min(axis=1) if values.size else np.zeros(0)
        if np.isfinite(least).any():
            time, least = thinned(np.asarray(record.time), least)
            axis.plot(time, least, dash, color=colour, label=label)
    axis.axhline(0.0, color=INK, linewidth=0.8)
    axis.set_ylabel("least distance [m]")


def _time_axis(axis: Any, record: Record) -> None:
    """Least finite collision time among the decisions of each step."""
    rows = record.updates
    known = np.isfinite(rows["collision_time"])
    steps, place = np.unique(rows["step"][known], return_inverse=True)
    least = np.full(len(steps), np.inf)
    np.minimum.at(least, place, rows["collision_time"][known])
    axis.set_ylabel("least collision\ntime [s]")
    axis.plot(steps * record.dt, least, ".", color=INK, markersize=2.5, markeredgewidth=0.0)
    if not len(steps):
        told = "no decision foresaw a collision"
        if np.isnan(rows["collision_time"]).all():
            told = "the controller reports no collision times"
        axis.text(0.5, 0.5, told, transform=axis.transAxes, ha="center", va="center",
                  backgroundcolor="white")  # fmt: skip
        axis.set_yticks([])
    else:
        axis.set_ylim(bottom=0.0)


def _mark_contacts(axes: tuple[Any, ...], record: Record) -> None:
    """A band for as long as each contact lasts, with a line where it begins; dots for grazes."""
    episodes = contact_episodes(record)
    between = grazes(record)
    for axis in axes:
        for k, episode in enumerate(episodes):
            label = f"contact ({len(episodes)})" if k == 0 and axis is axes[0] else None
            last = episode.time + (episode.samples - 1) * record.dt
            axis.axvspan(episode.time, last, color=VERMILION, alpha=0.15, linewidth=0.0, zorder=0.5)
            style = {"color": VERMILION, "linewidth": 1.1, "zorder": 0.6}  # under the curves
            axis.axvline(episode.time, label=label, **style)
        for k, graze in enumerate(between):
            named = k == 0 and axis is axes[0]
            label = f"graze ({len(between)})" if named else None
            style = {"color": VERMILION, "linewidth": 1.1, "zorder": 0.6}
            axis.axvline(graze.time, linestyle=":", label=label, **style)


def thinned(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """At most MOST_POINTS points, each the least of its stretch and at the time of that."""
    if len(values) <= MOST_POINTS:
        return time, values
    edges = np.linspace(0, len(values), MOST_POINTS + 1).astype(int)
    at = [a + int(np.argmin(values[a:b])) for a, b in zip(edges[:-1], edges[1:], strict=True)]
    return time[at], values[at]
