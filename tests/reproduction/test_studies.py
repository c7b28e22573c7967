"""The experiments: verdicts from made-up measures, plots of them, and what is measured."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
import pytest

from physim import simulate
from physim.reproduction.studies import (
    ALPHA,
    AVOIDANCE,
    BENDS,
    ENERGY,
    HYSTERESIS,
    OPERATION,
    ROUTES,
    SWITCHING,
    THRESHOLDS,
    UPDATES,
    studies,
)
from tests.helpers import inside

styled = inside("physim.drawing.plots", "styled")
make_plan, Arm, Measures = inside("physim.reproduction", "make_plan", "Arm", "Measures")
Outcome, Study = inside("physim.reproduction", "Outcome", "Study")
STATIONS, corners = inside("physim.reproduction.studies", "STATIONS", "corners")
extra_length, TIMES = inside("physim.reproduction.studies", "extra_length", "TIMES")
WORLDS, world_text = inside("physim.reproduction.studies", "WORLDS", "world_text")

MET, PARTLY, NOT_MET = Outcome.MET, Outcome.PARTLY, Outcome.NOT_MET
STUDIES = {study.name: study for study in studies()}
SEEDS = 8

Arms = Sequence[Mapping[str, float]]


def seeds(arms: Arms, spread: float = 0.01) -> list[list[Measures]]:
    """Every arm's measures for each of `SEEDS` seeds, a little apart where they are no counts."""
    factors = np.linspace(1.0 - spread, 1.0 + spread, SEEDS)

    def value(name: str, given: float, factor: float) -> float:
        return given if name in ("contacts", "finished", "growth") else given * factor

    return [[{n: value(n, v, f) for n, v in arm.items()} for f in factors] for arm in arms]


def verdict_of(study: Study, arms: Arms, number: int = 0) -> Outcome:
    return study.conclude(seeds(arms))[number].outcome


def alpha_arms(taus: Sequence[float], theory: Sequence[float]) -> Arms:
    return [
        {"time_constant": t, "theory": e, "held": 0.0, "danger": 0.0}
        for t, e in zip(taus, theory, strict=True)
    ]


FALLING = (12.5, 5.0, 2.5, 1.25, 25.0, 10.0, 5.0, 2.5)


def test_alpha_can_fail() -> None:
    assert verdict_of(ALPHA, alpha_arms(FALLING, FALLING)) is MET
    flat = (5.0,) * 8
    assert verdict_of(ALPHA, alpha_arms(flat, FALLING)) is NOT_MET
    assert verdict_of(ALPHA, alpha_arms(FALLING, FALLING), 1) is MET
    twice = [2.0 * tau for tau in FALLING]
    assert verdict_of(ALPHA, alpha_arms(twice, FALLING), 1) is NOT_MET


def energy_arms(worst: float = 1e-12, slope: float = 1.0, growth: float = -1.0) -> Arms:
    one = {"slope_ratio": slope, "time_constant": 2.5, "theory": 2.5, "growth": growth}
    ideal = {**one, "worst_step": worst, "slope_ratio": 1.0}
    return [ideal, ideal, ideal, {**one, "worst_step": math.nan}]


def test_energy_can_fail() -> None:
    for number in range(3):
        assert verdict_of(ENERGY, energy_arms(), number) is MET
    assert verdict_of(ENERGY, energy_arms(worst=1e-3)) is NOT_MET
    assert verdict_of(ENERGY, energy_arms(worst=math.nan)) is NOT_MET
    assert verdict_of(ENERGY, energy_arms(slope=2.0), 1) is PARTLY
    assert verdict_of(ENERGY, energy_arms(growth=0.5), 2) is NOT_MET


def bends_arms(after: float, before: float, tau: float, final: float) -> Arms:
    places = {f"at_{s}": 1.0 for s in STATIONS}
    one = {
        "peak": 3.0, "after_bends": after, "end_of_straights": before, "risen": 80.0,
        "fallen": 80.0, "time_constant": tau, "theory": 16.0, "final": final, **places,
    }  # fmt: skip
    return [one, one, one]


def test_bends_can_fail() -> None:
    for number in range(3):
        assert verdict_of(BENDS, bends_arms(1.0, 0.5, 16.0, 0.05), number) is MET
        assert verdict_of(BENDS, bends_arms(0.5, 1.0, 40.0, 2.0), number) is NOT_MET


def routes_arms(outer: float, inner: float) -> Arms:
    return [{"outer": outer, "between": 1.0, "inner": inner}] * 2


def test_routes_can_fail() -> None:
    assert verdict_of(ROUTES, routes_arms(1.2, 0.8)) is MET
    assert verdict_of(ROUTES, routes_arms(0.95, 0.8)) is PARTLY
    assert verdict_of(ROUTES, routes_arms(0.8, 1.2)) is NOT_MET
    assert verdict_of(ROUTES, routes_arms(math.nan, math.nan)) is NOT_MET


def updates_arms(rates: Sequence[float], touching: Sequence[int] = ()) -> Arms:
    return [
        {
            "updates": rate, "messages": rate, "evaluations": 2.0 * rate, "kept": 0.1,
            "contacts": float(k in touching),
        }
        for k, rate in enumerate(rates)
    ]  # fmt: skip


FIXED = (100.0, 20.0, 10.0, 5.0, 3.3, 2.0)
LONGEST = (10.1, 5.1, 3.4, 2.1)
RATES = (*FIXED, *LONGEST, 6.0, 5.4, 5.2, 5.0)
COARSE = (4, 5)
"""places of fixed 0.3 and 0.5 s"""


def test_updates_can_fail() -> None:
    good = updates_arms(RATES, touching=COARSE)
    assert [verdict_of(UPDATES, good, number) for number in range(4)] == [MET] * 4
    flat = updates_arms((10.0,) * len(RATES))
    for number in range(4):
        assert verdict_of(UPDATES, flat, number) is not MET
    touching = updates_arms(RATES, touching=(*COARSE, len(FIXED) + LONGEST.index(5.1)))
    assert verdict_of(UPDATES, touching, 0) is PARTLY
    assert verdict_of(UPDATES, touching, 1) is PARTLY
    assert verdict_of(UPDATES, touching, 2) is PARTLY
    assert verdict_of(UPDATES, updates_arms(RATES), 2) is NOT_MET


def avoidance_arms(first: float, later: float, bare: float = 1.0, shipped: float = 0.0) -> Arms:
    rest = {"finished": 1.0, "by_distance": 0.01, "by_time": 0.1, "kept": 0.1}

    def arm(between: float, contacts: float) -> Mapping[str, float]:
        return {"shortest_distance": between, "contacts": contacts, **rest}

    kinds = [arm(first, shipped), arm(later, shipped), *[arm(0.1, 0.0)] * 2, arm(0.0, bare)]
    return kinds * len(WORLDS)


def test_avoidance_can_fail() -> None:
    assert verdict_of(AVOIDANCE, avoidance_arms(0.4, 0.2)) is MET
    assert verdict_of(AVOIDANCE, avoidance_arms(0.4, 0.2, bare=0.0)) is NOT_MET
    assert verdict_of(AVOIDANCE, avoidance_arms(0.4, 0.2, shipped=1.0)) is NOT_MET
    assert verdict_of(AVOIDANCE, avoidance_arms(0.4, 0.2), 1) is MET
    assert verdict_of(AVOIDANCE, avoidance_arms(0.2, 0.4), 1) is NOT_MET


def threshold_arms(share: float, speed: float, far: float) -> Arms:
    calm = {
        "danger_share": 0.1, "averaged_speed_min": 0.9, "farthest_distance": 20.0,
        "contacts": 0.0, "kept": 0.1, "shortest_distance": 0.3,
    }  # fmt: skip
    last = {"danger_share": share, "averaged_speed_min": speed, "farthest_distance": far}
    return [calm] * (len(TIMES) - 1) + [{**calm, **last}]


def test_thresholds_can_fail() -> None:
    assert verdict_of(THRESHOLDS, threshold_arms(0.6, 0.9, 20.0)) is MET
    assert verdict_of(THRESHOLDS, threshold_arms(0.4, 0.9, 20.0)) is NOT_MET
    assert verdict_of(THRESHOLDS, threshold_arms(0.6, 0.7, 20.0)) is NOT_MET
    assert verdict_of(THRESHOLDS, threshold_arms(0.6, 0.9, 24.0)) is NOT_MET


def switch(kept: float, contacts: float = 0.0, finished: float = 1.0) -> Mapping[str, float]:
    took = 100.0 if finished else math.nan
    return {
        "kept": kept, "contacts": contacts, "finished": finished, "time_to_finish": took,
        "danger_share": 0.2,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("both", "alone", "expected"),
    [
        (switch(0.2), switch(0.1), MET),
        (switch(0.2), switch(0.2, contacts=1.0), MET),
        (switch(0.2), switch(0.2, finished=0.0), MET),
        (switch(0.1), switch(0.2), NOT_MET),
        (switch(0.2), switch(0.2), NOT_MET),
        (switch(0.2, finished=0.0), switch(0.1), NOT_MET),
    ],
)
def test_switching_can_fail(
    both: Mapping[str, float], alone: Mapping[str, float], expected: Outcome
) -> None:
    for number in range(2):
        assert verdict_of(SWITCHING, [both, alone, alone] * 2, number) is expected


def test_switching_better_in_one_world_only_is_partly_met() -> None:
    arms = [switch(0.2), switch(0.1), switch(0.1), switch(0.1), switch(0.2), switch(0.2)]
    assert verdict_of(SWITCHING, arms) is PARTLY


def test_hysteresis_can_fail() -> None:
    def arms(*rates: float) -> Arms:
        rest = {"danger_share": 0.2, "contacts": 0.0, "kept": 0.1}
        return [{"mode_switches": rate, **rest} for rate in rates]

    assert verdict_of(HYSTERESIS, arms(10.0, 20.0, 5.0, 15.0)) is MET
    assert verdict_of(HYSTERESIS, arms(10.0, 20.0, 15.0, 5.0)) is PARTLY
    assert verdict_of(HYSTERESIS, arms(10.0, 10.05, 5.0, 15.0)) is PARTLY  # not clear
    assert verdict_of(HYSTERESIS, arms(20.0, 10.0, 15.0, 5.0)) is NOT_MET


def operation_arms(*took: float) -> Arms:
    rest = {"contacts": 0.0, "danger_share": 0.2, "messages": 20.0, "farthest_distance": 20.0}
    return [
        {
            "time_to_finish": t if t < math.inf else math.nan,
            "formation_error_peak": t / 10.0, **rest,
        }
        for t in took
    ]  # fmt: skip


def test_operation_can_fail() -> None:
    assert verdict_of(OPERATION, operation_arms(250.0, 300.0, 250.0)) is MET
    assert verdict_of(OPERATION, operation_arms(250.0, math.inf, 250.0)) is MET
    assert verdict_of(OPERATION, operation_arms(300.0, 250.0, 250.0)) is NOT_MET
    assert verdict_of(OPERATION, operation_arms(math.inf, 250.0, 250.0)) is NOT_MET
    assert verdict_of(OPERATION, operation_arms(250.0, 300.0, 200.0), 1) is NOT_MET
    assert verdict_of(OPERATION, operation_arms(250.0, 300.0, 290.0), 1) is PARTLY


MADE_UP: Mapping[str, Callable[[], Arms]] = {
    "alpha": lambda: alpha_arms(FALLING, FALLING),
    "energy": energy_arms,
    "bends": lambda: bends_arms(1.0, 0.5, 16.0, 0.05),
    "routes": lambda: routes_arms(1.2, 0.8),
    "switching": lambda: [switch(0.2), switch(0.1), switch(0.1, finished=0.0)] * 2,
    "hysteresis": lambda: [
        {"mode_switches": 9.0, "danger_share": 0.2, "contacts": 0.0, "kept": 0.1}
    ] * 4,
    "updates": lambda: updates_arms(RATES),
    "avoidance": lambda: avoidance_arms(0.4, 0.2),
    "thresholds": lambda: threshold_arms(0.6, 0.7, 24.0),
    "operation": lambda: operation_arms(250.0, math.inf, 260.0),
}  # fmt: skip


@pytest.mark.parametrize("name", STUDIES)
def test_studies_without_a_meaningful_figure_conclude_and_draw(name: str) -> None:
    """Every measure nan, one seed: no claim may come out met, and nothing may break."""
    from matplotlib.figure import Figure

    study = STUDIES[name]
    arms = [[dict.fromkeys(arm, math.nan)] for arm in MADE_UP[name]()]
    assert MET not in [verdict.outcome for verdict in study.conclude(arms)]
    with styled():
        study.draw(Figure(), study.labels, arms)


@pytest.mark.parametrize("name", STUDIES)
def test_every_arm_loads_and_can_be_sent_to_a_worker(name: str) -> None:
    study = STUDIES[name]
    assert pickle.loads(pickle.dumps(study.measure)) is study.measure
    assert len(set(study.labels)) == len(study.labels)
    for arm in study.arms:
        same = pickle.loads(pickle.dumps(arm))
        assert same.load(3) == arm.load(3)


def test_overrides_hold_for_a_world_of_the_study_too() -> None:
    text = partial(world_text, name="road", gain=0.05)
    assert Arm("one", "road", ("time.duration=5",), text).load(1).time.duration == 5.0


def measured(study: Study, arm: int, seconds: float) -> Measures:
    world = Arm("", "road", (f"time.duration={seconds}",), study.arms[arm].text).load(4)
    with simulate(world, seed=4) as record:
        return study.measure(record)


def test_energy_changes_by_the_discrete_form_of_10_in_every_step() -> None:
    for arm in (0, 1):
        found = measured(ENERGY, arm, 12.0)
        assert found["worst_step"] < 1e-9
        assert found["slope_ratio"] == pytest.approx(1.0, abs=0.02)
        assert found["time_constant"] == pytest.approx(found["theory"], rel=0.02)
        assert found["growth"] < 0.0


def test_errors_on_a_straight_road_die_away_as_the_theory_says() -> None:
    found = measured(ALPHA, 2, 15.0)
    assert found["theory"] == pytest.approx(1.0 / (0.1 * 4), rel=1e-6)
    assert found["time_constant"] == pytest.approx(found["theory"], rel=0.1)
    assert found["held"] == found["danger"] == 0.0


def test_outside_of_a_bend_the_route_is_longer() -> None:
    angle = np.linspace(0.0, 1.0, 101)
    arc = 50.0 * np.column_stack((np.sin(angle), 1.0 - np.cos(angle)))  # to the left
    centre = np.array([0.0, 50.0])
    middle = centre + 50.0 * np.array([[np.sin(0.5), -np.cos(0.5)]])
    outside = centre + 52.0 * np.array([[np.sin(0.5), -np.cos(0.5)]])
    station = np.array([25.0])
    assert extra_length(arc, station, outside) == pytest.approx(2.0 / 50.0, rel=0.03)
    assert extra_length(arc, station, middle) == pytest.approx(0.0, abs=1e-3)


def test_corners_are_where_the_path_turns_sharply() -> None:
    line = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 9.0], [3.1, 12.0]])
    assert corners(line) == pytest.approx([5.0])
