"""What every figure has: its width in print, title and source, a legend below it, and words beside
what they name.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from physim.drawing.drivers import Driver, drivers_of, marks_of
from physim.drawing.labels import (
    DISC,
    TURNS,
    Label,
    around,
    covered,
    overlaps,
    places,
    shortened,
)
from physim.drawing.plots.style import DPI, INK, NARROW, QUIET
from physim.drawing.scene_model import pieces_of
from physim.geometry.shapes import FloatArray

if TYPE_CHECKING:
    from physim.record import Record

LONGEST_NAME = 18
"""Characters of a name in a legend."""
LONGEST_DRIVER = 44
"""Characters of a controller with its robots"""
SHORTEST_RUN = 12
"""Characters of the name of a run that are shown rather than what to compare it with."""
HEAD = 0.36
"""[in] of title and source"""
COLUMNS = 5
"""of a legend, at most"""
TALLEST = 6.2
"""[in] of a map"""
MOST_POINTS = 4000
"""Points of a curve; of more samples the least of each stretch is drawn, so no dip is lost."""


class Paper(NamedTuple):
    """How a figure is printed."""

    width: float | None = None
    """[in]; without, that of the figure"""
    title: bool = True
    """whether it has a title and names the run; in a paper the caption does"""


USUAL = Paper()


def framed(
    record: Record,
    title: str,
    compare: str = "",
    *,
    paper: Paper = USUAL,
    width: float = NARROW,
    height: float = 2.6,
) -> Any:
    """Figure [in] with a title, the run, and the figures of the paper to ``compare`` it with.

    ``height`` is without the title. It shrinks with the width in print, by a tenth at most.
    """
    from matplotlib.figure import Figure

    wide = paper.width or width
    figure = Figure((wide, height * max(wide / width, 0.9) + HEAD * paper.title), dpi=DPI)
    if paper.title:
        source = head(figure, title)
        for more in (f"; compare {compare} of the paper", "")[not compare :]:

            def fits(name: str, more: str = more) -> bool:
                source.set_text(f"{name}, seed {record.seed}{more}")
                return bool(source.get_window_extent().x1 <= figure.bbox.width)

            name = shortened(record.name, fits)
            fits(name)
            if len(name) >= min(SHORTEST_RUN, len(record.name)):
                break
    _lay_out(figure)
    return figure


def head(figure: Any, title: str, source: str = "") -> Any:
    """Write a title, and below it in small where the figure comes from, which is returned."""
    from matplotlib.transforms import ScaledTranslation

    def line(down: float, words: str, **style: Any) -> Any:
        lower = ScaledTranslation(0.0, -down, figure.dpi_scale_trans)
        return figure.text(
            0.01, 1.0, words, va="top", parse_math=False,
            transform=figure.transFigure + lower, **style,
        )  # fmt: skip

    line(0.03, title, fontsize=10.5, fontweight="bold")
    return line(0.2, source, fontsize=7.5, color=QUIET, gid="source")


def _lay_out(figure: Any) -> None:
    head = HEAD / figure.get_figheight() if figure.texts else 0.0
    room = (0.0, 0.0, 1.0, 1.0 - head)
    figure.set_layout_engine("constrained", w_pad=0.03, h_pad=0.03, rect=room)


def finished(figure: Any, handles: Sequence[Any] = (), columns: int = COLUMNS) -> Any:
    """The figure with a legend below, its map as high as that needs, and words clear of curves."""
    while handles:
        legend = figure.legend(
            handles=list(handles), loc="outside lower left", ncols=columns, handlelength=1.5,
            borderaxespad=0.2, labelspacing=0.35, columnspacing=1.4,
        )  # fmt: skip
        box = legend.get_window_extent()
        if columns == 1 or box.width <= 0.97 * figure.bbox.width:
            figure.set_figheight(figure.get_figheight() + box.height / figure.dpi)
            break
        legend.remove()
        columns -= 1
    _lay_out(figure)
    _fit_map(figure)
    settle_marks(figure)
    return figure


def _fit_map(figure: Any) -> None:
    """Give a map, of which x and y have one scale, the height that its width asks for."""
    for axis in figure.axes:
        if axis.get_aspect() == "auto":
            continue
        axis.set_aspect("auto")  # fills its box, so that what stands round it is known
        figure.draw_without_rendering()
        axis.set_aspect("equal")
        wide, high = figure.get_size_inches()
        boxes = [one.get_position(original=True) for one in figure.axes]
        shape = np.ptp(axis.get_ylim()) / np.ptp(axis.get_xlim())
        wanted = float(np.clip(wide * boxes[0].width * shape, 0.6, TALLEST))
        others = [high * box.height for box in boxes[1:]]
        axis.get_subplotspec().get_gridspec().set_height_ratios((wanted, *others))
        figure.set_figheight(high + wanted - high * boxes[0].height)
        _lay_out(figure)


def short(name: str, most: int = LONGEST_NAME) -> str:
    """Name in one line of at most ``most`` characters that a legend shows as it is."""
    line = shortened(name, most)
    return "\u00a0" + line if line.startswith("_") else line  # labels in _ are left out


def driver_handle(driver: Driver) -> Any:
    """A line of a legend: a controller by its letter, and its robots."""
    from matplotlib.patches import Patch

    label = short(driver.words, LONGEST_DRIVER)
    return Patch(facecolor="none", edgecolor="none", label=label)


def names_of(record: Record, bodies: Sequence[int | None]) -> str:
    """Names of bodies, "r1 and r2"."""
    return " and ".join(short(record.bodies[i].name) for i in bodies if i is not None)


POSES_ONLY = "the poses of a log do not tell"
"""Why nothing is drawn of decisions"""


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


def time_axis(axis: Any, record: Record) -> None:
    """Time from start to end of the run."""
    axis.set_xlabel("time [s]")
    axis.set_xlim(record.begun, max(record.steps_run, record.begun_at + 1) * record.dt)


def zero_line(axis: Any) -> None:
    """Line at 0."""
    axis.axhline(0.0, color=INK, linewidth=0.8, zorder=1.5)


def name_rows(axis: Any, record: Record, named: int, size: float, most: int = LONGEST_NAME) -> None:
    """Names beside the rows of robots, of about ``named`` of many."""
    robots = range(0, record.robots, -(-record.robots // named))
    marks = marks_of(drivers_of(record), record.robots)
    axis.set_yticks(list(robots), [short(record.names[i], most) + marks[i] for i in robots])
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


# Words beside what they name

DOT = 3.0
"""[pt] radius of a mark"""
FEW_CURVES = 4
"""Curves on one axis off which the words of a mark are kept; of more there is no free place."""
GAPS = (2.0, 6.0, 12.0, 20.0, 32.0, 48.0)
"""[pt] between what is named and its words"""
PRICES = (0.0, 1.0, 2.5, 4.0, 7.0, 11.0)
"""What these gaps cost; a direction costs up to 1."""
NEAR = 4.0
"""[pt] Words farther off than this have a line to what they name."""
ASTRAY = 1000.0
"""What it costs to stand beside something else: more than all lines together"""
CLEARER, FAR = 5.0, 10.0
"""[pt] by which words are nearer to their own than to others; or they are so far from the others
and have a line to their own"""
AIR = np.array((2.0, 0.6))
"""[pt] round words"""


class Note(NamedTuple):
    """Words to be placed, and what they name."""

    words: Any
    """an annotation"""
    reach: float = DOT
    """[pt] to keep free round its point"""
    shape: FloatArray | None = None
    """(n, 2) [pt] outline round the point to keep free instead"""
    up: float = 1.0
    """-1 for words that stand below rather than above"""


def note(axis: Any, at: Sequence[float] | FloatArray, words: str, **style: Any) -> Any:
    """Words about a point of an axis, with a line to it that is not seen yet."""
    how = {
        "ha": "center", "va": "center", "fontsize": 8.0, "zorder": 6,
        "bbox": {"boxstyle": "square,pad=0.1", "facecolor": "white", "linewidth": 0, "alpha": 0.75},
    }  # fmt: skip
    line = {"arrowstyle": "-", "color": QUIET, "linewidth": 0.5, "shrinkA": 0.0, "shrinkB": 0.0}
    text = axis.annotate(
        words, (at[0], at[1]), (0.0, 0.0), textcoords="offset points", annotation_clip=False,
        arrowprops=line, **(how | style),
    )  # fmt: skip
    text.arrow_patch.set_visible(False)
    return text


def mark(
    axis: Any, x: float, y: float, text: str, *, below: bool = False, colour: str = INK
) -> None:
    """Mark a point of a curve, with its value written toward the middle of the axis."""
    low, high = axis.get_xlim()
    right = (x - low) > 0.55 * (high - low)
    axis.plot(
        [x], [y], "o", color=colour, markersize=4.5, markerfacecolor="white", zorder=5,
        clip_on=False,
    )  # fmt: skip
    words = note(axis, (x, y), text, color=colour, gid="mark", va="top" if below else "bottom",
                 ha="right" if right else "left")  # fmt: skip
    words.xyann = (-7.0 if right else 7.0, -7.0 if below else 7.0)


def settle_marks(figure: Any) -> None:
    """Move the words of marks within their axes off the curves; to be called when all is drawn."""
    figure.draw_without_rendering()
    for axis in figure.axes:
        notes = [
            Note(text, up=-1.0 if text.get_va() == "top" else 1.0)
            for text in axis.texts
            if text.get_gid() == "mark"
        ]
        lines = [line.get_xydata() for line in axis.lines if len(line.get_xydata()) > 2]
        curves = [pointed(axis, line) for line in lines if len(lines) <= FEW_CURVES]
        pieces = pieces_of(curves)
        if notes:
            settle(axis, notes, (pieces, np.ones(len(pieces))), slack=4.0)


def pointed(axis: Any, places: FloatArray) -> FloatArray:
    """Places (n, 2) of an axis in [pt] of its figure."""
    points: FloatArray = np.asarray(axis.transData.transform(places), dtype=np.float64)
    return np.asarray(points * (72.0 / axis.figure.dpi))


def settle(
    axis: Any,
    notes: Sequence[Note],
    lines: tuple[FloatArray, FloatArray],
    taken: FloatArray | None = None,
    anchors: FloatArray | None = None,
    slack: float = 0.0,
) -> list[bool]:
    """Place words where they cover no words before them; returns which have found a place.

    They stand within the axis, which they may leave by ``slack`` [pt], cover none of the boxes
    ``taken`` (m, 4) and little of the pieces (s, 2, 2), of which each [pt] has a price (s,). They
    are nearer to their own point than to other ``anchors`` (a, 2), by default those of the other
    words, or have a line to it.
    """
    from matplotlib.text import Text

    scale = 72.0 / axis.figure.dpi
    room = scale * axis.get_window_extent().extents
    points = pointed(axis, np.array([one.words.xy for one in notes]))
    anchors = points if anchors is None else anchors
    taken = np.zeros((0, 4)) if taken is None else taken
    found = []
    for (words, reach, shape, up), at in zip(notes, points, strict=True):
        box = Text.get_window_extent(words)  # without the line
        size = scale * np.array((box.width, box.height)) + AIR
        label = Label((at[0], at[1]), reach, (size[0], size[1]), shape)
        middles = places(label, GAPS, up)
        boxes = around(middles, label.size)
        over = np.maximum(room[:2] - boxes[:, :2], boxes[:, 2:] - room[2:]).max(axis=1).clip(0.0)
        free = (over <= slack) & (overlaps(boxes, taken).max(axis=1, initial=0.0) <= 0.0)
        others = anchors[(np.abs(anchors - at) > 1e-6).any(axis=1)]
        own, other = _away(boxes, at[None]), _away(boxes, others)
        cost = np.add.outer(PRICES, TURNS).ravel() + covered(boxes, *lines) + 10.0 * over
        cost += ASTRAY * (other < np.minimum(own + CLEARER, FAR))
        best = int(np.argmin(np.where(free, cost, np.inf)))
        found.append(bool(free[best]))
        if free[best]:
            words.set(ha="center", va="center")
            words.xyann = tuple(middles[best] - at)
            taken = np.concatenate((taken, boxes[best : best + 1]))
            is_joined = own[best] > reach + NEAR or other[best] < own[best] + CLEARER
            words.arrow_patch.set_visible(is_joined and shape is None)
            words.arrow_patch.shrinkB = DISC * reach
    return found


def _away(boxes: FloatArray, points: FloatArray) -> FloatArray:
    """Distances (n,) of boxes (n, 4) to the nearest of points (m, 2)."""
    beyond = np.maximum(boxes[:, None, :2] - points, points - boxes[:, None, 2:])
    apart = np.hypot(*np.maximum(beyond, 0.0).transpose(2, 0, 1))
    return np.asarray(apart.min(axis=1, initial=np.inf))
