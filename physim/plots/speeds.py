"""Rotational and forward speed of each robot, averaged over 10 s (Figs. 1c, 7b, 7c)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from physim.metrics import averaged_speeds, world_settings
from physim.metrics.motion import WINDOW
from physim.plots.courses import draw_courses
from physim.plots.frame import framed, keep_span, legend_beside, nothing, time_axis, zero_line
from physim.plots.style import QUIET
from physim.record import Record


def speeds(record: Record) -> Any:
    """Figure: averaged rotational [rad/s] above averaged forward speed [m/s] over time [s]."""
    figure = framed(record, f"Speeds averaged over {WINDOW:.0f} s", "Figs. 1c, 7b, 7c", height=4.3)
    above, below = figure.subplots(2, 1, sharex=True)
    above.set_ylabel("rotational speed [rad/s]\nleft turn positive")
    below.set_ylabel("forward speed [m/s]")
    time_axis(below, record)
    found = averaged_speeds(record)
    if not np.isfinite(found.forward).any():
        for axis in (above, below):
            nothing(axis, f"no robot was under way for {WINDOW:.0f} s")
        return figure
    zero_line(above)
    _limits(below, record)
    draw_courses(above, record, found.time, found.rotational)
    legend_beside(figure, draw_courses(below, record, found.time, found.forward))
    for axis in (above, below):
        keep_span(axis, 0.2)
    return figure


def _limits(axis: Any, record: Record) -> None:
    """Steady speed and limits of the formation, where the world has one."""
    plan = world_settings(record).get("formation")
    if not isinstance(plan, Mapping):
        return
    for value in (*plan.get("limits", ()), plan.get("speed")):
        if isinstance(value, int | float) and not isinstance(value, bool):
            axis.axhline(value, color=QUIET, linewidth=0.8, linestyle=(0, (5, 3)), zorder=1.5)
    axis.set_title("dashed: steady speed and limits of (7)", loc="right", fontsize=8.0, color=QUIET)
