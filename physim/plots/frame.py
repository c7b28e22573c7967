"""What every figure has: title, source, legend, and a word where there is nothing to draw."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from physim.plots.style import INK, NARROW, QUIET
from physim.record import Record

LONGEST_NAME = 18
"""Characters of a name in a legend."""
LEGEND_ROWS = 16
"""Rows of a legend beside a figure."""


def framed(
    record: Record,
    title: str,
    paper: str = "",
    *,
    width: float = NARROW,
    height: float = 2.9,
    source_on_top: bool = False,
) -> Any:
    """Figure with a title, the run, and the figures of the paper to compare it with.

    The run stands at the foot, or beside the title where a legend takes the foot.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    run = f"{short(record.name, 40)}, seed {record.seed}"
    figure.suptitle(title, x=0.01, ha="left", fontsize=10.5, fontweight="bold")
    figure.text(
        0.99, 0.995 if source_on_top else 0.0,
        f"{run}; compare {paper} of the paper" if paper else run,
        ha="right", va="top" if source_on_top else "bottom", fontsize=7.5, color=QUIET,
        gid="source",
    )  # fmt: skip
    foot = 0.0 if source_on_top else 0.17 / height
    room = (0.0, foot, 1.0, 1.0 - foot)
    figure.set_layout_engine("constrained", w_pad=0.03, h_pad=0.03, rect=room)
    return figure


def short(name: str, most: int = LONGEST_NAME) -> str:
    """Name in one line of at most ``most`` characters that a legend shows as it is."""
    line = " ".join(name.split())
    line = line if len(line) <= most else line[: most - 1] + "…"
    return "\u00a0" + line if line.startswith("_") else line  # labels in _ are left out


def names_of(record: Record, bodies: Sequence[int | None]) -> str:
    """Names of bodies, "r1 and r2"."""
    return " and ".join(short(record.bodies[i].name) for i in bodies if i is not None)


def nothing(axis: Any, why: str) -> None:
    """Say in the middle of an axis that there is nothing to draw, and why."""
    axis.text(
        0.5, 0.5, f"none: {why}", transform=axis.transAxes, ha="center", va="center",
        color=QUIET, gid="none",
    )  # fmt: skip
    axis.set(xticks=[], yticks=[])


def legend_beside(figure: Any, handles: Sequence[Any], marks: float = 1.0) -> None:
    """Legend at the right of the figure, marks ``marks`` times as large."""
    if handles:
        figure.legend(
            handles=list(handles), loc="outside right upper", handlelength=1.5,
            ncols=-(-len(handles) // LEGEND_ROWS),
            borderaxespad=0.2, labelspacing=0.35, markerscale=marks,
        )  # fmt: skip


def legend_below(figure: Any, handles: Sequence[Any], columns: int) -> int:
    """Legend below the figure, in the order of reading; returns its number of rows."""
    rows = -(-len(handles) // columns)
    # matplotlib fills columns; the figure is read in rows
    order = [r * columns + c for c in range(columns) for r in range(rows)]
    shown = [handles[k] for k in order if k < len(handles)]
    if shown:
        figure.legend(
            handles=shown, loc="outside lower left", ncols=columns, handlelength=1.5,
            borderaxespad=0.2, labelspacing=0.35, columnspacing=1.4,
        )  # fmt: skip
    return rows


def time_axis(axis: Any, record: Record) -> None:
    """Time from start to end of the run."""
    axis.set_xlabel("time [s]")
    axis.set_xlim(0.0, max(record.steps_run, 1) * record.dt)


def zero_line(axis: Any) -> None:
    """Line at 0."""
    axis.axhline(0.0, color=INK, linewidth=0.8, zorder=1.5)


def keep_span(axis: Any, least: float) -> None:
    """Widen the y axis to ``least`` where it spans less: noise must not look like an event."""
    low, high = axis.get_ylim()
    if high - low < least:
        middle = (low + high) / 2.0
        axis.set_ylim(middle - least / 2.0, middle + least / 2.0)


def mark(
    axis: Any,
    x: float,
    y: float,
    text: str,
    *,
    below: bool = False,
    colour: str = INK,
    row: int = 0,
) -> None:
    """Mark a point of a curve, with its value written toward the middle of the axis.

    ``row`` puts the words as many lines further away, clear of those of another mark.
    """
    low, high = axis.get_xlim()
    away = 7.0 + 10.5 * row
    right = (x - low) > 0.55 * (high - low)
    axis.plot(
        [x], [y], "o", color=colour, markersize=4.5, markerfacecolor="white", zorder=5,
        clip_on=False,
    )  # fmt: skip
    axis.annotate(
        text, (x, y), xytext=(-7 if right else 7, -away if below else away),
        textcoords="offset points",
        ha="right" if right else "left", va="top" if below else "bottom", fontsize=8.0,
        color=colour, zorder=6, gid="mark",
        bbox={"boxstyle": "square,pad=0.15", "facecolor": "white", "alpha": 0.8, "linewidth": 0},
    )  # fmt: skip
