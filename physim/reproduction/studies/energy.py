"""The formation on a straight road: the gain alpha (Section 3.2) and the energy identity (10).

Larger alpha closes formation errors faster: four robots, each in a lane of its own, start with
random headings and errors of up to 1.5 m either way. The linear theory tells the whole course
from the errors at any moment; what is fitted to the run is fitted to that course too.

(10) is dW/dt = -2 alpha sum of S_i^2. Where all decide at every physics step and go straight
along their lanes, it holds as a sum over each step, dW = -2 alpha dt sum S_i^2
+ (alpha dt)^2 / 2 sum over i and j in N_i of (S_j - S_i)^2, but for rounding. With decisions
every 0.1 s and robots that first turn onto their lanes the left and the right side of (10) are
measured against each other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from physim.analysis.metrics.modes import is_danger
from physim.drawing.plots.style import CYCLE, INK, MARKERS
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction.estimates import (
    column,
    count,
    estimate,
    estimated,
    outcome,
    root_mean_square,
    share_text,
    time_constant,
)
from physim.reproduction.pictures import arms_down, points, prepared
from physim.reproduction.studies.straight_road import (
    SETTLED,
    energies,
    formation_sums,
    linear_course,
    relative_stations,
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


GAIN = 0.05
"""[1/s] alpha"""
SMALLEST_ENERGY = 1e-3
"""[-] of the energy at the start: below this nothing is measured"""
EXACT = 1e-9
"""[-] what rounding may make of a step's change of W, relative to it"""
CLOSE = 0.05
"""[-] by which the decay may differ from (10) where it is not exact"""


def measure_energy(record: Record) -> Measures:
    """Worst step against the discrete form; slope and time constant of W against (10)."""
    gain, matrix, time, place = settings_and_stations(record)
    begin = int(np.searchsorted(time, SETTLED))
    energy = energies(place, matrix)
    rate = -2.0 * gain * np.square(formation_sums(place, matrix)).sum(axis=1)  # (10)
    used = np.arange(begin, len(time) - 1)
    used = used[energy[used] > SMALLEST_ENERGY * energy[0]]
    slope = (energy[used + 1] - energy[used - 1]) / (time[used + 1] - time[used - 1])
    theory = math.nan
    if len(used):
        course = linear_course(place[used[0]], gain, matrix, time[used] - time[used[0]])
        theory = time_constant(time[used], energies(course, matrix))
    return {
        "worst_step": worst_step(record, matrix, gain),
        "slope_ratio": float(np.sum(slope * rate[used]) / np.sum(rate[used] ** 2))
        if len(used)
        else math.nan,
        "time_constant": time_constant(time[used], energy[used]),
        "theory": theory,
        "growth": float(np.max(np.diff(energy[used]), initial=-math.inf) / energy[0]),
    }


def worst_step(record: Record, matrix: FloatArray, gain: float) -> float:
    """Largest difference of a step's change of W from the discrete form, relative to it.

    nan where not all robots decide at every step.
    """
    rows = record.updates
    every_step = (rows["next_step"] == rows["step"] + 1).all()
    if len(rows) % record.robots or not every_step:
        return math.nan
    rows = rows[np.lexsort((rows["robot"], rows["step"]))]
    place = relative_stations(record, rows["reference_station"].reshape(-1, record.robots))
    sums, energy = formation_sums(place, matrix), energies(place, matrix)
    square = np.square(sums[:, None, :] - sums[:, :, None])
    dt = record.dt
    change = -2.0 * gain * dt * np.square(sums).sum(axis=1)
    change += 0.5 * (gain * dt) ** 2 * np.einsum("ij,kij->k", matrix, square)
    used = energy[:-1] > SMALLEST_ENERGY * energy[0]
    return float(np.max(np.abs(np.diff(energy) - change[:-1])[used] / np.abs(change[:-1])[used]))


def conclude_energy(arms: Table) -> Sequence[Verdict]:
    """The discrete form step by step, the slope of W, its decay, and whether it ever grows."""
    exact = [run["worst_step"] for runs in arms for run in runs]
    worst = max((one for one in exact if not math.isnan(one)), default=math.nan)
    slopes = [estimated(mine, "slope_ratio") for mine in arms]
    decays = [estimate([r["time_constant"] / r["theory"] for r in mine]) for mine in arms]
    near = [abs(one.median - 1.0) <= CLOSE for one in (*slopes, *decays)]
    driven = arms[-1]
    ideal = [run for mine in arms[:-1] for run in mine]
    falls = count(ideal, "growth", lambda value: value <= 0.0)
    grown = estimate([100.0 * max(0.0, value) for value in column(driven, "growth")])
    return (
        Verdict(
            "W changes by (10) in every step",
            "dW/dt = -2 alpha sum S_i^2, here summed over a step",
            f"largest relative difference of any step of any run: {worst:.1e}",
            outcome(worst <= EXACT, worst <= 1e-6),
            "The paper derives (10) and shows no measurement of it.",
        ),
        Verdict(
            "dW/dt and the decay rate of W are those of (10)",
            "dW/dt = -2 alpha sum S_i^2",
            f"measured over theory, robots that first turn onto their lanes: dW/dt "
            f"{slopes[-1].text(3)}, time constant of W {decays[-1].text(3)} "
            f"({estimated(driven, 'time_constant').text(2, 's')})",
            outcome(all(near), any(near)),
        ),
        Verdict(
            "W never grows on a straight road, down to a thousandth of its start",
            "dW/dt <= 0",
            f"ideal motion: no growth from decision to decision in {share_text(*falls)} runs; "
            "robots that first turn onto their lanes: largest growth "
            f"{grown.text(3)} % of W at the start",
            outcome(
                falls[0] == falls[1] and grown.high <= 0.0,
                falls[0] == falls[1] and grown.high <= 100.0 * SMALLEST_ENERGY,
            ),
        ),
    )


def draw_energy(figure: Figure, labels: Sequence[str], arms: Table) -> None:
    """Slope and time constant of W over those of (10), a row for every arm."""
    prepared(figure, "Formation energy W falls as (10) says", height=2.9)
    axis = figure.subplots()
    slopes = [column(mine, "slope_ratio") for mine in arms]
    decays = [[run["time_constant"] / run["theory"] for run in mine] for mine in arms]
    rows = ((slopes, -0.16, "slope dW/dt"), (decays, 0.16, "time constant of W"))
    for k, (columns, shift, label) in enumerate(rows):
        places = [row + shift for row in range(len(arms))]
        points(axis, places, columns, CYCLE[k], MARKERS[k], label, across=True)
    axis.axvline(1.0, color=INK, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1.5)
    low, high = axis.get_xlim()
    reach = max(0.06, 1.0 - low, high - 1.0)
    axis.set_xlim(1.0 - reach, 1.0 + reach)
    arms_down(axis, labels)
    axis.set_xlabel("measured over (10) [–]")
    worst = [max(column(mine, "worst_step")) for mine in arms]
    for row, value in enumerate(worst):
        if not math.isnan(value):
            axis.annotate(
                f"each step within {value:.0e}", (0.99, row), ha="right", va="center",
                xycoords=("axes fraction", "data"), fontsize=8.0, color=CYCLE[0],
            )  # fmt: skip
    figure.legend(loc="outside lower left", ncols=2)


def _lanes(label: str, **settings: object) -> Arm:
    text = partial(world_text, name="straight road", gain=GAIN, **settings)  # type: ignore[arg-type]
    return Arm(label, "straight road, four lanes", text=text)


ENERGY = Study(
    name="energy",
    title="Formation energy",
    claim="On a straight road the formation energy W falls by (10).",
    arms=(
        _lanes("ideal, all decide\nevery step of 0.05 s", step=0.05, period=0.05),
        _lanes(
            "ideal, step 0.05 s,\ntwo neighbours each", step=0.05, period=0.05, neighbours="ring"
        ),
        _lanes("ideal, all decide\nevery step of 0.01 s", period=0.01),
        _lanes("random headings,\ndecide every 0.1 s", heading="random"),
    ),
    measure=measure_energy,
    conclude=conclude_energy,
    draw=draw_energy,
)
