"""The rate of good runs over the strength of what makes them hard, with a target and a bracket."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from physim.drawing.plots.frame import HEAD, finished, head, short
from physim.drawing.plots.style import BAND, DPI, INK, NARROW, QUIET, RULE
from physim.statistics import Decision

HEIGHT = 2.2
"""[in] without title and legend"""
LONGEST_TITLE = 52
"""Characters"""
MARKS = {
    True: ("o", BAND, BAND, "target met"),
    False: ("s", BAND, "white", "target missed"),
    None: ("D", QUIET, RULE, "undecided"),
}
"""By what came of the target: marker, its edge and filling, and what it is"""


def strengths(
    tried: Sequence[tuple[float, Decision]],
    target: float,
    bracket: tuple[float | None, float | None],
    span: tuple[float, float],
    *,
    title: str,
    source: str,
    strength: str,
    rate: str,
) -> Any:
    """Figure of rates with intervals over the strengths that were tried, with the target.

    ``span`` is from the least to the greatest strength. The bracket of the limit is drawn where
    both of its ends are known. ``strength`` and ``rate`` are written beside the axes,
    ``source`` below the title.
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import PercentFormatter

    figure = Figure((NARROW, HEIGHT + HEAD), dpi=DPI)
    head(figure, short(title, LONGEST_TITLE), source)
    axis = figure.add_subplot()
    margin = 0.03 * (span[1] - span[0])
    axis.set(xlabel=strength, ylabel=rate, xlim=(span[0] - margin, span[1] + margin))
    axis.set_ylim(-0.03, 1.03)
    axis.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
    words = f"target {100.0 * target:.10g} %"
    line = axis.axhline(target, color=INK, linewidth=0.9, linestyle=(0, (4, 2)), label=words)
    handles: list[Any] = [line]
    lower, upper = bracket
    if lower is not None and upper is not None:
        words = f"limit, {lower:g} to {upper:g}"
        handles.append(axis.axvspan(lower, upper, color=BAND, alpha=0.25, linewidth=0, label=words))
    for verdict, (marker, edge, fill, words) in MARKS.items():
        some = [(x, one) for x, one in tried if one.holds is verdict and one.runs]
        if some:
            # an interval that holds at all looks may end short of the share of the last look
            shares = [min(max(one.successes / one.runs, one.low), one.high) for _, one in some]
            below = [share - one.low for share, (_, one) in zip(shares, some, strict=True)]
            above = [one.high - share for share, (_, one) in zip(shares, some, strict=True)]
            handles.append(
                axis.errorbar(
                    [x for x, _ in some], shares, (below, above), fmt=marker, color=edge,
                    markerfacecolor=fill, markersize=5, elinewidth=1.0, capsize=2.5, label=words,
                    clip_on=False, zorder=3,
                )
            )  # fmt: skip
    return finished(figure, handles)
