"""The width profile of a preview: corridor width along the first robot's path (Fig. 4)."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.drawing import palette
from physim.drawing.labels import Label, leader, round_step, significant, spread
from physim.drawing.palette import hexed
from physim.drawing.plots.style import INK, QUIET, WIDTHS
from physim.drawing.preview.contents import Contents, station_words
from physim.drawing.preview.ground_plan import MOST_TICKS
from physim.drawing.preview.lettering import text_size
from physim.geometry.polygon import least_width
from physim.geometry.shapes import FloatArray

FAR = 6.0
"""[pt] Words farther from their mark than this have a line to it."""
MARK = 4.0
"""[pt] from the mark of the narrowest place to its words"""


def draw_profile(axis: Any, preview: Contents) -> None:
    """Draw width against station, with what the robots need beside it."""
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    station, width = preview.widths.station, preview.widths.width
    finite = np.isfinite(width)
    top = 1.12 * max(width[finite].max(initial=0.0), *(level for level, *_ in _levels(preview)))
    needed = 2.0 * preview.scene.safe_distance
    floor = palette.SAFE_AREA if needed else palette.FLOOR
    under = np.where(finite, width, top)
    for where, colour in ((np.ones_like(finite), floor), (width < needed, palette.DANGER_AREA)):
        axis.fill_between(station, 0.0, under, where=where, color=hexed(colour), linewidth=0.0)
    if preview.boundary_widths is not None:
        other = preview.boundary_widths
        alone = np.where(other.between, other.width, np.nan)
        axis.plot(other.station, alone, "--", color=QUIET, linewidth=0.9)
    axis.plot(station, width, color=WIDTHS, linewidth=0.8, linestyle=":")
    axis.plot(station, np.where(preview.widths.between, width, np.nan), color=WIDTHS, linewidth=1.5,
              gid="width")  # fmt: skip
    _name_narrowest(axis, preview, top)
    _needs(axis, preview, top)
    axis.set(xlim=(0.0, preview.course_length), ylim=(0.0, top))
    axis.set(xlabel="station along the path of the first robot [m]", ylabel="width [m]")
    axis.xaxis.set_major_locator(MultipleLocator(round_step(preview.course_length, MOST_TICKS)))
    axis.yaxis.set_major_locator(MaxNLocator(5, steps=(1, 2, 5, 10)))


def _name_narrowest(axis: Any, preview: Contents, top: float) -> None:
    """Mark the narrowest place and write its width beside it, clear of all lines if possible."""
    station, width, k = preview.widths.station, preview.widths.width, preview.widths.narrowest
    if k is None:
        return
    axis.plot(station[k], width[k], "o", color=WIDTHS, markersize=4.5, zorder=4.0)
    place = station_words(float(station[k]), preview.course_length)
    words = f"{significant(float(width[k]))} m at {place} m"
    room = axis.get_position().size * axis.figure.get_size_inches() * 72.0
    scale = room / (preview.course_length, top)
    curve = np.column_stack((station, np.where(np.isfinite(width), width, 2.0 * top))) * scale
    levels = np.array([level for level, *_ in _levels(preview)]) * scale[1]
    size = np.array(text_size(axis.figure, words, 8.5, "bold"))
    middle = _free_place(curve[k], size, curve, levels, room)
    x, y = middle / scale
    line = leader(Label(tuple(curve[k]), 0.0, tuple(size)), middle, FAR)
    if line is not None:
        axis.plot(*(line / scale).T, color=WIDTHS, linewidth=0.7, zorder=3.9, gid="leader")
    axis.annotate(
        words, (x, y), ha="center", va="center", color=WIDTHS, fontsize=8.5, fontweight="bold",
        zorder=5.0,
    )  # fmt: skip


def _free_place(
    at: FloatArray, size: FloatArray, curve: FloatArray, levels: FloatArray, room: FloatArray
) -> FloatArray:
    """Middle (2,) of a text near ``at`` that covers neither curve (n, 2) nor levels, all [pt].

    The nearest such place, below before above; where there is none, just below ``at``.
    """
    half = size / 2.0
    away = half[1] + MARK
    ups = np.concatenate((-np.arange(away, room[1], 2.0), np.arange(away, room[1], 2.0)))
    x = at[0] + np.concatenate(([0.0], *((-d, d) for d in np.arange(4.0, 1.5 * size[0], 4.0))))
    least, most = _extent(curve, x - half[0], x + half[0])
    middles = np.stack(np.broadcast_arrays(x[:, None], at[1] + ups), axis=2)
    low, high = middles - half, middles + half
    free = ((low >= 1.0) & (high <= room - 1.0)).all(axis=2)
    free &= ~((low[..., 1:] < levels + 1.5) & (high[..., 1:] > levels - 1.5)).any(axis=2)
    free &= (high[..., 1] < least[:, None] - 1.0) | (low[..., 1] > most[:, None] + 1.0)
    if not free.any():
        place = at - (0.0, away)
        return np.asarray(np.clip(place, half + 1.0, np.maximum(room - half - 1.0, half + 1.0)))
    cost = np.abs(middles - at) @ (0.5, 1.0) + 8.0 * (middles[..., 1] > at[1])
    best = np.unravel_index(np.argmin(np.where(free, cost, np.inf)), cost.shape)
    return np.asarray(middles[best])


def _extent(
    curve: FloatArray, left: FloatArray, right: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Least and greatest height (n,) of a curve (k, 2) between ``left`` (n,) and ``right`` (n,)."""
    under = np.interp(np.linspace(left, right, 25), *curve.T)
    inside = (left < curve[:, :1]) & (right > curve[:, :1])
    return (
        np.minimum(under.min(axis=0), np.where(inside, curve[:, 1:], np.inf).min(axis=0)),
        np.maximum(under.max(axis=0), np.where(inside, curve[:, 1:], -np.inf).max(axis=0)),
    )


def _levels(preview: Contents) -> list[tuple[float, str, str, Any]]:
    """Width [m], words, colour and dash of every level that the width is compared with."""
    turning = 2.0 * float(preview.scene.reach.max())
    aligned = max(least_width(outline) for outline in preview.scene.outlines)
    found = [
        (turning, "every robot fits at any heading", INK, (0, (5, 2))),
        (aligned, "every robot fits if aligned", INK, (0, (1, 1.5))),
    ]
    if preview.scene.safe_distance:
        found.append(
            (2.0 * preview.scene.safe_distance, "= 2L: no safe area below", QUIET, (0, (7, 2)))
        )
    return found


def _needs(axis: Any, preview: Contents, top: float) -> None:
    """Level lines, named at their right ends without overlap."""
    high = axis.figure.get_size_inches()[1] * axis.get_position().height * 72.0
    levels = sorted(_levels(preview))
    wanted = np.array([level for level, *_ in levels])
    beside = axis.get_yaxis_transform()
    for (level, words, colour, dash), place in zip(
        levels, spread(wanted, 10.5 * top / high, 0.0, top), strict=True
    ):
        axis.axhline(level, color=colour, linewidth=1.0, linestyle=dash)
        axis.annotate(
            f"{significant(level)} m  {words}", (1.0, level), (1.012, place),
            xycoords=beside, textcoords=beside, color=colour, fontsize=7.8, va="center",
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-", "color": colour, "linewidth": 0.6, "shrinkA": 0.5,
                "shrinkB": 0.0, "relpos": (0.0, 0.5), "clip_on": False,
            },
        )  # fmt: skip
