"""Collision times of many robots: a row each, in shades of the shortest of each stretch."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.geometry.shapes import FloatArray, IntArray
from physim.plots.frame import name_rows, row_ends
from physim.plots.style import QUIET
from physim.record import Record

CLASSES = (0.2, 0.5, 1.0, 2.0, 3.0, 5.0)
"""[s] between two shades"""
SHADES = ("#440154", "#46327e", "#365c8d", "#277f8e", "#4ac16d", "#a0da39", "#f4e96b")
"""of the colour map viridis, the shortest times darkest"""
MOST_ROWS = 40
"""Robots whose rows are named, each with its shortest collision time."""


def stretches(record: Record, rows: Any, count: int) -> tuple[FloatArray, IntArray]:
    """Edges (count + 1,) [steps] of equal stretches of the run, and that of each decision."""
    edges = np.linspace(0.0, max(record.steps_run, 1), count + 1)
    place = np.searchsorted(edges, rows["step"], side="right") - 1
    return edges, np.clip(place, 0, count - 1)


def least_of_stretches(record: Record, rows: Any, count: int) -> tuple[FloatArray, FloatArray]:
    """Edges (count + 1,) [steps] of equal stretches of the run, and shortest times (N, count) [s].

    NaN where no decision of a robot foresaw a collision. ``rows`` are decisions that did.
    """
    edges, place = stretches(record, rows, count)
    least = np.full((record.robots, count), np.inf)
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
    name_rows(axis, record, MOST_ROWS if few else 20, 7.5, most=10)
    if few:
        shortest = np.fmin.reduce(least, axis=1)
        words = [f"{value:.2f} s" if np.isfinite(value) else None for value in shortest]
        row_ends(axis, "least", words, (shortest == np.fmin.reduce(shortest)).tolist(), "least")
    shown = [k for k in range(len(SHADES)) if (shade == k).any()]
    handles = [Patch(facecolor=SHADES[k], label=_words(k)) for k in shown]
    if np.isnan(least).any():
        handles.append(Patch(facecolor="none", edgecolor=QUIET, linewidth=0.5, label="none ahead"))
    return handles


def _words(shade: int) -> str:
    if shade == 0:
        return f"below {CLASSES[0]:g} s"
    if shade == len(CLASSES):
        return f"{CLASSES[-1]:g} s and more"
    return f"{CLASSES[shade - 1]:g} to {CLASSES[shade]:g} s"
