"""What every figure has: title, source, legend, and a word where there is nothing to draw."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise, product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from physim.drawing.labels import covered, shortened
from physim.drawing.plots.style import DPI, INK, NARROW, QUIET
from physim.drawing.scene_model import pieces_of
from physim.geometry.shapes import FloatArray

if TYPE_CHECKING:
    from physim.record import Record

LONGEST_NAME = 18
"""Characters of a name in a legend."""
FEW_CURVES = 4
"""Curves on one axis off which the words of a mark are kept; of more there is no free place."""
LONGEST_RUN = 40
"""Characters of the name of a run."""
GAP = 16.0
"""[px] between a title and what stands beside it, in a picture as it is saved"""
MOST_POINTS = 4000
"""Points of a curve; of more samples the least of each stretch is drawn, so no dip is lost."""
ROW = 0.17
"""[in] of a legend below a figure"""
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
    head = figure.suptitle(title, x=0.01, ha="left", fontsize=10.5, fontweight="bold",
                           parse_math=False)  # fmt: skip
    source = figure.text(
        0.99, 0.995 if source_on_top else 0.0, "",
        ha="right", va="top" if source_on_top else "bottom", fontsize=7.5, color=QUIET,
        gid="source", parse_math=False,
    )  # fmt: skip
    before, figure.dpi = figure.dpi, DPI  # widths of letters depend on it
    left = head.get_window_extent().x1 + GAP if source_on_top else 0.0
    compare = f"; compare {paper} of the paper" if paper else ""

    def clear(name: str) -> bool:
        source.set_text(f"{name}, seed {record.seed}{compare}")
        return len(name) <= LONGEST_RUN and source.get_window_extent().x0 >= left

    clear(shortened(record.name, clear))
    figure.dpi = before
    foot = 0.0 if source_on_top else 0.17 / height
    room = (0.0, foot, 1.0, 1.0 - foot)
    figure.set_layout_engine("constrained", w_pad=0.03, h_pad=0.03, rect=room)
    return figure


def short(name: str, most: int = LONGEST_NAME) -> str:
    """Name in one line of at most ``most`` characters that a legend shows as it is."""
    line = shortened(name, most)
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


def nothing_in(figure: Any) -> str | None:
    """Return why there is nothing to see on any axis of a figure; None where there is."""
    said = [
        [text.get_text() for text in axis.texts if text.get_gid() == "none"] for axis in figure.axes
    ]
    if not said or not all(said):
        return None
    return " ".join(said[0][0].removeprefix("none: ").split())


def legend_beside(figure: Any, handles: Sequence[Any], marks: float = 1.0) -> None:
    """Legend at the right of the figure, marks ``marks`` times as large."""
    if handles:
        figure.legend(
            handles=list(handles), loc="outside right upper", handlelength=1.5,
            ncols=-(-len(handles) // LEGEND_ROWS),
            borderaxespad=0.2, labelspacing=0.35, markerscale=marks,
        )  # fmt: skip


def legend_below(figure: Any, handles: Sequence[Any], columns: int, lifted: bool = False) -> int:
    """Legend below the figure, in the order of reading; returns its number of rows.

    It has ``columns``, or as many as the figure is wide enough for; ``lifted`` by a line of text.
    """
    while handles:
        listed = [handles[k] for k in in_rows(len(handles), columns)]
        legend = figure.legend(
            handles=listed, loc="outside lower left", ncols=columns, handlelength=1.5,
            borderaxespad=1.7 if lifted else 0.2, labelspacing=0.35, columnspacing=1.4,
        )  # fmt: skip
        legend.set_gid(f"columns {columns}")
        if columns == 1 or legend.get_window_extent().width <= 0.97 * figure.bbox.width:
            break
        legend.remove()
        columns -= 1
    return -(-len(handles) // columns)


def in_rows(count: int, columns: int) -> list[int]:
    """Order in which entries are given to a legend that fills columns but is read in rows."""
    rows = -(-count // columns)
    order = [r * columns + c for c in range(columns) for r in range(rows)]
    return [k for k in order if k < count]


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


def name_rows(axis: Any, record: Record, named: int, size: float, most: int = LONGEST_NAME) -> None:
    """Names beside the rows of robots, of about ``named`` of many."""
    robots = range(0, record.robots, -(-record.robots // named))
    axis.set_yticks(list(robots), [short(record.names[i], most) for i in robots])
    axis.tick_params(axis="y", length=0, labelsize=size)
    axis.set_ylabel("robot")


def row_ends(
    axis: Any, title: str, words: Sequence[str | None], bold: Sequence[bool], gid: str
) -> None:
    """Words at the right ends of the rows of robots, below a title; None for no words."""
    style = {"textcoords": "offset points", "fontsize": 7.8}
    for robot, (text, heavy) in enumerate(zip(words, bold, strict=True)):
        if text is not None:
            axis.annotate(
                text, (1.0, robot), (4, 0), xycoords=("axes fraction", "data"), va="center",
                color=INK, fontweight="bold" if heavy else "normal", gid=gid, **style,
            )  # fmt: skip
    axis.annotate(title, (1.0, 1.0), (4, 1), xycoords="axes fraction", va="bottom", color=QUIET,
                  **style)  # fmt: skip


def thinned(
    time: FloatArray, values: FloatArray, most: int = MOST_POINTS
) -> tuple[FloatArray, FloatArray]:
    """At most ``most`` points, each the least of its stretch and at the time of that."""
    if len(values) <= most:
        return time, values
    edges = np.linspace(0, len(values), most + 1).astype(int)
    at = [a + int(np.argmin(values[a:b])) for a, b in pairwise(edges)]
    return time[at], values[at]


def clear_marks(figure: Any) -> None:
    """Move the words of marks into their axes and, where another side is freer, off the curves.

    To be called when all is drawn. Words that are inside, cover no curve and stand nearer their
    own mark than another stay.
    """
    found = {
        axis: marks
        for axis in figure.axes
        if (marks := [text for text in axis.texts if text.get_gid() == "mark"])
    }
    if not found:
        return
    figure.draw_without_rendering()
    for axis, marks in found.items():
        lines = [line.get_xydata() for line in axis.lines if len(line.get_xydata()) > 2]
        curves = [axis.transData.transform(line) for line in lines if len(lines) <= FEW_CURVES]
        _settle(axis, marks, pieces_of(curves))
        for text in marks:
            box, room = text.get_window_extent(), axis.get_window_extent()
            over = max(box.x1 - room.x1, 0.0) - max(room.x0 - box.x0, 0.0)
            if over:
                x, y = text.xyann
                text.xyann = (x - over * 72.0 / figure.dpi, y)


AWAY = (7.0, 17.5, 26.0)
"""[pt] from a mark to its words, across and up"""
MOST_SIDES = 12
"""Sides of a mark that are tried together with those of others."""
WORSE = 1000.0
"""[px] of a curve that words would rather cover than leave their axis or be taken for others"""
_Side = tuple[float, float, str, str]
"""Where words stand from their mark (x, y) [pt], and which of their corners does"""


def _settle(axis: Any, marks: Sequence[Any], curves: FloatArray) -> None:
    """Put the words of all marks of an axis on the sides that are best together, rather as now.

    They cover the least of the pieces of curves (s, 2, 2) [px] there.
    """
    points = axis.transData.transform([text.xy for text in marks])
    room = axis.get_window_extent().extents
    tried: list[list[tuple[_Side, FloatArray, float]]] = []
    for text in marks:
        sides = _sides(text)
        boxes = np.array([_stand(text, side) for side in sides])
        prices = covered(boxes, curves) + WORSE * _leaves(boxes, room)
        prices += [0.0, *(0.01 * np.hypot(x, y) for x, y, *_ in sides[1:])]
        best = np.argsort(prices, kind="stable")[:MOST_SIDES].tolist()
        tried.append([(sides[k], boxes[k], float(prices[k])) for k in best])

    def price(chosen: Iterable[tuple[_Side, FloatArray, float]]) -> float:
        boxes = np.array([box for _, box, _ in chosen])
        return sum(own for *_, own in chosen) + WORSE * _mixed_up(boxes, points)

    for text, (side, *_) in zip(marks, min(product(*tried), key=price), strict=True):
        _stand(text, side)


def _sides(text: Any) -> list[_Side]:
    """Where the words of a mark stand, and where else they may."""
    ways = product(AWAY, AWAY, ((1.0, "left"), (-1.0, "right")), ((1.0, "bottom"), (-1.0, "top")))
    others = [(right * x, up * y, ha, va) for x, y, (right, ha), (up, va) in ways]
    return [(*text.xyann, text.get_ha(), text.get_va()), *others]


def _stand(text: Any, side: _Side) -> FloatArray:
    """Put words on a side of their mark; returns the box (4,) [px] that they then take."""
    x, y, ha, va = side
    text.xyann = (x, y)
    text.set(ha=ha, va=va)
    return np.asarray(text.get_window_extent().extents)


def _leaves(boxes: FloatArray, room: FloatArray) -> NDArray[np.bool_]:
    """(n,) Whether boxes (n, 4) reach out of another (4,)."""
    low, high = boxes[:, :2] < room[:2], boxes[:, 2:] > room[2:]
    return np.asarray((low | high).any(axis=1))


def _mixed_up(boxes: FloatArray, points: FloatArray) -> int:
    """How many of the words in boxes (n, 4) cover others, or stand nearer another point (n, 2)."""
    low, high = boxes[:, None, :2], boxes[:, None, 2:]
    covering = ((low < boxes[:, 2:]) & (high > boxes[:, :2])).all(axis=2)
    beside = np.maximum(np.maximum(low - points, points - high), 0.0)
    away = np.hypot(beside[..., 0], beside[..., 1])
    astray = away < away.diagonal()[:, None] - 1.0
    return int((covering.sum() - len(boxes)) + astray.sum())


def mark(
    axis: Any,
    x: float,
    y: float,
    text: str,
    *,
    below: bool = False,
    colour: str = INK,
    row: int = 0,
    inside: bool = False,
) -> None:
    """Mark a point of a curve, with its value written toward the middle of the axis.

    ``row`` puts the words as many lines further away, clear of those of another mark; on a small
    axis they stand beside the point, ``inside``.
    """
    low, high = axis.get_xlim()
    away = 7.0 + 10.5 * row
    right = (x - low) > 0.55 * (high - low)
    axis.plot(
        [x], [y], "o", color=colour, markersize=4.5, markerfacecolor="white", zorder=5,
        clip_on=False,
    )  # fmt: skip
    axis.annotate(
        text, (x, y), xytext=(-7 if right else 7, 0.0 if inside else -away if below else away),
        textcoords="offset points", ha="right" if right else "left",
        va="center" if inside else "top" if below else "bottom", fontsize=8.0,
        color=colour, zorder=6, gid="mark",
        bbox={"boxstyle": "square,pad=0.15", "facecolor": "white", "linewidth": 0,
              "alpha": 0.0 if inside else 0.8},
    )  # fmt: skip
