"""Curves of robots over time: a line each, or bands of a crowd.

Signed deviation of each robot from its own path (Figs. 1b, 2c, 7d; from five robots on an axis
each), formation errors and formation energy (Figs. 2b, 7a; (9), (10)), speeds averaged over 10 s
(Figs. 1c, 7b, 7c).
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from physim.analysis.metrics import (
    Figures,
    deviation_peak,
    deviations,
    formation_errors,
    formation_parts,
)
from physim.analysis.metrics.metric import section
from physim.analysis.metrics.motion import WINDOW
from physim.analysis.metrics.progress import samples_over_time
from physim.drawing.crowd import MOST_LINES, quantiles
from physim.drawing.plots.frame import (
    USUAL,
    Paper,
    finished,
    framed,
    mark,
    names_of,
    nothing,
    short,
    time_axis,
    zero_line,
)
from physim.drawing.plots.style import BAND, CYCLE, INK, NARROW, QUIET, RULE, robot_colour
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.units import true_minus
from physim.world import Formation

MOST_TOGETHER = 4
"""Robots whose deviations share an axis; those of more would tangle."""
ROW = 0.62
"""[in] height of an axis of one robot"""
LONGEST = 9
"""Characters of its name."""
SPAN = 0.2
"""[m/s], [rad/s] that axes of speeds show at least: noise must not look like an event"""
SHARP = 0.5
"""[rad] A path that turns by more at one of its points has a sharp turn there."""


def draw_courses(axis: Any, record: Record, time: FloatArray, values: FloatArray) -> list[Any]:
    """Draw values (K, N) of robots over time (K,); returns the handles of a legend.

    Of more than `MOST_LINES` robots: the median, bands of half and of nine tenths of them, and
    the outermost values. Lines are dashed where colours come again.
    """
    if values.shape[1] > MOST_LINES:
        return draw_bands(axis, time, values, f"{values.shape[1]} robots")
    dashes = ("-", (0, (4, 1.5)))
    return [
        axis.plot(
            time, values[:, i], color=robot_colour(i), linestyle=dashes[i // len(CYCLE)],
            linewidth=1.1, label=short(record.names[i]),
        )[0]
        for i in range(values.shape[1])
        if np.isfinite(values[:, i]).any()
    ]  # fmt: skip


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
    median = axis.plot(time, quantile[3], color=BAND, linewidth=1.5, label=f"median of {of}")[0]
    return [median, bands[1], bands[0], outer]


def deviation(record: Record, paper: Paper = USUAL) -> Any:
    """Figure: deviation [m] over time [s], left of the path positive, its peak marked.

    Of 5 to 12 robots each has an axis, of one scale; behind its curve lies what all robots do.
    """
    peak, rms = deviation_peak(record), Figures(record).metric("deviation_rms")
    apart = MOST_TOGETHER < record.robots <= MOST_LINES and peak is not None
    rows = -(-record.robots // 2)
    figure = framed(record, "Deviation from the path", "Figs. 1b, 2c, 7d", paper=paper,
                    height=0.6 + ROW * rows if apart else 2.6)  # fmt: skip
    label = "deviation [m], left positive"
    axes = [figure.subplots()] if not apart else _axes_apart(figure, record, rows)
    time_axis(axes[-1], record)
    if peak is None:
        nothing(axes[0], "no sample was recorded")
        return figure
    time, values = deviations(record)
    handles: list[Any] = []
    if apart:
        figure.supylabel(label, fontsize=9.0, color=INK)
        ends = np.fmin.reduce(values, axis=1), np.fmax.reduce(values, axis=1)
        for robot, axis in enumerate(axes):
            axis.fill_between(time, *ends, color=RULE, linewidth=0.0)
            axis.axhline(0.0, color=QUIET, linewidth=0.6, zorder=1.5)
            axis.plot(time, values[:, robot], color=robot_colour(robot), linewidth=1.1,
                      label=short(record.names[robot]))  # fmt: skip
    else:
        axes[0].set_ylabel(label)
        handles = _mark_turns(axes[0], record) if record.robots == 1 else []
        zero_line(axes[0])
        handles = draw_courses(axes[0], record, time, values) + handles
    axes[0].margins(y=0.35 if apart else 0.2)
    who = "" if apart else f" ({names_of(record, [peak.a])})"
    mark(axes[(peak.a or 0) if apart else 0], peak.time, peak.value,
         f"{true_minus(f'{peak.value:+z.2f}')} m{who}", below=peak.value < 0.0)  # fmt: skip
    if rms is not None:
        words = f"rms of all {rms.value:.2f} m" if apart else f"root mean square {rms.value:.2f} m"
        axes[1 if apart else 0].set_title(words, loc="right", fontsize=8.0, pad=1.5)
    return finished(figure, handles)


def _axes_apart(figure: Any, record: Record, rows: int) -> list[Any]:
    """An axis a robot, in two columns, row by row."""
    grid = figure.subplots(rows, 2, sharex=True, sharey=True)
    axes: list[Any] = list(grid.flat)
    for axis in axes[record.robots :]:
        axis.set_visible(False)
    for axis, name in zip(axes, record.names, strict=False):
        axis.tick_params(labelsize=7.5)
        axis.set_title(short(name, LONGEST), fontsize=8.0, pad=1.5)
    for axis in grid[-1]:
        time_axis(axis, record)
        axis.tick_params(labelbottom=True)
    return axes[: record.robots]


def _mark_turns(axis: Any, record: Record) -> list[Any]:
    """Shade when a robot alone was within its look-ahead of a sharp turn of its path."""
    time, station = samples_over_time(record, record.course[:, :, 0])
    shades = []
    for turn in sharp_turns(record.paths.points):
        near = np.flatnonzero(np.abs(station[:, 0] - turn) <= 2.0)
        if len(near):
            ends = time[near[[0, -1]]]
            label = "sharp turn of the path ± 2 m"
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


def formation(record: Record, paper: Paper = USUAL) -> Any:
    """Figure: formation errors [m] above the formation energy W [m^2], over time [s]."""
    figure = framed(record, "Formation errors", "Figs. 2b, 7a", paper=paper, height=3.6)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(5, 2))
    above.set_ylabel("formation error [m]\nbehind its place positive")
    below.set_ylabel("energy W (9)\n[m²]")
    time_axis(below, record)
    course = formation_errors(record)
    run = Figures(record)
    peak, final = run.metric("formation_error_peak"), run.metric("formation_error_final")
    if course is None or peak is None or peak.time is None or final is None:
        why = "a robot alone has no formation" if record.robots == 1 else "no sample was recorded"
        if record.robots > 1 and course is None:
            why = "the world has no formation"
        nothing(above, why)
        nothing(below, why)
        return figure
    zero_line(above)
    handles = draw_courses(above, record, *course) + _mark_parts([above, below], record)
    k = int(np.argmin(np.abs(course.time - peak.time)))
    (robot,) = peak.bodies
    value = float(np.copysign(peak.value, course.values[k, robot]))
    above.margins(y=0.2)
    text = f"{true_minus(f'{value:z.2f}')} m ({names_of(record, [robot])})"
    mark(above, peak.time, value, text, below=value < 0.0)
    above.set_title(f"within {final.value:.2f} m of zero at the end", loc="right", fontsize=8.5)
    if (energy := run.energy) is not None:
        below.fill_between(energy.time, 0.0, energy.values, color=INK, alpha=0.15, linewidth=0.0)
        below.plot(energy.time, energy.values, color=INK, linewidth=1.0)
        below.set_ylim(bottom=0.0)
    return finished(figure, handles)


def _mark_parts(axes: list[Any], record: Record) -> list[Any]:
    """Shade when no chain of neighbours connected all: W knows nothing of errors between parts."""
    course = formation_parts(record)
    if course is None:
        return []
    is_apart = np.concatenate([[False], course.values > 1.0, [False]])
    ends = np.flatnonzero(np.diff(is_apart)).reshape(-1, 2)
    last = len(course.time) - 1
    label = "not all connected: W omits\nerrors between the parts"
    shades = [
        axis.axvspan(*course.time[[first, min(end, last)]], color=RULE, alpha=0.7, linewidth=0.0,
                     label=label, gid="parts")
        for axis in axes for first, end in ends
    ]  # fmt: skip
    return shades[:1]


def speeds(record: Record, paper: Paper = USUAL) -> Any:
    """Figure: averaged rotational [rad/s] above averaged forward speed [m/s] over time [s].

    With steady speed and limits of the formation, where the world has one.
    """
    found = Figures(record).averaged
    title = f"Speeds averaged over {WINDOW:.0f} s"
    figure = framed(record, title, "Figs. 1c, 7b, 7c", paper=paper, height=3.9, width=NARROW)
    above, below = figure.subplots(2, 1, sharex=True)
    above.set_ylabel("rotational speed [rad/s]\nleft turn positive")
    below.set_ylabel("forward speed [m/s]")
    time_axis(below, record)
    if not np.isfinite(found.forward).any():
        for axis in (above, below):
            nothing(axis, f"no robot was under way for {WINDOW:.0f} s")
        return figure
    zero_line(above)
    if plan := section(record, "formation", Formation):
        for value in (*plan.limits, plan.speed):
            below.axhline(value, color=QUIET, linewidth=0.8, linestyle=(0, (5, 3)), zorder=1.5)
        words = "dashed: steady speed and limits of (7)"
        below.set_title(words, loc="right", fontsize=8.0, color=QUIET)
    draw_courses(above, record, found.time, found.rotational)
    handles = draw_courses(below, record, found.time, found.forward)
    for axis in (above, below):
        low, high = axis.get_ylim()
        more = max(SPAN - (high - low), 0.0) / 2.0
        axis.set_ylim(low - more, high + more)
    return finished(figure, handles)
