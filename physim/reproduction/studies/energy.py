"""The energy identity (10): dW/dt = -2 alpha sum of S_i^2 on a straight road.

Four robots, each in a lane of its own. Where all decide at every physics step and go straight along
their lanes, (10) holds as a sum over each step, dW = -2 alpha dt sum S_i^2 + (alpha dt)^2 / 2 sum
over i and j in N_i of (S_j - S_i)^2, but for rounding. With decisions every 0.1 s and robots that
first turn onto their lanes the left and the right side of (10) are measured against each other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.metrics import column_over_time, world_settings
from physim.plots.style import CYCLE, INK, MARKERS
from physim.record import Record
from physim.reproduction.studies.drawing import arms_down, prepared
from physim.reproduction.studies.estimates import column, estimate, freely, outcome, share_text
from physim.reproduction.studies.fits import time_constant
from physim.reproduction.studies.straight_road import (
    energies,
    formation_sums,
    lateness,
    neighbour_matrix,
    world_text,
)
from physim.reproduction.study import Arm, Measures, Study, Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GAIN = 0.05
"""[1/s] alpha"""
SETTLED = 4.0
"""[s] by then every robot has turned onto its lane, whatever its heading was"""
SMALLEST = 1e-3
"""[-] of the energy at the start: below this nothing is measured"""
EXACT = 1e-9
"""[-] what rounding may make of a step's change of W, relative to it"""
CLOSE = 0.05
"""[-] by which the decay may differ from (10) where it is not exact"""


def measure(record: Record) -> Measures:
    """Worst step against the discrete form; slope and time constant of W against (10)."""
    gain = float(world_settings(record)["formation"]["gain"])
    matrix = neighbour_matrix(record)
    time, station = column_over_time(record, "reference_station")
    begin = int(np.searchsorted(time, SETTLED))
    ahead = lateness(record, station)
    energy = energies(ahead, matrix)
    rate = -2.0 * gain * np.square(formation_sums(ahead, matrix)).sum(axis=1)  # (10)
    used = np.arange(begin, len(time) - 1)
    used = used[energy[used] > SMALLEST * energy[0]]
    slope = (energy[used + 1] - energy[used - 1]) / (time[used + 1] - time[used - 1])
    fitted = time_constant(time[used], energy[used])
    ratio = float(np.sum(slope * rate[used]) / np.sum(rate[used] ** 2)) if len(used) else math.nan
    return {
        "worst_step": worst_step(record, matrix, gain),
        "slope_ratio": ratio,
        "time_constant": fitted,
        "theory": decay_of(ahead[used], time[used], matrix, gain),
        "growth": float(np.max(np.diff(energy[used]), initial=-math.inf) / energy[0]),
    }


def worst_step(record: Record, matrix: FloatArray, gain: float) -> float:
    """Largest difference of a step's change of W from the discrete form, relative to it.

    nan where not all robots decide at every step.
    """
    rows = record.updates
    if len(rows) % record.robots or not _every_step(record):
        return math.nan
    rows = rows[np.lexsort((rows["robot"], rows["step"]))]
    ahead = lateness(record, rows["reference_station"].reshape(-1, record.robots))
    sums = formation_sums(ahead, matrix)
    energy = energies(ahead, matrix)
    square = np.square(sums[:, None, :] - sums[:, :, None])
    dt = record.dt
    change = -2.0 * gain * dt * np.square(sums).sum(axis=1)
    change += 0.5 * (gain * dt) ** 2 * np.einsum("ij,kij->k", matrix, square)
    used = energy[:-1] > SMALLEST * energy[0]
    return float(np.max(np.abs(np.diff(energy) - change[:-1])[used] / np.abs(change[:-1])[used]))


def _every_step(record: Record) -> bool:
    return bool((record.updates["next_step"] == record.updates["step"] + 1).all())


def decay_of(ahead: FloatArray, time: FloatArray, matrix: FloatArray, gain: float) -> float:
    """Time constant [s] that W would have over these times by (7) and (8), fitted likewise."""
    if not len(time):
        return math.nan
    laplacian = np.diag(matrix.sum(axis=1)) - matrix
    rates, modes = np.linalg.eigh(laplacian)
    course = (np.exp(-gain * np.outer(time - time[0], rates)) * (modes.T @ ahead[0])) @ modes.T
    return time_constant(time, energies(course, matrix))


def conclude(arms: Sequence[Sequence[Measures]]) -> Sequence[Verdict]:
    """The discrete form step by step, the slope of W, its decay, and whether it ever grows."""
    exact = [run["worst_step"] for runs_ in arms for run in runs_]
    worst = max((one for one in exact if not math.isnan(one)), default=math.nan)
    slopes = [estimate(column(mine, "slope_ratio")) for mine in arms]
    decays = [estimate([r["time_constant"] / r["theory"] for r in mine]) for mine in arms]
    near = [abs(one.median - 1.0) <= CLOSE for one in (*slopes, *decays)]
    driven = arms[-1]
    ideal = [run for mine in arms[:-1] for run in mine]
    falls = freely(ideal, "growth", lambda value: value <= 0.0)
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
            f"({estimate(column(driven, 'time_constant')).text(2, 's')})",
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
                falls[0] == falls[1] and grown.high <= 100.0 * SMALLEST,
            ),
        ),
    )


def draw(figure: Figure, arms: Sequence[Sequence[Measures]]) -> None:
    """Slope and time constant of W over those of (10), a row for every arm."""
    prepared(figure, "Formation energy W falls as (10) says", height=2.9)
    axis = figure.subplots()
    labels = [arm.label for arm in STUDY.arms]
    rows = (("slope_ratio", None, -0.16, "slope dW/dt"),
            ("time_constant", "theory", 0.16, "time constant of W"))  # fmt: skip
    for k, (name, over, shift, label) in enumerate(rows):
        for row, mine in enumerate(arms):
            values = [r[name] / (r[over] if over else 1.0) for r in mine]
            one = estimate(values)
            axis.errorbar(
                [one.median], [row + shift],
                xerr=[[one.median - one.low], [one.high - one.median]],
                color=CYCLE[k], marker=MARKERS[k], markersize=5.0, capsize=3.0,
                label=label if row == 0 else None, linestyle="none",
            )  # fmt: skip
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


def _arm(label: str, **settings: object) -> Arm:
    text = partial(world_text, name="straight road", gain=GAIN, **settings)  # type: ignore[arg-type]
    return Arm(label, "straight road, four lanes", text=text)


STUDY = Study(
    name="energy",
    title="Formation energy",
    claim="On a straight road the formation energy W falls by (10).",
    arms=(
        _arm("ideal, all decide\nevery step of 0.05 s", step=0.05, period=0.05),
        _arm("ideal, step 0.05 s,\ntwo neighbours each", step=0.05, period=0.05, neighbours="ring"),
        _arm("ideal, all decide\nevery step of 0.01 s", period=0.01),
        _arm("random headings,\ndecide every 0.1 s", heading="random"),
    ),
    measure=measure,
    conclude=conclude,
    draw=draw,
)
