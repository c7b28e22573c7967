"""The experiments: verdicts from made-up measures, and what is measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, nan

import numpy as np
import pytest

from physim import simulate
from physim.reproduction.studies import studies
from tests.helpers import inside

Arm, Measures = inside("physim.reproduction", "Arm", "Measures")
Outcome, Study = inside("physim.reproduction", "Outcome", "Study")
Runs, corners = inside("physim.reproduction", "Runs", "corners")
extra_length, TIMES, WORLDS = inside(
    "physim.reproduction.studies", "extra_length", "TIMES", "WORLDS"
)

STUDIES = {study.name: study for study in studies()}
SEEDS = 8

Arms = Sequence[Mapping[str, float]]


def seeds(arms: Arms, spread: float = 0.01) -> list[Runs]:
    """Every arm's measures for each of `SEEDS` seeds, a little apart where they are no counts."""
    factors = np.linspace(1.0 - spread, 1.0 + spread, SEEDS)

    def value(name: str, given: float, factor: float) -> float:
        return given if name in ("contacts", "finished", "growth") else given * factor

    return [Runs([{n: value(n, v, f) for n, v in arm.items()} for f in factors]) for arm in arms]


FALLING = (12.5, 5.0, 2.5, 1.25, 25.0, 10.0, 5.0, 2.5)


def alpha(taus: Sequence[float]) -> Arms:
    rest = {"held": 0.0, "danger": 0.0}
    ratios = (t / e for t, e in zip(taus, FALLING, strict=True))
    return [
        {"time_constant": t, "over_theory": r, **rest} for t, r in zip(taus, ratios, strict=True)
    ]


def energy(worst: float = 1e-12, slope: float = 1.0, growth: float = -1.0) -> Arms:
    one = {"slope_ratio": slope, "time_constant": 2.5, "over_theory": 1.0, "growth": growth}
    ideal = {**one, "worst_step": worst, "slope_ratio": 1.0}
    return [ideal, ideal, ideal, {**one, "worst_step": nan}]


def bends(after: float, before: float, tau: float, final: float) -> Arms:
    one = {
        "peak": 3.0, "after_bends": after, "end_of_straights": before, "risen": 80.0,
        "fallen": 80.0, "time_constant": tau, "theory": 16.0, "over_theory": tau / 16.0,
        "final": final,
    }  # fmt: skip
    return [one, one, one]


def routes(outer: float, inner: float) -> Arms:
    return [{"outer": outer, "between": 1.0, "inner": inner}] * 2


FIXED, LONGEST = (100.0, 20.0, 10.0, 5.0, 3.3, 2.0), (10.1, 5.1, 3.4, 2.1)
RATES = (*FIXED, *LONGEST, 6.0, 5.4, 5.2, 5.0)
COARSE = (4, 5)
"""places of fixed 0.3 and 0.5 s"""


def updates(rates: Sequence[float], touching: Sequence[int] = ()) -> Arms:
    return [
        {"updates": rate, "messages": rate, "evaluations": 2.0 * rate, "kept": 0.1,
         "contacts": float(k in touching)}
        for k, rate in enumerate(rates)
    ]  # fmt: skip


def avoidance(first: float, later: float, bare: float = 1.0, shipped: float = 0.0) -> Arms:
    def arm(between: float, contacts: float) -> Mapping[str, float]:
        rest = {"finished": 1.0, "by_distance": 0.01, "by_time": 0.1, "kept": 0.1}
        return {"shortest_distance": between, "contacts": contacts, **rest}

    kinds = [arm(first, shipped), arm(later, shipped), *[arm(0.1, 0.0)] * 2, arm(0.0, bare)]
    return kinds * len(WORLDS)


def thresholds(share: float, speed: float, far: float) -> Arms:
    calm = {
        "danger_share": 0.1, "averaged_speed_min": 0.9, "farthest_distance": 20.0,
        "contacts": 0.0, "kept": 0.1, "shortest_distance": 0.3,
    }  # fmt: skip
    last = {"danger_share": share, "averaged_speed_min": speed, "farthest_distance": far}
    return [calm] * (len(TIMES) - 1) + [{**calm, **last}]


def switch(kept: float, contacts: float = 0.0, finished: float = 1.0) -> Mapping[str, float]:
    took = 100.0 if finished else nan
    rest = {"finished": finished, "time_to_finish": took, "danger_share": 0.2}
    return {"kept": kept, "contacts": contacts, **rest}


def switching(both: Mapping[str, float], alone: Mapping[str, float]) -> Arms:
    return [both, alone, alone] * 2


def hysteresis(*rates: float) -> Arms:
    rest = {"danger_share": 0.2, "contacts": 0.0, "kept": 0.1}
    return [{"mode_switches": rate, **rest} for rate in rates]


def operation(*took: float) -> Arms:
    rest = {"contacts": 0.0, "danger_share": 0.2, "messages": 20.0, "farthest_distance": 20.0}
    return [
        {"time_to_finish": t if t < inf else nan, "formation_error_peak": t / 10.0, **rest}
        for t in took
    ]


VERDICTS: list[tuple[str, Arms, str]] = [
    ("alpha", alpha(FALLING), "met, met"),
    ("alpha", alpha((5.0,) * 8), "not met"),
    ("alpha", alpha([2.0 * tau for tau in FALLING]), "-, not met"),
    ("energy", energy(), "met, met, met"),
    ("energy", energy(worst=1e-3), "not met"),
    ("energy", energy(worst=nan), "not met"),
    ("energy", energy(slope=2.0), "-, partly met"),
    ("energy", energy(growth=0.5), "-, -, not met"),
    ("bends", bends(1.0, 0.5, 16.0, 0.05), "met, met, met"),
    ("bends", bends(0.5, 1.0, 40.0, 2.0), "not met, not met, not met"),
    ("routes", routes(1.2, 0.8), "met"),
    ("routes", routes(0.95, 0.8), "partly met"),
    ("routes", routes(0.8, 1.2), "not met"),
    ("routes", routes(nan, nan), "not met"),
    ("updates", updates(RATES, COARSE), "met, met, met, met"),
    ("updates", updates((10.0,) * len(RATES)), "no, no, no, no"),
    ("updates", updates(RATES, (*COARSE, 7)), "partly met, partly met, partly met"),
    ("updates", updates(RATES), "-, -, not met"),
    ("avoidance", avoidance(0.4, 0.2), "met, met"),
    ("avoidance", avoidance(0.4, 0.2, bare=0.0), "not met"),
    ("avoidance", avoidance(0.4, 0.2, shipped=1.0), "not met"),
    ("avoidance", avoidance(0.2, 0.4), "-, not met"),
    ("thresholds", thresholds(0.6, 0.9, 20.0), "met"),
    ("thresholds", thresholds(0.4, 0.9, 20.0), "not met"),
    ("thresholds", thresholds(0.6, 0.7, 20.0), "not met"),
    ("thresholds", thresholds(0.6, 0.9, 24.0), "not met"),
    ("switching", switching(switch(0.2), switch(0.1)), "met, met"),
    ("switching", switching(switch(0.2), switch(0.2, contacts=1.0)), "met, met"),
    ("switching", switching(switch(0.2), switch(0.2, finished=0.0)), "met, met"),
    ("switching", switching(switch(0.1), switch(0.2)), "not met, not met"),
    ("switching", switching(switch(0.2), switch(0.2)), "not met, not met"),
    ("switching", switching(switch(0.2, finished=0.0), switch(0.1)), "not met, not met"),
    ("hysteresis", hysteresis(10.0, 20.0, 5.0, 15.0), "met"),
    ("hysteresis", hysteresis(10.0, 20.0, 15.0, 5.0), "partly met"),
    ("hysteresis", hysteresis(10.0, 10.05, 5.0, 15.0), "partly met"),  # not clear
    ("hysteresis", hysteresis(20.0, 10.0, 15.0, 5.0), "not met"),
    ("operation", operation(250.0, 300.0, 250.0), "met"),
    ("operation", operation(250.0, inf, 250.0), "met"),
    ("operation", operation(300.0, 250.0, 250.0), "not met"),
    ("operation", operation(inf, 250.0, 250.0), "not met"),
    ("operation", operation(250.0, 300.0, 200.0), "-, not met"),
    ("operation", operation(250.0, 300.0, 290.0), "-, partly met"),
]
"""What each claim of a study comes to; -: whatever, no: anything but met"""


@pytest.mark.parametrize(("name", "arms", "expected"), VERDICTS)
def test_every_claim_of_a_study_can_fail(name: str, arms: Arms, expected: str) -> None:
    found = [verdict.outcome for verdict in STUDIES[name].conclude(seeds(arms))]
    for outcome, wanted in zip(found, expected.split(", "), strict=False):
        assert wanted in ("-", str(outcome)) or (wanted == "no" and outcome is not Outcome.MET)


def test_no_study_is_without_a_verdict_that_fails() -> None:
    assert {name for name, _, told in VERDICTS if "not met" in told} == STUDIES.keys()


def measured(study: Study, arm: int, seconds: float) -> Measures:
    world = Arm("", "road", (f"time.duration={seconds}",), study.arms[arm].text).load(4)
    with simulate(world, seed=4) as record:
        return study.measure(record)


def test_energy_changes_by_the_discrete_form_of_10_in_every_step() -> None:
    for arm in (0, 1):
        found = measured(STUDIES["energy"], arm, 12.0)
        assert found["worst_step"] < 1e-9
        assert found["slope_ratio"] == pytest.approx(1.0, abs=0.02)
        assert found["over_theory"] == pytest.approx(1.0, rel=0.02)
        assert found["growth"] < 0.0


def test_errors_on_a_straight_road_die_away_as_the_theory_says() -> None:
    found = measured(STUDIES["alpha"], 2, 15.0)
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
    assert corners(line, 0.2) == pytest.approx([5.0])
