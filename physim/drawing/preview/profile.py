"""The width profile of a preview: corridor width along the first robot's path (Fig. 4)."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.drawing import palette
from physim.drawing.labels import round_step, significant, spread
from physim.drawing.palette import hexed
from physim.drawing.plots.frame import mark
from physim.drawing.plots.style import INK, QUIET, WIDTHS
from physim.drawing.preview.contents import Contents, station_words
from physim.drawing.preview.ground_plan import MOST_TICKS
from physim.geometry.polygon import least_width


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
    _name_narrowest(axis, preview)
    _needs(axis, preview, top)
    axis.set(xlim=(0.0, preview.course_length), ylim=(0.0, top))
    axis.set(xlabel="station along the path of the first robot [m]", ylabel="width [m]")
    axis.xaxis.set_major_locator(MultipleLocator(round_step(preview.course_length, MOST_TICKS)))
    axis.yaxis.set_major_locator(MaxNLocator(5, steps=(1, 2, 5, 10)))


def _name_narrowest(axis: Any, preview: Contents) -> None:
    """Mark the narrowest place and write its width beside it."""
    station, width, k = preview.widths.station, preview.widths.width, preview.widths.narrowest
    if k is None:
        return
    place = station_words(float(station[k]), preview.course_length)
    words = f"{significant(float(width[k]))} m at {place} m"
    mark(axis, float(station[k]), float(width[k]), words, below=True, colour=WIDTHS)


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
