"""Courses of many robots over time on one axis: a line each, or quantile bands of a crowd."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.plots.frame import short
from physim.plots.style import BAND, CYCLE, INK, robot_colour
from physim.record import Record

MOST_LINES = 12
"""Robots that are drawn one by one; of more, bands are drawn."""
QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
"""Shares of the robots below the lines of a band."""


def draw_courses(axis: Any, record: Record, time: FloatArray, values: FloatArray) -> list[Any]:
    """Draw values (K, N) of robots over time (K,); returns the handles of a legend.

    Of more than `MOST_LINES` robots: the median, bands of half and of nine tenths of them, and
    the outermost values.
    """
    if values.shape[1] <= MOST_LINES:
        return [
            axis.plot(time, values[:, i], label=short(record.names[i]), **robot_line(i))[0]
            for i in range(values.shape[1])
            if np.isfinite(values[:, i]).any()
        ]
    return draw_bands(axis, time, values, f"{values.shape[1]} robots")


def draw_bands(axis: Any, time: FloatArray, values: FloatArray, of: str) -> list[Any]:
    """Bands of the quantiles of values (K, M) over time (K,), and the handles of their legend."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # moments without any value
        quantile = np.nanquantile(values, QUANTILES, axis=1)
    outer = axis.plot(time, quantile[0], color=INK, linewidth=0.6, label="least, greatest")[0]
    axis.plot(time, quantile[-1], color=INK, linewidth=0.6)
    shades = ((1, -2, 0.25, "middle 90 %"), (2, -3, 0.45, "middle 50 %"))
    bands = [
        axis.fill_between(
            time, quantile[low], quantile[high], color=BAND, alpha=alpha, linewidth=0.0, label=label
        )
        for low, high, alpha, label in shades
    ]
    median = axis.plot(time, quantile[3], color=BAND, linewidth=1.5, label=f"median of\n{of}")[0]
    return [median, bands[1], bands[0], outer]


def robot_line(index: int) -> dict[str, Any]:
    """Colour and dashes of a robot's line; dashed where colours come again."""
    dashes = ("-", (0, (4, 1.5)), (0, (1, 1)))
    return {
        "color": robot_colour(index),
        "linestyle": dashes[index // len(CYCLE) % len(dashes)],
        "linewidth": 1.1,
    }
