"""The formation on a straight road: the gain alpha (Section 3.2) and the energy identity (10).

Four robots with errors at the start. Their lanes lie so far apart that no robot comes near another
or a wall, so they keep in safe mode and (7) alone sets their speeds; the limits of these are so
wide that they do not bind. For ideal motion (8) on a straight road, (7) makes the errors e follow
the linear law de/dt = -alpha L e, L the Laplacian of the graph of neighbours.

Larger alpha closes formation errors faster: robots start with random headings and errors of up to
1.5 m either way. The linear theory tells the whole course from the errors at any moment; what is
fitted to the run is fitted to that course too.

(10) is dW/dt = -2 alpha sum of S_i^2. Where all decide at every physics step and go straight
along their lanes, it holds as a sum over each step, dW = -2 alpha dt sum S_i^2
+ (alpha dt)^2 / 2 sum over i and j in N_i of (S_j - S_i)^2, but for rounding. With decisions
every 0.1 s and robots that first turn onto their lanes the left and the right side of (10) are
measured against each other.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from physim.analysis.metrics import column_over_time, desired_leads
from physim.analysis.metrics.modes import is_danger
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction.measures import Measures
from physim.reproduction.model import Arm, Verdict, outcome
from physim.reproduction.study import (
    Runs,
    Share,
    Shown,
    Study,
    estimate,
    falls,
    root_mean_square,
    same,
    time_constant,
)

SETTLED = 4.0
"""[s] by then every robot has turned onto its lane, whatever its heading was"""
LANES = (6.0, 2.0, -2.0, -6.0)
"""[m] lane of each robot, left of the middle positive"""
LEADS = (0.0, -3.0, -1.0, -4.0)
"""[m] desired lead of each robot over the first"""
FIRST = 15.0
"""[m] place of the first robot along the road, but for its error"""
LARGEST_ERROR = 1.5
"""[m] errors at the start are drawn from minus to plus this"""
RING = (("r1", "r2"), ("r2", "r4"), ("r4", "r3"), ("r3", "r1"))
"""pairs of neighbours of the graph in which each has two"""
SECONDS = 60.0


def world_text(
    seed: int,
    *,
    gain: float,
    neighbours: str = "all",
    heading: str = "0.0",
    step: float = 0.01,
    period: float = 0.1,
) -> str:
    """World file: four robots whose errors at the start depend on the seed.

    ``neighbours`` is "all" or "ring"; ``heading`` a number [rad] or the word random.
    """
    errors = np.random.default_rng(seed).uniform(-LARGEST_ERROR, LARGEST_ERROR, len(LEADS))
    graph = "all" if neighbours == "all" else json.dumps(RING)
    robots = "\n".join(
        f"  - name: r{i + 1}\n"
        "    footprint: {length: 1.6, width: 1.0}\n"
        f"    pose: [{FIRST + lead + error:.6f}, {lane}, {heading}]\n"
        f"    path: {{offset: {lane}}}\n"
        "    limits: {v: 2.0}"
        for i, (lead, lane, error) in enumerate(zip(LEADS, LANES, errors, strict=True))
    )
    return (
        f"name: straight road\nseed: {seed}\n"
        f"time: {{step: {step}, duration: {SECONDS}}}\n"
        f"corridor: {{centreline: [[0.0, 0.0], [{SECONDS + 60.0}, 0.0]], width: 20.0}}\n"
        f"robots:\n{robots}\n"
        f"formation: {{gain: {gain}, limits: [0.1, 1.9], spacing: {list(LEADS)}, "
        f"neighbours: {graph}}}\n"
        f"controller: {{update_period: {period}, dwell_times: [{period}], "
        f"longest_interval: {period}}}\n"
    )


def _lanes(label: str, **settings: float | str) -> Arm:
    text = partial(world_text, **settings)  # type: ignore[arg-type]
    return Arm(label, "straight road, four lanes", text=text)


def _settings(record: Record) -> tuple[float, FloatArray]:
    """Gain alpha [1/s], and (N, N) 1 where j is in N_i."""
    given = record.world_settings["formation"]
    if given["neighbours"] == "all":
        return float(given["gain"]), np.ones((record.robots,) * 2) - np.eye(record.robots)
    listed = np.zeros((record.robots, record.robots))
    for a, b in given["neighbours"]:
        i, j = record.names.index(a), record.names.index(b)
        listed[i, j] = listed[j, i] = 1.0
    return float(given["gain"]), listed


def _places(record: Record, station: FloatArray) -> FloatArray:
    """Stations (K, N) less the desired leads (N,): equal where the formation is perfect."""
    leads = desired_leads(record)
    return np.asarray(station - (0.0 if leads is None else leads))


def _linear_course(
    start: FloatArray, gain: float, matrix: FloatArray, time: FloatArray
) -> FloatArray:
    """Errors (K, N) by the linear theory, from those at the start (N,)."""
    rates, modes = np.linalg.eigh(np.diag(matrix.sum(axis=1)) - matrix)
    return np.asarray((np.exp(-gain * np.outer(time, rates)) * (modes.T @ start)) @ modes.T)


def _sums(place: FloatArray, matrix: FloatArray) -> FloatArray:
    """S_i (K, N): the inner sums of (10), positive for a robot that is behind."""
    return np.asarray(place @ matrix - place * matrix.sum(axis=1))


def _energies(place: FloatArray, matrix: FloatArray) -> FloatArray:
    """W (K,) [m^2] by (9)."""
    square = np.square(place[:, None, :] - place[:, :, None])
    return np.asarray(0.5 * np.einsum("ij,kij->k", matrix, square))


GAINS = (0.02, 0.05, 0.1, 0.2)
"""[1/s] alpha"""
SMALLEST_ERROR = 0.01
"""[m] errors below this are no longer fitted: the robots' own motion is about as large"""
TOLERANCE = 0.1
"""[-] by which the time constant may differ from that of the theory"""


def measure_gain(record: Record) -> Measures:
    """Time constant of the errors from `SETTLED` on, and that of the theory from there."""
    time, station = column_over_time(record, "reference_station")
    gain, matrix = _settings(record)
    place = _places(record, station)
    error = place - place.mean(axis=1, keepdims=True)
    size = root_mean_square(error)
    begin = int(np.searchsorted(time, SETTLED))
    small = np.flatnonzero(size[begin:] < SMALLEST_ERROR)
    end = begin + (int(small[0]) if len(small) else len(size) - begin)
    course = _linear_course(error[begin], gain, matrix, time[begin:end] - time[begin])
    constant = time_constant(time[begin:end], size[begin:end])
    theory = time_constant(time[begin:end], root_mean_square(course))
    settled = record.updates["step"] >= SETTLED / record.dt
    speeds = record.updates["applied_v"][settled]
    return {
        "time_constant": constant,
        "theory": theory,
        "over_theory": constant / theory,
        "held": float(np.mean((speeds <= 0.1) | (speeds >= 1.9))),
        "danger": float(np.mean(is_danger(record, record.updates[settled]))),
    }


def conclude_gain(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """Whether the time constants fall with alpha, and whether they are those of the theory."""
    found = [runs.of("time_constant") for runs in arms]
    to_all, ring = found[: len(GAINS)], found[len(GAINS) :]
    ratios = [runs.of("over_theory") for runs in arms]
    medians = [one.median for one in ratios]
    bound = max(max(runs.column("held") + runs.column("danger")) for runs in arms)
    each = (f"{gain:g}/s: {one.text(1, 's')}" for gain, one in zip(GAINS, to_all, strict=True))
    return (
        Verdict(
            "Larger alpha closes formation errors faster",
            "in words only",
            f"time constant, all neighbours of all, at alpha = {'; '.join(each)}",
            falls(to_all, ring),
            "The paper names neither the values of alpha nor a time constant.",
        ),
        Verdict(
            "Formation errors die away as the linear theory of (7) says",
            "errors follow de/dt = -alpha L e (from (7) and (8))",
            f"time constant over that of the theory: {min(medians):.3f} to {max(medians):.3f}, "
            f"medians of {len(arms)} arms; at most {100.0 * bound:.1f} % of a run's decisions at a "
            "speed limit or in danger mode",
            same(ratios, TOLERANCE),
        ),
    )


ALPHA = Study(
    name="alpha",
    title="Formation gain",
    claim="The larger alpha is, the faster formation errors close.",
    arms=tuple(
        _lanes(f"{graph}, α = {gain:g}", gain=gain, neighbours=graph, heading="random")
        for graph in ("all", "ring")
        for gain in GAINS
    ),
    measure=measure_gain,
    conclude=conclude_gain,
    shown={
        "time_constant": Shown("time constant of the errors", "s", logarithmic=True),
        "over_theory": Shown("over that of the theory, 1/(αλ₂)", line=1.0),
    },
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
    time, station = column_over_time(record, "reference_station")
    gain, matrix = _settings(record)
    place = _places(record, station)
    energy = _energies(place, matrix)
    rate = -2.0 * gain * np.square(_sums(place, matrix)).sum(axis=1)  # (10)
    used = np.arange(int(np.searchsorted(time, SETTLED)), len(time) - 1)
    used = used[energy[used] > SMALLEST_ENERGY * energy[0]]
    slope = (energy[used + 1] - energy[used - 1]) / (time[used + 1] - time[used - 1])
    ratio = theory = math.nan
    if len(used):
        course = _linear_course(place[used[0]], gain, matrix, time[used] - time[used[0]])
        theory = time_constant(time[used], _energies(course, matrix))
        ratio = float(np.sum(slope * rate[used]) / np.sum(rate[used] ** 2))
    constant = time_constant(time[used], energy[used])
    return {
        "worst_step": _worst_step(record, matrix, gain),
        "slope_ratio": ratio,
        "time_constant": constant,
        "over_theory": constant / theory,
        "growth": float(np.max(np.diff(energy[used]), initial=-math.inf) / energy[0]),
    }


def _worst_step(record: Record, matrix: FloatArray, gain: float) -> float:
    """Largest difference of a step's change of W from the discrete form, relative to it.

    nan where not all robots decide at every step.
    """
    rows, dt = record.updates, record.dt
    every_step = (rows["next_step"] == rows["step"] + 1).all()
    if len(rows) % record.robots or not every_step:
        return math.nan
    rows = rows[np.lexsort((rows["robot"], rows["step"]))]
    place = _places(record, rows["reference_station"].reshape(-1, record.robots))
    sums, energy = _sums(place, matrix), _energies(place, matrix)
    square = np.square(sums[:, None, :] - sums[:, :, None])
    change = -2.0 * gain * dt * np.square(sums).sum(axis=1)
    change += 0.5 * (gain * dt) ** 2 * np.einsum("ij,kij->k", matrix, square)
    used = energy[:-1] > SMALLEST_ENERGY * energy[0]
    return float(np.max(np.abs(np.diff(energy) - change[:-1])[used] / np.abs(change[:-1])[used]))


def conclude_energy(arms: Sequence[Runs]) -> Sequence[Verdict]:
    """The discrete form step by step, the slope of W, its decay, and whether it ever grows."""
    *ideal, driven = arms
    steps = [one for runs in arms for one in runs.column("worst_step") if not math.isnan(one)]
    worst = max(steps, default=math.nan)
    slope, decay = driven.of("slope_ratio"), driven.of("over_theory")
    shares = [runs.share("growth", lambda value: value <= 0.0) for runs in ideal]
    falling = Share(sum(one.good for one in shares), sum(one.of for one in shares))
    grown = estimate([100.0 * max(0.0, value) for value in driven.column("growth")])
    always = falling.good == falling.of
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
            f"measured over theory, robots that first turn onto their lanes: dW/dt {slope.text(3)},"
            f" time constant of W {decay.text(3)} ({driven.of('time_constant').text(2, 's')})",
            same((runs.of(key) for runs in arms for key in ("slope_ratio", "over_theory")), CLOSE),
        ),
        Verdict(
            "W never grows on a straight road, down to a thousandth of its start",
            "dW/dt <= 0",
            f"ideal motion: no growth from decision to decision in {falling.text} runs; robots "
            f"that first turn onto their lanes: largest growth {grown.text(3)} % of W at the start",
            outcome(always and grown.high <= 0.0, always and grown.high <= 100.0 * SMALLEST_ENERGY),
        ),
    )


ENERGY = Study(
    name="energy",
    title="Formation energy",
    claim="On a straight road the formation energy W falls by (10).",
    arms=(
        _lanes("ideal, all decide\nevery step of 0.05 s", gain=GAIN, step=0.05, period=0.05),
        _lanes(
            "ideal, step 0.05 s,\ntwo neighbours each",
            gain=GAIN, step=0.05, period=0.05, neighbours="ring",
        ),
        _lanes("ideal, all decide\nevery step of 0.01 s", gain=GAIN, period=0.01),
        _lanes("random headings,\ndecide every 0.1 s", gain=GAIN, heading="random"),
    ),
    measure=measure_energy,
    conclude=conclude_energy,
    shown={
        "slope_ratio": Shown("slope dW/dt over (10)", line=1.0),
        "over_theory": Shown("time constant of W over (10)", line=1.0),
    },
    note=lambda runs: (
        "" if math.isnan(worst := max(runs.column("worst_step"))) else
        f"each step\nwithin {worst:.0e}"
    ),
)  # fmt: skip
