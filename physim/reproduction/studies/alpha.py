"""Larger alpha closes formation errors faster (Section 3.2).

Four robots on a straight road, each in a lane of its own, start with random headings and errors of
up to 1.5 m either way. The linear theory tells the whole course from the errors at any moment; what
is fitted to the run is fitted to that course too.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from physim.metrics.modes import is_danger
from physim.plots.style import CYCLE, INK
from physim.record import Record
from physim.reproduction.studies.drawing import points, prepared
from physim.reproduction.studies.estimates import column, estimate, estimated, outcome
from physim.reproduction.studies.fits import root_mean_square, time_constant
from physim.reproduction.studies.straight_road import (
    SETTLED,
    linear_course,
    settings_and_stations,
    world_text,
)
from physim.reproduction.study import Arm, Measures, Study, Table, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GAINS = (0.02, 0.05, 0.1, 0.2)
"""[1/s] alpha"""
GRAPHS = ("all", "ring")
SMALLEST_ERROR = 0.01
"""[m] errors below this are no longer fitted: the robots' own motion is about as large"""
TOLERANCE = 0.1
"""[-] by which the time constant may differ from that of the theory"""


def measure_gain(record: Record) -> Measures:
    """Time constant of the errors from `SETTLED` on, and that of the theory from there."""
    gain, matrix, time, place = settings_and_stations(record)
    error = place - place.mean(axis=1, keepdims=True)
    size = root_mean_square(error)
    begin = int(np.searchsorted(time, SETTLED))
    small = np.flatnonzero(size[begin:] < SMALLEST_ERROR)
    end = begin + (int(small[0]) if len(small) else len(size) - begin)
    theory = linear_course(error[begin], gain, matrix, time[begin:end] - time[begin])
    settled = record.updates["step"] >= SETTLED / record.dt
    speeds = record.updates["applied_v"][settled]
    return {
        "time_constant": time_constant(time[begin:end], size[begin:end]),
        "theory": time_constant(time[begin:end], root_mean_square(theory)),
        "held": float(np.mean((speeds <= 0.1) | (speeds >= 1.9))),
        "danger": float(np.mean(is_danger(record, record.updates[settled]))),
    }


def conclude_gain(arms: Table) -> Sequence[Verdict]:
    """Whether the time constants fall with alpha, and whether they are those of the theory."""
    by_graph = [arms[: len(GAINS)], arms[len(GAINS) :]]
    found = [[estimated(runs, "time_constant") for runs in graph] for graph in by_graph]
    pairs = [pair for graph in found for pair in pairwise(graph)]
    falls = all(b.high < a.low for a, b in pairs)
    middle = all(b.median < a.median for a, b in pairs)
    each = [estimate([run["time_constant"] / run["theory"] for run in runs]) for runs in arms]
    near = [abs(one.median - 1.0) <= TOLERANCE for one in each]
    measured = "; ".join(
        f"{g:g}/s: {one.text(1, 's')}" for g, one in zip(GAINS, found[0], strict=True)
    )
    bound = max(max(run["held"], run["danger"]) for runs in arms for run in runs)
    low, high = min(one.median for one in each), max(one.median for one in each)
    return (
        Verdict(
            "Larger alpha closes formation errors faster",
            "in words only",
            f"time constant, all neighbours of all, at alpha = {measured}",
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


def draw_gain(figure: Figure, labels: Sequence[str], arms: Table) -> None:
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


ALPHA = Study(
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
    measure=measure_gain,
    conclude=conclude_gain,
    draw=draw_gain,
)
