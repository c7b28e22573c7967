"""Formation error of each robot and formation energy over time (Figs. 2b, 7a; (9), (10))."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.metrics import (
    formation_energy,
    formation_error_final,
    formation_error_peak,
    formation_errors,
)
from physim.plots.courses import draw_courses
from physim.plots.frame import framed, legend_beside, mark, names_of, nothing, time_axis, zero_line
from physim.plots.style import INK
from physim.record import Record


def formation(record: Record) -> Any:
    """Figure: formation errors [m] above the formation energy W [m^2], over time [s]."""
    figure = framed(record, "Formation errors", "Figs. 2b, 7a", height=4.0)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(5, 2))
    above.set_ylabel("formation error [m]\nbehind its place positive")
    below.set_ylabel("energy W (9)\n[m²]")
    time_axis(below, record)
    course = formation_errors(record)
    peak, final = formation_error_peak(record), formation_error_final(record)
    if course is None or peak is None or final is None:
        why = "a robot alone has no formation" if record.robots == 1 else "no decision was recorded"
        if record.robots > 1 and course is None:
            why = "the world has no formation"
        nothing(above, why)
        nothing(below, why)
        return figure
    zero_line(above)
    handles = draw_courses(above, record, *course)
    k = int(np.argmin(np.abs(course.time - peak.time)))
    signed = float(course.values[k, peak.a])
    above.margins(y=0.2)
    value = float(np.copysign(peak.value, signed))
    text = f"{value:.2f} m ({names_of(record, [peak.a])})"
    mark(above, peak.time, value, text, below=value < 0.0)
    above.set_title(f"within {final.value:.2f} m of zero at the end", loc="right", fontsize=8.5)
    energy = formation_energy(record)
    if energy is None:
        nothing(below, "the robots did not decide together at the start")
    else:
        below.fill_between(energy.time, 0.0, energy.values, color=INK, alpha=0.15, linewidth=0.0)
        below.plot(energy.time, energy.values, color=INK, linewidth=1.0)
        below.set_ylim(bottom=0.0)
    legend_beside(figure, handles)
    return figure
