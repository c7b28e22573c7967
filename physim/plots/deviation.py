"""Signed deviation of each robot from its own path over time (Figs. 1b, 2c, 7d)."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.metrics import column_over_time, deviation_peak, deviation_rms, deviations
from physim.plots.courses import draw_courses
from physim.plots.frame import framed, legend_beside, mark, names_of, nothing, time_axis, zero_line
from physim.plots.style import RULE
from physim.record import Record

SHARP = 0.5
"""[rad] A path that turns by more within `CORNER` has a sharp turn there."""
CORNER = 1.0
"""[m]"""


def deviation(record: Record) -> Any:
    """Figure: deviation [m] over time [s], left of the path positive, its peak marked."""
    figure = framed(record, "Deviation from the path", "Figs. 1b, 2c, 7d")
    axis = figure.subplots()
    axis.set_ylabel("deviation [m], left positive")
    time_axis(axis, record)
    peak, rms = deviation_peak(record), deviation_rms(record)
    if peak is None:
        nothing(axis, "no decision was recorded")
        return figure
    turns = _mark_turns(axis, record) if record.robots == 1 else []
    zero_line(axis)
    handles = draw_courses(axis, record, *deviations(record))
    axis.margins(y=0.2)
    text = f"{peak.value:+.2f} m ({names_of(record, [peak.a])})"
    mark(axis, peak.time, peak.value, text, below=peak.value < 0.0)
    if rms is not None:
        axis.set_title(f"root mean square {rms.value:.2f} m", loc="right", fontsize=8.5)
    legend_beside(figure, [*handles, *turns])
    return figure


def _mark_turns(axis: Any, record: Record) -> list[Any]:
    """Shade when a robot alone was within its look-ahead of a sharp turn of its path."""
    time, station = column_over_time(record, "station")
    shades = []
    for turn in sharp_turns(record.paths.points):
        near = np.flatnonzero(np.abs(station[:, 0] - turn) <= 2.0)
        if len(near):
            ends = time[near[[0, -1]]]
            label = "sharp turn of\nthe path ± 2 m"
            shades.append(axis.axvspan(*ends, color=RULE, alpha=0.7, linewidth=0.0, label=label))
    return shades[:1]


def sharp_turns(points: FloatArray) -> list[float]:
    """Stations [m] at which a polyline (n, 2) turns sharply: by more than `SHARP` at a point."""
    along = np.diff(points, axis=0)
    station = np.concatenate(([0.0], np.cumsum(np.hypot(*along.T))))
    heading = np.arctan2(along[:, 1], along[:, 0])
    return [
        float(station[k + 1])
        for k, (a, b) in enumerate(pairwise(heading))
        if abs((b - a + np.pi) % (2 * np.pi) - np.pi) > SHARP
    ]
