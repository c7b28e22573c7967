"""Small multiples: an axis a robot, of the same scale, where curves on one axis would tangle.

Behind the curve of a robot lies what all robots do at the time, from the least to the greatest.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from physim.drawing.crowd import MOST_LINES
from physim.drawing.plots.frame import keep_span, short, time_axis
from physim.drawing.plots.style import INK, QUIET, RULE, robot_colour
from physim.geometry.shapes import FloatArray
from physim.record import Record

MOST_TOGETHER = 4
"""Robots whose curves share an axis; those of more would tangle."""
ROW = 0.52
"""[in] height of an axis"""
AROUND = 0.95
"""[in] for title, axis of time and source"""
LONGEST = 9
"""Characters of a name."""


class Quantity(NamedTuple):
    """Values of N robots over time, and what they are."""

    label: str
    time: FloatArray
    """(K,) [s]"""
    values: FloatArray
    """(K, N)"""
    least_span: float = 0.0
    """which the axes are to show at least: noise must not look like an event"""
    zero: bool = False
    """whether a line stands at 0"""


def apart(record: Record) -> bool:
    """Whether each robot has an axis of its own."""
    return MOST_TOGETHER < record.robots <= MOST_LINES


def height(record: Record, columns: int) -> float:
    """Height [in] of a figure of an axis a robot in so many columns."""
    return AROUND + ROW * -(-record.robots // columns)


def draw_apart(figure: Any, record: Record, quantities: Sequence[Quantity]) -> Any:
    """Draw an axis a robot; returns the axes (robots, quantities), robots by index.

    One quantity fills two columns of axes, row by row; of several each has a column.
    """
    columns = max(2, len(quantities))
    rows = -(-record.robots // (columns if len(quantities) == 1 else 1))
    grid = figure.subplots(rows, columns, sharex=True, sharey=len(quantities) == 1 or "col",
                           squeeze=False)  # fmt: skip
    axes = grid.reshape(-1, 1) if len(quantities) == 1 else grid
    for k, quantity in enumerate(quantities):
        low, high = _envelope(quantity.values)
        for robot in range(record.robots):
            axis = axes[robot, k]
            axis.fill_between(quantity.time, low, high, color=RULE, linewidth=0.0)
            if quantity.zero:
                axis.axhline(0.0, color=QUIET, linewidth=0.6, zorder=1.5)
            axis.plot(quantity.time, quantity.values[:, robot], color=robot_colour(robot),
                      linewidth=1.1, label=short(record.names[robot]))  # fmt: skip
            axis.tick_params(labelsize=7.5)
            time_axis(axis, record)
            if axis not in grid[-1]:
                axis.set_xlabel("")
            name = short(record.names[robot], LONGEST)
            if len(quantities) == 1:
                axis.set_title(name, fontsize=8.0, pad=1.5)
            elif k == columns - 1:
                axis.text(1.02, 0.5, name, transform=axis.transAxes, va="center", fontsize=8.0,
                          gid="name")  # fmt: skip
        keep_span(axes[0, k], quantity.least_span)
    for axis in axes[record.robots :].flat:
        axis.set_visible(False)
    for axis in grid[-1]:
        axis.tick_params(labelbottom=True)
    if len(quantities) == 1:
        figure.supylabel(quantities[0].label, fontsize=9.0, color=INK)
    else:
        for k, quantity in enumerate(quantities):
            axes[0, k].set_title(quantity.label, fontsize=8.0, pad=2.5)
    return axes


def _envelope(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least and greatest (K,) of finite values (K, N); NaN where there is none."""
    return np.fmin.reduce(values, axis=1), np.fmax.reduce(values, axis=1)
