"""The width profile of a preview: corridor width along the reference path (Fig. 4)."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim import palette
from physim.plots.style import BLUE, INK, QUIET, VERMILION
from physim.preview.contents import Contents
from physim.preview.ground_plan import MOST_TICKS, hexed, round_step
from physim.preview.words import metres, station_words


def draw_profile(axis: Any, shown: Contents) -> None:
    """Draw width against station, with what the robots need beside it."""
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    station, width = shown.widths.station, shown.widths.width
    finite = np.isfinite(width)
    top = 1.12 * max(float(width[finite].max(initial=0.0)), _most_needed(shown))
    needed = 2.0 * shown.safe_distance
    floor = palette.SAFE_AREA if needed else palette.FLOOR
    under = np.where(finite, width, top)
    for where, colour in ((np.ones_like(finite), floor), (width < needed, palette.DANGER_AREA)):
        axis.fill_between(station, 0.0, under, where=where, color=hexed(colour), linewidth=0.0)
    if shown.boundary_widths is not None:
        other = shown.boundary_widths
        alone = np.where(other.between, other.width, np.nan)
        axis.plot(other.station, alone, "--", color=QUIET, linewidth=0.9)
    axis.plot(station, width, color=BLUE, linewidth=0.8, linestyle=":")
    axis.plot(station, np.where(shown.widths.between, width, np.nan), color=BLUE, linewidth=1.5,
              gid="width")  # fmt: skip
    k = shown.widths.narrowest
    if k is not None:
        axis.plot(station[k], width[k], "o", color=BLUE, markersize=4.5, zorder=4.0)
        words = f"{metres(width[k])} m at {station_words(station[k], shown.length)} m"
        axis.annotate(
            words, (station[k], width[k]), (0, -4), textcoords="offset points",
            ha=_side(station[k] / shown.length), va="top", color=BLUE, fontsize=8.5,
            fontweight="bold",
        )  # fmt: skip
    _needs(axis, shown, top)
    axis.set(xlim=(0.0, shown.length), ylim=(0.0, top))
    axis.set(xlabel="station along the reference path [m]", ylabel="width [m]")
    axis.xaxis.set_major_locator(MultipleLocator(round_step(shown.length, MOST_TICKS)))
    axis.yaxis.set_major_locator(MaxNLocator(5, steps=(1, 2, 5, 10)))


def _side(share: float) -> str:
    return "left" if share < 0.15 else "right" if share > 0.85 else "center"


def _levels(shown: Contents) -> list[tuple[float, str, str, Any]]:
    """Width [m], words, colour and dash of every level that the width is compared with."""
    aligned = max(shown.robots, key=lambda robot: robot.across)
    turning = max(shown.robots, key=lambda robot: robot.reach)
    found = [
        (2.0 * turning.reach, "every robot fits at any heading", INK, (0, (5, 2))),
        (aligned.across, "every robot fits if aligned", INK, (0, (1, 1.5))),
    ]
    if shown.safe_distance:
        found.append(
            (2.0 * shown.safe_distance, "= 2L: no safe area below", VERMILION, (0, (7, 2)))
        )
    return found


def _most_needed(shown: Contents) -> float:
    return max(level for level, *_ in _levels(shown))


def _needs(axis: Any, shown: Contents, top: float) -> None:
    """Level lines, named at their right ends without overlap."""
    high = axis.figure.get_size_inches()[1] * axis.get_position().height * 72.0
    apart = 10.5 * top / high
    levels = sorted(_levels(shown))
    place = -np.inf
    for level, words, colour, dash in levels:
        axis.axhline(level, color=colour, linewidth=1.0, linestyle=dash)
        place = max(level, place + apart)
        axis.annotate(
            f"{metres(level)} m  {words}", (1.0, level), (1.012, place),
            xycoords=axis.get_yaxis_transform(), textcoords=axis.get_yaxis_transform(),
            color=colour, fontsize=7.8, va="center", annotation_clip=False,
        )  # fmt: skip
