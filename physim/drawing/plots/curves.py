"""Curves of robots over time: a line each, from five on an axis each, or bands of a crowd.

Signed deviation of each robot from its own path (Figs. 1b, 2c, 7d), formation errors and
formation energy (Figs. 2b, 7a; (9), (10)), speeds averaged over 10 s (Figs. 1c, 7b, 7c).
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from physim.analysis.metrics import (
    averaged_speeds,
    deviation_peak,
    deviation_rms,
    deviations,
    formation_energy,
    formation_error_final,
    formation_error_peak,
    formation_errors,
    formation_parts,
)
from physim.analysis.metrics.motion import WINDOW
from physim.analysis.metrics.progress import samples_over_time
from physim.drawing.crowd import MOST_LINES, quantiles
from physim.drawing.labels import decimal, signed
from physim.drawing.plots.frame import (
    framed,
    keep_span,
    legend_beside,
    mark,
    names_of,
    nothing,
    short,
    time_axis,
    zero_line,
)
from physim.drawing.plots.multiples import Quantity, apart, draw_apart, height
from physim.drawing.plots.style import BAND, CYCLE, INK, NARROW, QUIET, RULE, WIDTH, robot_colour
from physim.geometry.shapes import FloatArray
from physim.record import Record


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
    quantile = quantiles(values)
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


SHARP = 0.5
"""[rad] A path that turns by more within `CORNER` has a sharp turn there."""
CORNER = 1.0
"""[m]"""


def deviation(record: Record) -> Any:
    """Figure: deviation [m] over time [s], left of the path positive, its peak marked."""
    each = apart(record)
    tall = height(record, 2) if each else 2.9
    figure = framed(record, "Deviation from the path", "Figs. 1b, 2c, 7d", height=tall)
    peak, rms = deviation_peak(record), deviation_rms(record)
    if each and peak is not None:
        course = deviations(record)
        label = "deviation [m], left positive"
        axes = draw_apart(figure, record, [Quantity(label, *course, zero=True)])[:, 0]
        low, high = axes[0].get_ylim()
        axes[0].set_ylim(low - 0.15 * (high - low), high + 0.15 * (high - low))
        where = axes[peak.a or 0]
        mark(where, peak.time, peak.value, f"{signed(peak.value)} m", inside=True)
        if rms is not None:
            axes[1].set_title(f"rms of all {rms.value:.2f} m", loc="right",
                              fontsize=8.0, pad=1.5)  # fmt: skip
        return figure
    axis = figure.subplots()
    axis.set_ylabel("deviation [m], left positive")
    time_axis(axis, record)
    if peak is None:
        nothing(axis, "no sample was recorded")
        return figure
    turns = _mark_turns(axis, record) if record.robots == 1 else []
    zero_line(axis)
    handles = draw_courses(axis, record, *deviations(record))
    axis.margins(y=0.2)
    text = f"{signed(peak.value)} m ({names_of(record, [peak.a])})"
    mark(axis, peak.time, peak.value, text, below=peak.value < 0.0)
    if rms is not None:
        axis.set_title(f"root mean square {rms.value:.2f} m", loc="right", fontsize=8.5)
    legend_beside(figure, [*handles, *turns])
    return figure


def _mark_turns(axis: Any, record: Record) -> list[Any]:
    """Shade when a robot alone was within its look-ahead of a sharp turn of its path."""
    time, station = samples_over_time(record, record.course[:, :, 0])
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
        why = "a robot alone has no formation" if record.robots == 1 else "no sample was recorded"
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
    text = f"{decimal(value, 2)} m ({names_of(record, [peak.a])})"
    mark(above, peak.time, value, text, below=value < 0.0)
    above.set_title(f"within {final.value:.2f} m of zero at the end", loc="right", fontsize=8.5)
    energy = formation_energy(record)
    parts = _mark_parts([above, below], record)
    if energy is not None:
        below.fill_between(energy.time, 0.0, energy.values, color=INK, alpha=0.15, linewidth=0.0)
        below.plot(energy.time, energy.values, color=INK, linewidth=1.0)
        below.set_ylim(bottom=0.0)
    legend_beside(figure, [*handles, *parts])
    return figure


def _mark_parts(axes: list[Any], record: Record) -> list[Any]:
    """Shade when no chain of neighbours connected all: W knows nothing of errors between parts."""
    course = formation_parts(record)
    if course is None:
        return []
    is_apart = np.concatenate([[False], course.values > 1.0, [False]])
    ends = np.flatnonzero(np.diff(is_apart)).reshape(-1, 2)
    last = len(course.time) - 1
    label = "not all connected:\nW omits errors\nbetween the parts"
    shades = [
        axis.axvspan(*course.time[[first, min(end, last)]], color=RULE, alpha=0.7, linewidth=0.0,
                     label=label, gid="parts")
        for axis in axes for first, end in ends
    ]  # fmt: skip
    return shades[:1]


def speeds(record: Record) -> Any:
    """Figure: averaged rotational [rad/s] above averaged forward speed [m/s] over time [s]."""
    found, each = averaged_speeds(record), apart(record)
    known = bool(np.isfinite(found.forward).any())
    tall, wide = (height(record, 1), WIDTH) if each and known else (4.3, NARROW)
    title = f"Speeds averaged over {WINDOW:.0f} s"
    figure = framed(record, title, "Figs. 1c, 7b, 7c", height=tall, width=wide)
    if each and known:
        turning = Quantity(
            "turning [rad/s], left positive", found.time, found.rotational, 0.2, True
        )
        forward = Quantity("forward [m/s]", found.time, found.forward, 0.2)
        for axis in draw_apart(figure, record, [turning, forward])[:, 1]:
            _limits(axis, record, told=False)
        return figure
    above, below = figure.subplots(2, 1, sharex=True)
    above.set_ylabel("rotational speed [rad/s]\nleft turn positive")
    below.set_ylabel("forward speed [m/s]")
    time_axis(below, record)
    if not known:
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


def _limits(axis: Any, record: Record, told: bool = True) -> None:
    """Steady speed and limits of the formation, where the world has one, ``told`` in a title."""
    plan = record.world_settings.get("formation")
    if not isinstance(plan, Mapping):
        return
    limits = plan.get("limits")
    for value in (*(limits if isinstance(limits, list) else ()), plan.get("speed")):
        if isinstance(value, int | float) and not isinstance(value, bool):
            axis.axhline(value, color=QUIET, linewidth=0.8, linestyle=(0, (5, 3)), zorder=1.5)
    if told:
        axis.set_title(
            "dashed: steady speed and limits of (7)", loc="right", fontsize=8.0, color=QUIET
        )
