"""Collision times of many robots: a row each, in shades of the shortest of each stretch."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.plots.frame import short
from physim.plots.style import INK, QUIET
from physim.record import Record

CLASSES = (0.2, 0.5, 1.0, 2.0, 3.0, 5.0)
"""[s] between two shades"""
SHADES = ("#440154", "#46327e", "#365c8d", "#277f8e", "#4ac16d", "#a0da39", "#f4e96b")
"""of the colour map viridis, the shortest times darkest"""
MOST_ROWS = 40
"""Robots whose rows are named, each with its shortest collision time."""


def least_of_stretches(record: Record, rows: Any, count: int) -> tuple[FloatArray, FloatArray]:
    """Edges (count + 1,) [steps] of equal stretches of the run, and shortest times (N, count) [s].

    NaN where no decision of a robot foresaw a collision. ``rows`` are decisions that did.
    """
    edges = np.linspace(0.0, max(record.steps_run, 1), count + 1)
    least = np.full((record.robots, count), np.inf)
    place = np.clip(np.searchsorted(edges, rows["step"], side="right") - 1, 0, count - 1)
    np.minimum.at(least, (rows["robot"], place), rows["collision_time"])
    return edges, np.where(np.isfinite(least), least, np.nan)


def draw_rows(axis: Any, record: Record, rows: Any, count: int) -> list[Any]:
    """Draw the rows; returns handles for the shades that occur."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    edges, least = least_of_stretches(record, rows, count)
    shade = np.where(np.isnan(least), np.nan, np.searchsorted(CLASSES, least, side="right"))
    axis.grid(False)
    axis.pcolormesh(
        edges * record.dt, np.arange(record.robots + 1) - 0.5, np.ma.masked_invalid(shade),
        cmap=ListedColormap(SHADES), vmin=-0.5, vmax=len(SHADES) - 0.5, rasterized=True,
    )  # fmt: skip
    axis.set_ylim(record.robots - 0.5, -0.5)
    few = record.robots <= MOST_ROWS
    named = range(0, record.robots, 1 if few else -(-record.robots // 20))
    axis.set_yticks(list(named), [short(record.names[i], 10) for i in named])
    axis.tick_params(axis="y", length=0, labelsize=7.5)
    axis.set_ylabel("robot")
    if few:
        _minima(axis, np.fmin.reduce(least, axis=1))
    shown = [k for k in range(len(SHADES)) if (shade == k).any()]
    handles = [Patch(facecolor=SHADES[k], label=_words(k)) for k in shown]
    if np.isnan(least).any():
        handles.append(Patch(facecolor="none", edgecolor=QUIET, linewidth=0.5, label="none ahead"))
    return handles


def _minima(axis: Any, shortest: FloatArray) -> None:
    """The shortest time of each robot behind its row, the shortest of all bold."""
    for robot, value in enumerate(shortest):
        if np.isfinite(value):
            axis.annotate(
                f"{value:.2f} s", (1.0, robot), xycoords=("axes fraction", "data"),
                xytext=(3, 0), textcoords="offset points", va="center", fontsize=7.5, color=INK,
                fontweight="bold" if value == np.nanmin(shortest) else "normal", gid="least",
            )  # fmt: skip
    axis.annotate(
        "least", (1.0, 1.0), xycoords="axes fraction", xytext=(3, 1), textcoords="offset points",
        fontsize=7.5, color=QUIET, va="bottom",
    )  # fmt: skip


def _words(shade: int) -> str:
    if shade == 0:
        return f"below {CLASSES[0]:g} s"
    if shade == len(CLASSES):
        return f"{CLASSES[-1]:g} s and more"
    return f"{CLASSES[shade - 1]:g} to {CLASSES[shade]:g} s"
