"""What the plots of the experiments share: title, points with intervals, single runs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from physim.plots.style import CYCLE, MARKERS, NARROW, QUIET, WIDTH
from physim.reproduction.studies.estimates import column, estimate
from physim.reproduction.study import Runs, Table


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
