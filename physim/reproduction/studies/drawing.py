"""What the plots of the experiments share: title, points with intervals, single runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from physim.plots.style import CYCLE, INK, MARKERS, NARROW, QUIET
from physim.reproduction.studies.estimates import column, estimate
from physim.reproduction.study import Measures


def prepared(figure: Any, title: str, *, height: float = 3.2, width: float = NARROW) -> Any:
    """Figure of the right size with its title; returns it."""
    figure.set_size_inches(width, height)
    figure.set_layout_engine("constrained", w_pad=0.04, h_pad=0.04)
    figure.suptitle(title, x=0.01, ha="left", fontsize=10.5, fontweight="bold")
    return figure


def points(
    axis: Any,
    places: Sequence[float],
    columns: Iterable[Iterable[float]],
    colour: str,
    marker: str = "o",
    label: str = "",
    *,
    joined: bool = False,
) -> Any:
    """Medians with 95 % intervals at places of the x axis; returns the handle for the legend."""
    found = [estimate(values) for values in columns]
    middle = np.array([one.median for one in found])
    low = np.array([one.median - one.low for one in found])
    high = np.array([one.high - one.median for one in found])
    return axis.errorbar(
        places, middle, yerr=np.array([low, high]), color=colour, marker=marker, markersize=5.0,
        linestyle="-" if joined else "none", linewidth=1.0, elinewidth=1.3, capsize=3.0,
        label=label, zorder=4,
    )  # fmt: skip


def runs(axis: Any, place: float, values: Iterable[float], colour: str = QUIET) -> None:
    """Every single run as a small dot beside ``place``, spread in the order of seeds."""
    given = list(values)
    spread = np.linspace(-0.09, 0.09, len(given)) if len(given) > 1 else np.zeros(1)
    axis.plot(
        place + spread, given, ".", color=colour, markersize=4.0, alpha=0.55,
        markeredgewidth=0.0, zorder=3,
    )  # fmt: skip


def arms_axis(axis: Any, labels: Sequence[str]) -> None:
    """One place of the x axis for every arm, with its label."""
    axis.set_xticks(range(len(labels)), labels)
    axis.set_xlim(-0.5, len(labels) - 0.5)
    axis.grid(visible=False, axis="x")
    axis.tick_params(axis="x", length=0.0)


def arms_down(axis: Any, labels: Sequence[str]) -> None:
    """One row of the y axis for every arm, the first on top."""
    axis.set_yticks(range(len(labels)), labels)
    axis.set_ylim(len(labels) - 0.5, -0.5)
    axis.grid(visible=False, axis="y")
    axis.tick_params(axis="y", length=0.0)


def reference_line(axis: Any, value: float, text: str) -> None:
    """Thin line across at a value of the y axis, named at its right end."""
    axis.axhline(value, color=INK, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1.5)
    axis.annotate(
        text, (1.0, value), xycoords=("axes fraction", "data"), xytext=(-2, 2),
        textcoords="offset points", ha="right", va="bottom", fontsize=8.0, color=QUIET,
    )  # fmt: skip


def rows_of_measures(
    figure: Any,
    labels: Sequence[str],
    arms: Sequence[Sequence[Measures]],
    columns: Sequence[tuple[str, str, bool]],
    notes: Sequence[str] = (),
) -> None:
    """One axis for each measure (name, axis label, logarithmic), a row for each arm.

    Notes stand at the right end of the rows.
    """
    axes = figure.subplots(1, len(columns), sharey=True, squeeze=False)[0]
    for k, (axis, (name, label, logarithmic)) in enumerate(zip(axes, columns, strict=True)):
        for row, mine in enumerate(arms):
            values = column(mine, name)
            one = estimate(values)
            spread = np.linspace(-0.2, 0.2, len(values)) if len(values) > 1 else np.zeros(1)
            axis.plot(
                values, row + spread, ".", color=QUIET, markersize=3.5, alpha=0.5,
                markeredgewidth=0.0, zorder=3,
            )  # fmt: skip
            axis.errorbar(
                [one.median], [row], xerr=[[one.median - one.low], [one.high - one.median]],
                color=CYCLE[k], marker=MARKERS[k], markersize=5.0, elinewidth=1.3, capsize=3.0,
                linestyle="none", zorder=4,
            )  # fmt: skip
        if logarithmic:
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
    for row, note in enumerate(notes):
        axes[-1].annotate(
            note, (1.03, row), xycoords=("axes fraction", "data"), va="center", fontsize=8.0,
            annotation_clip=False,
        )  # fmt: skip
