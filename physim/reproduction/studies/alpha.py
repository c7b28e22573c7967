"""Larger alpha closes formation errors faster (Section 3.2).

Four robots on a straight road, each in a lane of its own, start with random headings and errors of
up to 1.5 m either way. For ideal motion (8) on a straight road, (7) makes the errors follow the
linear law de/dt = -alpha L e, L the Laplacian of the graph of neighbours; so the theory tells the
whole course from the errors at any moment, and what is fitted to the run is fitted to that course
too.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.metrics import column_over_time, world_settings
from physim.metrics.modes import is_danger
from physim.plots.style import CYCLE, INK
from physim.record import Record
from physim.reproduction.studies.drawing import points, prepared
from physim.reproduction.studies.estimates import column, estimate, outcome
from physim.reproduction.studies.fits import root_mean_square, time_constant
from physim.reproduction.studies.straight_road import lateness, neighbour_matrix, world_text
from physim.reproduction.study import Arm, Measures, Study, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GAINS = (0.02, 0.05, 0.1, 0.2)
"""[1/s] alpha"""
GRAPHS = ("all", "ring")
SETTLED = 4.0
"""[s] by then every robot has turned onto its path, whatever its heading was"""
SMALLEST = 0.01
"""[m] errors below this are no longer fitted: the robots' own motion is about as large"""
TOLERANCE = 0.1
"""[-] by which the time constant may differ from that of the theory"""


def measure(record: Record) -> Measures:
    """Time constant of the errors from `SETTLED` on, and that of the theory from there."""
    time, station = column_over_time(record, "reference_station")
    matrix = neighbour_matrix(record)
    ahead = lateness(record, station)
    ahead = ahead - ahead.mean(axis=1, keepdims=True)
    size = root_mean_square(ahead)
    begin = int(np.searchsorted(time, SETTLED))
    small = np.flatnonzero(size[begin:] < SMALLEST)
    end = begin + (int(small[0]) if len(small) else len(size) - begin)
    gain = float(world_settings(record)["formation"]["gain"])
    theory = linear_course(ahead[begin], gain, matrix, time[begin:end] - time[begin])
    settled = record.updates["step"] >= SETTLED / record.dt
    speeds = record.updates["applied_v"][settled]
    return {
        "time_constant": time_constant(time[begin:end], size[begin:end]),
        "theory": time_constant(time[begin:end], root_mean_square(theory)),
        "held": float(np.mean((speeds <= 0.1) | (speeds >= 1.9))),
        "danger": float(np.mean(is_danger(record, record.updates[settled]))),
    }


def linear_course(
    start: FloatArray, gain: float, matrix: FloatArray, time: FloatArray
) -> FloatArray:
    """Errors (K, N) by the linear theory, from those at the start (N,)."""
    laplacian = np.diag(matrix.sum(axis=1)) - matrix
    rates, modes = np.linalg.eigh(laplacian)
    return np.asarray((np.exp(-gain * np.outer(time, rates)) * (modes.T @ start)) @ modes.T)


def _ratios(runs: Sequence[Measures]) -> list[float]:
    return [run["time_constant"] / run["theory"] for run in runs]


def conclude(arms: Sequence[Sequence[Measures]]) -> Sequence[Verdict]:
    """Whether the time constants fall with alpha, and whether they are those of the theory."""
    by_graph = [arms[: len(GAINS)], arms[len(GAINS) :]]
    found = [[estimate(column(runs, "time_constant")) for runs in graph] for graph in by_graph]
    falls = all(b.high < a.low for graph in found for a, b in zip(graph, graph[1:], strict=False))
    middle = all(
        b.median < a.median for graph in found for a, b in zip(graph, graph[1:], strict=False)
    )
    each = [estimate(_ratios(runs)) for runs in arms]
    near = [abs(one.median - 1.0) <= TOLERANCE for one in each]
    told = "; ".join(f"{g:g}/s: {one.text(1, 's')}" for g, one in zip(GAINS, found[0], strict=True))
    bound = max(max(run["held"], run["danger"]) for runs in arms for run in runs)
    low, high = min(one.median for one in each), max(one.median for one in each)
    return (
        Verdict(
            "Larger alpha closes formation errors faster",
            "in words only",
            f"time constant, all neighbours of all, at alpha = {told}",
            outcome(falls, middle),
            "The paper names neither the values of alpha nor a time constant.",
        ),
        Verdict(
            "Formation errors die away as the linear theory of (7) says",
            "errors follow de/dt = -alpha L e (from (7) and (8))",
            f"time constant over that of the theory: {low:.3f} to {high:.3f}, medians of "
            f"{len(each)} arms; at most {100.0 * bound:.1f} % of a run's decisions at a "
            "speed limit or in danger mode",
            outcome(all(near), any(near)),
        ),
    )


def draw(figure: Figure, arms: Sequence[Sequence[Measures]]) -> None:
    """Time constants over alpha, both axes logarithmic, with the theory's 1/(alpha lambda_2)."""
    prepared(figure, "Larger alpha closes formation errors faster")
    axis = figure.subplots()
    span = np.array([GAINS[0] * 0.8, GAINS[-1] * 1.25])
    looks = ((CYCLE[0], "o", 4.0, "every robot minds all three others"),
             (CYCLE[1], "s", 2.0, "every robot minds two others"))  # fmt: skip
    for k, (colour, marker, rate, label) in enumerate(looks):
        mine = arms[k * len(GAINS) : (k + 1) * len(GAINS)]
        axis.plot(span, 1.0 / (span * rate), color=colour, linewidth=0.9, linestyle=(0, (4, 2)))
        points(axis, GAINS, [column(runs, "time_constant") for runs in mine], colour, marker, label)
    axis.plot([], [], color=INK, linewidth=0.9, linestyle=(0, (4, 2)), label="theory 1/(α λ₂)")
    axis.set(xscale="log", yscale="log", xlim=tuple(span))
    axis.set_xlabel("formation gain α [1/s]")
    axis.set_ylabel("time constant of the errors [s]")
    axis.set_xticks(GAINS, [f"{gain:g}" for gain in GAINS])
    ticks = (1, 2, 5, 10, 20)
    axis.set_yticks(ticks, [f"{tick}" for tick in ticks])
    axis.minorticks_off()
    axis.legend(loc="upper right")


STUDY = Study(
    name="alpha",
    title="Formation gain",
    claim="The larger alpha is, the faster formation errors close.",
    arms=tuple(
        Arm(
            f"{'all' if graph == 'all' else 'ring'}, α = {gain:g}",
            "straight road, four lanes",
            text=partial(
                world_text, name="straight road", gain=gain, neighbours=graph, heading="random"
            ),
        )
        for graph in GRAPHS
        for gain in GAINS
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
)
