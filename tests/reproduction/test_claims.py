"""Verdicts are computed: every claim can be met and can fail, and seeds count."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.helpers import inside

make_plan, parts = inside("physim.reproduction", "make_plan", "parts")
Claim, Measures, Outcome = inside("physim.reproduction", "Claim", "Measures", "Outcome")
FIGURE, Part, near, shown = inside("physim.reproduction", "FIGURE", "Part", "near", "shown")
Runs, Share, estimate = inside("physim.reproduction", "Runs", "Share", "estimate")
time_constant = inside("physim.reproduction", "time_constant")

AS_REPORTED: dict[str, float] = {
    "deviation_rms": 0.1, "finished": 1.0, "deviation_at_turns": 0.6, "deviation_elsewhere": 0.2,
    "rotation_left_least": 0.1, "rotation_right_largest": -0.1,
    "spread_start": 3.0, "spread_largest": 4.0, "error_in_bends": 1.0, "error_on_straights": 0.5,
    "formation_error_peak": 2.0, "formation_error_final": 0.05, "deviation_peak_least": 0.2,
    "deviation_peak_largest": 2.0, "deviation_left": 5.0, "deviation_right": 5.0,
    "rotation_agrees": 0.95, "averaged_speed_min": 0.8, "averaged_speed_max": 1.3,
    "behind_is_faster": 0.95, "ahead_is_slower": 0.99,
    "shortest_distance": 0.2875, "farthest_distance": 21.5, "collision_time_decided": 0.2,
    "contacts": 0.0, "contacts_early": 0.0, "start_right": 0.2, "start_top": 0.2,
    "start_headings": 250.0,
    "safe_share": 0.7, "safe_gap": 1.0, "safe_distance": 1.0, "width_min": 5.32, "width_max": 13.4,
    "abreast_min": 2.0, "abreast_max": 4.0,
    "safe_least_of_5_8_10": 0.9, "safe_least_of_others": 0.2, "safe_largest_of_others": 0.4,
    "others_in_danger": 7.0, "both_modes": 10.0,
    "messages": 1e5, "messages_share": 0.1, "evaluations": 1e5, "evaluations_share": 0.1,
    "shorter_intervals": 0.01, "time_to_finish": 250.0, "time_at_steady_speed": 250.0,
}  # fmt: skip
"""A run as the paper tells it."""

EVERY = [(part, claim) for part in parts() for claim in part.claims]
each = pytest.mark.parametrize(
    ("part", "claim"), EVERY, ids=[f"{p.figure}-{k}" for k, (p, _) in enumerate(EVERY)]
)


def as_reported(part: Part) -> Measures:
    return {**AS_REPORTED, "collision_time_pairs": 0.102 if part.figure == "3" else 0.06}


@each
def test_a_run_as_reported_meets_every_claim(part: Part, claim: Claim) -> None:
    run = as_reported(part)
    assert claim.graded(run) is Outcome.MET
    assert claim.outcome(run, [run] * 10) is Outcome.MET
    assert "none" not in shown(claim.measured, [run])


@each
def test_every_claim_can_fail(part: Part, claim: Claim) -> None:
    """Some figure that is shown decides: far too large, far too small, or without meaning."""
    run = as_reported(part)
    keys = [key for key, _ in FIGURE.findall(claim.measured)]
    far = [{**run, key: value} for key in keys for value in (1e9, -1e9, math.nan)]
    assert any(claim.graded(one) is not Outcome.MET for one in far)
    assert claim.graded({}) is Outcome.NOT_MET
    assert claim.graded(dict.fromkeys(run, math.nan)) is Outcome.NOT_MET


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("deviation_elsewhere", 0.31, "sharp turns only"),
        ("rotation_left_least", -0.01, "positive on left turns"),
        ("spread_largest", 6.1, "one group"),
        ("formation_error_final", 0.11, "converge to zero"),
        ("error_in_bends", 0.49, "grow in bends"),
        ("shortest_distance", 0.0, "always positive (Fig. 6c)"),
        ("collision_time_decided", 0.0, "Collision times are always positive (Fig. 6d)"),
        ("farthest_distance", 21.51, "21.5 m apart"),
        ("contacts", 1.0, "no collisions"),
        ("width_min", 5.36, "narrowest place (Fig. 4)"),
        ("width_max", 13.34, "widest place"),
        ("averaged_speed_max", 1.31, "0.8 and 1.3"),
        ("safe_least_of_5_8_10", 0.5, "than in danger mode"),
        ("others_in_danger", 0.0, "other robots"),
        ("safe_gap", 0.98, "parted into a safe area"),
    ],
)
def test_claims_fail_just_beyond_their_bounds(key: str, value: float, words: str) -> None:
    found = [(part, claim) for part, claim in EVERY if words in claim.words]
    assert found
    for part, claim in found:
        assert claim.graded({**as_reported(part), key: value}) is not Outcome.MET


def test_near_is_met_in_the_same_order_partly() -> None:
    claim = Claim("1", "c", "r", "{x:2 m}", *near("x", 0.1, same=0.05, order=3.0))
    values = (0.1, 0.1049, 0.106, 0.0951, 0.29, 0.034, 0.31, 0.033, math.nan)
    met, partly, not_met = Outcome.MET, Outcome.PARTLY, Outcome.NOT_MET
    expected = [met, met, partly, met, partly, partly, not_met, not_met, not_met]
    assert [claim.graded({"x": value}) for value in values] == expected


def test_seeds_take_a_verdict_down_and_up() -> None:
    claim = Claim("1", "c", "r", "{x:2}", lambda run: run["x"] > 0)
    good, bad = {"x": 1.0}, {"x": -1.0}
    assert claim.outcome(good, [good] * 9 + [bad]) is Outcome.MET
    assert claim.outcome(good, [good] * 8 + [bad] * 2) is Outcome.PARTLY
    assert claim.outcome(bad, [good] * 9 + [bad]) is Outcome.PARTLY
    assert claim.outcome(bad, [good] * 8 + [bad] * 2) is Outcome.NOT_MET
    assert claim.outcome(bad, []) is Outcome.NOT_MET
    always = Claim("1", "c", "r", "", lambda run: run["x"] > 0, needed=1.0)
    assert always.outcome(good, [good] * 99 + [bad]) is Outcome.PARTLY
    assert always.outcome(good, [good] * 100) is Outcome.MET
    half = Claim("1", "c", "r", "", lambda run: run["x"] > 1, lambda run: run["x"] > 0)
    assert half.outcome(good, [bad] * 3) is Outcome.PARTLY


def test_plan_of_one_figure() -> None:
    assert [part.figure for part in make_plan("3").parts] == ["3", "3a"]
    assert [part.figure for part in make_plan("3a").parts] == ["3a"]
    assert make_plan("Fig. 6").worlds == ("ten_robots",)
    assert not make_plan("6").studies
    assert (make_plan().seeds, make_plan(quick=True).seeds) == (100, 5)
    assert len(make_plan().parts) == len(parts())
    assert make_plan().studies


# medians with intervals by order statistics
@pytest.mark.parametrize(("count", "beyond"), [(1, 0), (5, 0), (6, 0), (9, 1), (100, 39)])
def test_ranks_are_those_of_the_sign_test(count: int, beyond: int) -> None:
    found = estimate([float(k) for k in range(count)])
    assert (found.low, found.high) == (beyond, count - 1 - beyond)


def test_interval_covers_the_median_nineteen_times_in_twenty() -> None:
    rng = np.random.default_rng(7)
    found = [estimate(rng.exponential(size=20)) for _ in range(2000)]
    covered = np.mean([one.low <= math.log(2.0) <= one.high for one in found])
    assert 0.945 <= covered <= 0.975  # 0.959 but for chance


def test_nan_is_left_out_and_nothing_is_none() -> None:
    assert estimate([math.nan, 2.0]).text(1, "m") == "2.0 m"
    assert estimate([math.nan]).text(1, "m") == "none"
    assert estimate([]).number == 0


def test_shares() -> None:
    assert Runs([{"contacts": 0.0}, {"contacts": 2.0}]).free == (1, 2)
    assert Share(20, 20).text == "20 of 20 [83 %, 100 %]"


def test_time_constant() -> None:
    time = np.linspace(0.0, 10.0, 50)
    assert time_constant(time, 3.0 * np.exp(-time / 4.0)) == pytest.approx(4.0)
    assert time_constant(time, np.exp(time / 4.0)) == pytest.approx(-4.0)
    assert math.isnan(time_constant(time[:4], np.ones(4)))
