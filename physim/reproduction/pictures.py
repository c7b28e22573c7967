"""Pictures of a reproduction: small PNG files, collision times of all pairs, plots of studies."""

from __future__ import annotations

import io
import textwrap
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from physim.analysis.metrics.distances import HORIZON, pair_collision_times
from physim.drawing.plots.style import CYCLE, INK, MARKERS, NARROW, QUIET, WIDTH, styled
from physim.files import draft
from physim.record import Record
from physim.reproduction.study import Runs, Shown, Study, estimate

DPI = 160
COLOURS = 128
"""A palette: a third of the size of full colour, and the eye sees no difference in drawings."""
FLOOR = 0.01
"""[s] least collision time on the axis"""


@contextmanager
def picture(path: Path) -> Iterator[Callable[[Any], None]]:
    """Style of all pictures while a figure is drawn; the function given saves it as PNG.

    The file appears whole or not at all; the same figure gives the same file.
    """

    def keep(figure: Any) -> None:
        from PIL import Image

        drawn = io.BytesIO()
        figure.savefig(drawn, format="png", dpi=DPI)
        small = Image.open(drawn).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
        with draft(path) as part:
            small.save(part, format="PNG", optimize=True)

    with styled(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")  # names in any script
        yield keep


def _figure(title: str, width: float, height: float) -> Any:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    figure.set_layout_engine("constrained", w_pad=0.04, h_pad=0.04)
    figure.suptitle(title, x=0.01, ha="left", fontsize=10.5, fontweight="bold")
    return figure


def pair_times(record: Record) -> Any:
    """Figure: least collision time [s] of all pairs at each step with decisions, log axis."""
    figure = _figure("Collision times of all pairs (Figs. 3c, 6d)", NARROW, 2.8)
    axis = figure.subplots()
    axis.set(xlabel="time [s]", ylabel="least of all pairs [s]", xlim=(0.0, record.time[-1]))
    (time, least), pairs = pair_collision_times(record)
    known = np.isfinite(least)
    axis.set_title(f"none within {HORIZON:g} s: not drawn", loc="right", fontsize=8.0)
    if not known.any():
        return figure
    first = int(np.argmin(least))
    shortest = max(float(least[first]), FLOOR)
    axis.plot(
        time[known], np.maximum(least[known], FLOOR), "o", color=INK, markersize=2.2,
        markeredgewidth=0.0, rasterized=True,
    )  # fmt: skip
    axis.set_yscale("log")
    axis.set_ylim(0.5 * shortest, 1.25 * HORIZON)
    axis.set_yticks([v for v in (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10) if v > 0.5 * shortest])
    axis.yaxis.set_major_formatter("{x:g}")
    axis.minorticks_off()
    names = " and ".join(record.names[i] for i in pairs[first].astype(int))
    late = time[first] > 0.6 * record.time[-1]
    axis.plot(time[first], shortest, "o", color=INK, markersize=5.0, markerfacecolor="none")
    axis.annotate(
        f"{least[first]:.3g} s ({names})", (time[first], shortest), xytext=(-6 if late else 6, -4),
        textcoords="offset points", ha="right" if late else "left", va="top", fontsize=8.0,
    )  # fmt: skip
    return figure


def study_plot(study: Study, arms: Sequence[Runs]) -> Any:
    """Figure: an axis for each measure, a row for each arm, the first on top.

    Medians with 95 % intervals, and every single run as a small dot.
    """
    figure = _figure(study.title, WIDTH, 2.0 + 0.26 * len(arms))
    axes = figure.subplots(1, len(study.shown), sharey=True, squeeze=False)[0]
    for k, (axis, (name, shown)) in enumerate(zip(axes, study.shown.items(), strict=True)):
        for row, mine in enumerate(arms):
            values = mine.column(name)
            places = row + (np.linspace(-0.2, 0.2, len(values)) if len(values) > 1 else np.zeros(1))
            axis.plot(
                values, places, ".", color=QUIET, markersize=4.0, alpha=0.55, markeredgewidth=0.0,
                zorder=3,
            )  # fmt: skip
            middle, low, high, _ = estimate(values)
            axis.errorbar(
                middle, row, xerr=[[middle - low], [high - middle]], color=CYCLE[k],
                marker=MARKERS[k], markersize=5.0, elinewidth=1.3, capsize=3.0, zorder=4,
            )  # fmt: skip
        _scale(axis, shown, len(axes))
        axis.set_yticks(range(len(arms)), [arm.label for arm in study.arms])
        axis.set_ylim(len(arms) - 0.5, -0.5)
        axis.grid(visible=False, axis="y")
        axis.tick_params(axis="y", length=0.0)
    for row, mine in enumerate(arms):
        axes[-1].annotate(
            study.note(mine), (1.03, row), xycoords=("axes fraction", "data"), va="center",
            fontsize=8.0, annotation_clip=False,
        )  # fmt: skip
    return figure


def _scale(axis: Any, shown: Shown, axes: int) -> None:
    axis.set_xlabel(textwrap.fill(f"{shown.words}\xa0[{shown.unit or '–'}]", 60 // axes))
    if shown.line is not None:
        axis.axvline(shown.line, color=INK, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1.5)
    if not shown.logarithmic:
        axis.margins(x=0.12)
        axis.locator_params(axis="x", nbins=4 if axes < 4 else 3)
        return
    axis.set_xscale("log")
    low, high = axis.get_xlim()
    decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
    axis.set_xticks(10.0**decades, [f"{10.0**d:g}" for d in decades])
    axis.minorticks_off()
