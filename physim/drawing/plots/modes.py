"""Safe and danger mode of each robot over time, with its share (Fig. 8)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.analysis.metrics import Figures, mode_spans
from physim.analysis.metrics.modes import danger_of
from physim.drawing.drivers import MOST_DRIVERS, MOST_LETTERS, Driver, drivers_of
from physim.drawing.plots.frame import (
    POSES_ONLY,
    USUAL,
    Paper,
    driver_handle,
    finished,
    framed,
    name_rows,
    nothing,
    row_ends,
    short,
    time_axis,
)
from physim.drawing.plots.style import QUIET
from physim.geometry.shapes import FloatArray, IntArray
from physim.parts.declarations import NO_NUMBER
from physim.record import Record
from physim.units import percent

MOST_ROWS = 40
"""Robots that have a row with name and share; of more, rows are thin and only some are named."""

COUNTS = 1.4
"""[in] height of the axis that counts the robots in each mode"""
MOMENTS = 1000
"""Moments at which they are counted."""

LONGEST_MODE = 44
"""Characters of a mode in the legend."""
BLANK = 0.002
"""Share of the run without a mode from which on the legend says what a blank stretch means."""


def modes(record: Record, paper: Paper = USUAL) -> Any:
    """Figure: a row a robot, coloured by mode over time [s], its share out of danger at the end.

    Of more than `MOST_ROWS` robots: above, how many are in each mode; below, the rows, thin.
    """
    few = record.robots <= MOST_ROWS
    row = 0.21 if few else max(0.03, (8.0 - COUNTS) / record.robots)
    tall = min(8.6, max(1.5, 0.8 + (0.0 if few else COUNTS) + row * record.robots))
    figure = framed(record, "Modes", "Fig. 8", paper=paper, height=tall, width=5.6)
    if few:
        above = axis = figure.subplots()
    else:
        above, axis = figure.subplots(2, 1, sharex=True, height_ratios=(COUNTS, tall - COUNTS))
    axis.grid(False)
    time_axis(axis, record)
    spans = mode_spans(record)
    if (spans["mode"] == NO_NUMBER).all():
        why = "the controller gives no modes" if len(spans) else "no decision was recorded"
        why = why if record.judged is None else POSES_ONLY
        for empty in {above, axis}:
            nothing(empty, why)
        return figure
    _rows(axis, record, spans, 0.76 if few else 1.0)
    axis.set_ylim(record.robots - 0.4, -0.6)
    name_rows(axis, record, MOST_ROWS, 8.0 if few else 6.5)
    safe = Figures(record).metric("safe_share")
    drivers = drivers_of(record)
    careful = [one for one in drivers if any(record.modes[k].danger for k in one.modes)]
    if few and safe is not None and safe.robots is not None:
        words = [None if share is None else percent(share, 0) for share in safe.robots]
        if drivers:  # who knows no danger is not safe either
            theirs = {robot for one in careful for robot in one.robots}
            words = [text if robot in theirs else None for robot, text in enumerate(words)]
        bold = [share is not None and share < 0.5 for share in safe.robots]
        row_ends(axis, "safe", words, bold, "share")
    if not few:
        times, counts = mode_counts(record, spans)
        order = sorted(range(len(record.modes)), key=lambda k: not record.modes[k].danger)
        colours = [record.modes[k].colour for k in order]  # those of danger at the bottom
        above.stackplot(times, counts[order], colors=colours, step="post", linewidth=0.0)
        above.set(ylim=(0.0, record.robots), ylabel="robots in\neach mode")
    if safe is not None:
        title = f"out of danger: {percent(safe.value)} of all robots' time under way"
        if drivers:
            shares = {one.letter: danger_of(record, one.robots) for one in careful}
            told = [f"{k} {percent(1.0 - one, 0)}" for k, one in shares.items() if one is not None]
            more = ["…"] if len(told) > MOST_LETTERS else []
            title = f"out of danger: {', '.join(told[:MOST_LETTERS] + more)}"
        above.set_title(title, loc="right", fontsize=8.0, color=QUIET)
    return finished(figure, _handles(record, spans, drivers), 1 if drivers else 4)


def _rows(axis: Any, record: Record, spans: NDArray[np.void], height: float) -> None:
    """Bars of each mode; danger over the others, since a short stretch of it matters most."""
    from matplotlib.collections import PolyCollection

    for mode in sorted(range(len(record.modes)), key=lambda k: record.modes[k].danger):
        mine = spans[spans["mode"] == mode]
        ends = np.column_stack((mine["begin"], mine["end"]))[:, [0, 1, 1, 0]]
        sides = mine["robot"][:, None] + height / 2.0 * np.array([-1.0, -1.0, 1.0, 1.0])
        corners: FloatArray = np.stack((ends, sides), axis=-1)
        axis.add_collection(
            PolyCollection(list(corners), facecolor=record.modes[mode].colour, linewidth=0.0)
        )


def mode_counts(record: Record, spans: NDArray[np.void]) -> tuple[FloatArray, IntArray]:
    """Moments (T,) [s] and how many robots are in each of the M modes then (M, T)."""
    times = np.linspace(record.begun, record.steps_run * record.dt, MOMENTS)
    found = []
    for mode in range(len(record.modes)):
        mine = spans[spans["mode"] == mode]
        begun, over = (
            np.searchsorted(np.sort(mine[end]), times + 1e-9) for end in ("begin", "end")
        )
        found.append(begun - over)
    return times, np.array(found)


def _handles(record: Record, spans: NDArray[np.void], drivers: Sequence[Driver]) -> list[Any]:
    """Of the modes that last, below each of several controllers its own, and of blank stretches."""
    from matplotlib.patches import Patch

    lasting = spans[spans["end"] > spans["begin"]]
    handles = []
    for one in drivers[:MOST_DRIVERS] or (None,):
        given = lasting["mode"]
        if one is not None:
            given = given[np.isin(lasting["robot"], one.robots)]
            handles.append(driver_handle(one))
        handles += [
            Patch(facecolor=record.modes[k].colour, label=short(str(record.modes[k]), LONGEST_MODE))
            for k in np.unique(given[given != NO_NUMBER]).tolist()
        ]
    coloured = spans[spans["mode"] != NO_NUMBER]
    filled = np.bincount(
        coloured["robot"], coloured["end"] - coloured["begin"], minlength=record.robots
    )
    if filled.min() < record.steps_made * record.dt * (1.0 - BLANK):
        handles.append(Patch(facecolor="white", edgecolor=QUIET, label="blank: no mode given"))
    return handles
