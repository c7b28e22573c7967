"""Collision times of all pairs under their present commands over time (Figs. 3c, 6d)."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.metrics.pair_times import HORIZON, pair_collision_times
from physim.plots.frame import framed, mark, names_of, nothing, time_axis
from physim.plots.style import INK
from physim.record import Record

FLOOR = 0.01
"""[s] least collision time on the axis"""


def pair_times(record: Record) -> Any:
    """Figure: least collision time [s] of all pairs at each step with decisions, log axis."""
    figure = framed(record, "Collision times of all pairs", "Figs. 3c, 6d")
    axis = figure.subplots()
    axis.set_ylabel("least of all pairs [s]")
    time_axis(axis, record)
    (time, least), pairs = pair_collision_times(record)
    known = np.isfinite(least)
    if not known.any():
        nothing(axis, f"no two robots would meet within {HORIZON:g} s")
        return figure
    first = int(np.argmin(least))
    shortest = float(least[first])
    axis.plot(
        time[known], np.maximum(least[known], FLOOR), "o", color=INK, markersize=2.2,
        markeredgewidth=0.0, rasterized=True,
    )  # fmt: skip
    axis.set_yscale("log")
    axis.set_ylim(0.5 * max(shortest, FLOOR), 1.25 * HORIZON)
    axis.set_yticks([v for v in (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10) if v > 0.5 * shortest])
    axis.yaxis.set_major_formatter("{x:g}")
    axis.minorticks_off()
    axis.set_title(f"none within {HORIZON:g} s: not drawn", loc="right", fontsize=8.0)
    text = f"{shortest:.3g} s ({names_of(record, pairs[first].astype(int))})"
    mark(axis, float(time[first]), max(shortest, FLOOR), text, below=True)
    return figure
