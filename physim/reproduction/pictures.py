"""Pictures of a reproduction: small PNG files, collision times of all pairs, plots of studies."""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from physim.analysis.metrics.distances import HORIZON, pair_collision_times
from physim.drafts import discard, draft_of
from physim.drawing.plots.frame import framed, mark, names_of, nothing, time_axis
from physim.drawing.plots.style import CYCLE, INK, MARKERS, NARROW, QUIET, WIDTH, styled
from physim.record import Record
from physim.reproduction.estimates import column, estimate
from physim.reproduction.study import Runs, Table

DPI = 160
COLOURS = 128
"""A palette: a third of the size of full colour, and the eye sees no difference in drawings."""


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
        part = draft_of(path)
        try:
            small.save(part, format="PNG", optimize=True)
            part.replace(path)
        finally:
            discard(part)

    with styled(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")  # names in any script
        yield keep


FLOOR = 0.01
"""[s] least collision time on the axis"""


def pair_times(record: Record) -> Any:
    """Figure: least collision time [s] of all pairs at each step with decisions, log axis."""
    figure = framed(record, "Collision times of all pairs", "Figs. 3c, 6d")
    axis = figure.subplots()
    axis.set_ylabel("least of all pairs [s]")
    time_axis(axis, record)
    (time, least), pairs = pair_collision_times(record)
    known = np.isfinite(least)
    if not known.any():
        nothing(axis, f"no two robots would meet within {HORIZON:g} s")
        return figure
    first = int(np.argmin(least))
    shortest = float(least[first])
    axis.plot(
        time[known], np.maximum(least[known], FLOOR), "o", color=INK, markersize=2.2,
        markeredgewidth=0.0, rasterized=True,
    )  # fmt: skip
    axis.set_yscale("log")
    axis.set_ylim(0.5 * max(shortest, FLOOR), 1.25 * HORIZON)
    axis.set_yticks([v for v in (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10) if v > 0.5 * shortest])
    axis.yaxis.set_major_formatter("{x:g}")
    axis.minorticks_off()
    axis.set_title(f"none within {HORIZON:g} s: not drawn", loc="right", fontsize=8.0)
    text = f"{shortest:.3g} s ({names_of(record, pairs[first].astype(int))})"
    mark(axis, float(time[first]), max(shortest, FLOOR), text, below=True)
    return figure


def prepared(figure: Any, title: str, *, height: float = 3.2, width: float = NARROW) -> None:
    """Give a figure its size and its title."""
    figure.set_size_inches(width, height)
    figure.set_layout_engine("constrained", w_pad=0.04, h_pad=0.04)
    figure.suptitle(title, x=0.01, ha="left", fontsize=10.5, fontweight="bold")


def points(
    axis: Any,
    places: Sequence[float],
    columns: Iterable[Iterable[float]],
    colour: str,
    marker: str = "o",
    label: str = "",
    *,
    across: bool = False,
) -> None:
    """Medians with 95 % intervals at places of the x axis; ``across``: of the y axis."""
    found = [estimate(values) for values in columns]
    middle = [one.median for one in found]
    error = [[one.median - one.low for one in found], [one.high - one.median for one in found]]
    where = (middle, places, None, error) if across else (places, middle, error, None)
    axis.errorbar(
        *where, color=colour, marker=marker, markersize=5.0, linestyle="none", elinewidth=1.3,
        capsize=3.0, label=label, zorder=4,
    )  # fmt: skip


def single_runs(
    axis: Any,
    place: float,
    values: Sequence[float],
    colour: str = QUIET,
    *,
    reach: float = 0.09,
    across: bool = False,
) -> None:
    """Every single run as a small dot beside a place of the x axis, in the order of seeds.

    They are spread by ``reach`` to either side; ``across``: beside a place of the y axis.
    """
    spread = np.linspace(-reach, reach, len(values)) if len(values) > 1 else np.zeros(1)
    where = (values, place + spread) if across else (place + spread, values)
    axis.plot(*where, ".", color=colour, markersize=4.0, alpha=0.55, markeredgewidth=0.0, zorder=3)


def arms_down(axis: Any, labels: Sequence[str]) -> None:
    """One row of the y axis for every arm, the first on top."""
    axis.set_yticks(range(len(labels)), labels)
    axis.set_ylim(len(labels) - 0.5, -0.5)
    axis.grid(visible=False, axis="y")
    axis.tick_params(axis="y", length=0.0)


def rows_of_measures(
    title: str,
    height: float,
    columns: Sequence[tuple[str, str]],
    note: Callable[[Runs], str] | None = None,
    logarithmic: Sequence[str] = (),
) -> Callable[[Any, Sequence[str], Table], None]:
    """Plot of a study: an axis for each measure (name, axis label), a row for each arm.

    Axes of measures named ``logarithmic`` are so; notes stand at the right end of the rows.
    """

    def draw(figure: Any, labels: Sequence[str], arms: Table) -> None:
        prepared(figure, title, height=height, width=WIDTH)
        axes = figure.subplots(1, len(columns), sharey=True, squeeze=False)[0]
        for k, (axis, (name, label)) in enumerate(zip(axes, columns, strict=True)):
            found = [column(mine, name) for mine in arms]
            for row, values in enumerate(found):
                single_runs(axis, row, values, reach=0.2, across=True)
            points(axis, range(len(arms)), found, CYCLE[k], MARKERS[k], across=True)
            if name in logarithmic:
                axis.set_xscale("log")
                low, high = axis.get_xlim()
                decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
                axis.set_xticks(10.0**decades, [f"{10.0**d:g}" for d in decades])
                axis.minorticks_off()
            else:
                axis.margins(x=0.12)
                axis.locator_params(axis="x", nbins=4)
            axis.set_xlabel(label)
            arms_down(axis, labels)
        if note is not None:
            for row, mine in enumerate(arms):
                axes[-1].annotate(
                    note(mine), (1.03, row), xycoords=("axes fraction", "data"), va="center",
                    fontsize=8.0, annotation_clip=False,
                )  # fmt: skip

    return draw
