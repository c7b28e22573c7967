"""Verdicts on cases made up by hand: a step of 0.1 s, shapes that close at 1 m/s."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers import inside

NEVER, Verdict, classify = inside("physim.analysis.crashtest", "NEVER", "Verdict", "classify")
first_sample = inside("physim.analysis.crashtest", "first_sample")
FloatArray = inside("physim.geometry", "FloatArray")

STEP = 0.1
INF, NAN = float("inf"), float("nan")


def approach(contact: float, samples: int = 11) -> FloatArray:
    """Distances at the samples of shapes that touch at a time."""
    return contact - STEP * np.arange(samples)


APART = np.full(11, 0.5)


@pytest.mark.parametrize(
    ("physical", "xi", "distance", "verdict"),
    [
        (5, 0.45, approach(0.45), Verdict.SAME_SAMPLE),
        (5, 0.5, approach(0.5), Verdict.SAME_SAMPLE),
        (0, 0.0, approach(-0.01), Verdict.SAME_SAMPLE),
        (NEVER, INF, APART, Verdict.NO_CONTACT),
        (NEVER, 0.45, APART, Verdict.GRAZE),  # touches between samples 4 and 5 only
        (8, 0.45, np.where(np.arange(11) < 8, 0.5, -0.1), Verdict.GRAZE),
        (6, 0.45, approach(0.45), Verdict.UNEXPLAINED),  # the engine is late
        (4, 0.45, approach(0.45), Verdict.UNEXPLAINED),  # early
        (NEVER, 0.45, approach(0.45), Verdict.UNEXPLAINED),  # misses it
        (3, INF, APART, Verdict.UNEXPLAINED),  # a false contact
        (5, 0.65, approach(0.45), Verdict.UNEXPLAINED),  # xi is late
        (5, INF, approach(0.45), Verdict.UNEXPLAINED),  # xi misses it
    ],
)
def test_verdicts(physical: int, xi: float, distance: FloatArray, verdict: Verdict) -> None:
    gap = 0.0 if xi < INF else NAN
    found, reason = classify(STEP, physical, xi, gap, distance)
    assert found == verdict
    assert bool(reason) == (verdict == Verdict.UNEXPLAINED)


def test_a_collision_time_at_which_nothing_touches_is_false() -> None:
    assert classify(STEP, 5, 0.45, 1e-9, approach(0.45))[0] == Verdict.SAME_SAMPLE
    found, reason = classify(STEP, 5, 0.43, 0.02, approach(0.45))
    assert found == Verdict.UNEXPLAINED
    assert "0.02 m apart" in reason


@pytest.mark.parametrize(
    ("there", "physical", "verdict"),
    [
        (1e-9 + 2e-11, 5, Verdict.TOLERANCE),
        (1e-9 - 2e-11, 6, Verdict.TOLERANCE),
        (1e-9 + 2e-10, 5, Verdict.UNEXPLAINED),
        (1e-9 - 2e-10, 6, Verdict.UNEXPLAINED),
    ],
)
def test_rounding_excuses_a_sample_only_about_the_contact_tolerance(
    there: float, physical: int, verdict: Verdict
) -> None:
    distance = approach(0.55)
    distance[5] = there
    assert classify(STEP, physical, 0.55, 0.0, distance)[0] == verdict


@pytest.mark.parametrize(
    ("least", "verdict"),
    [(0.9e-9, Verdict.TOLERANCE), (-0.9e-9, Verdict.TOLERANCE), (-2e-9, Verdict.UNEXPLAINED)],
)
def test_a_graze_within_the_tolerance_may_count_either_way(least: float, verdict: Verdict) -> None:
    distance = APART.copy()
    distance[5] = least
    assert classify(STEP, 5, INF, NAN, distance)[0] == verdict


def test_the_first_sample_counts_what_is_within_the_tolerance() -> None:
    assert first_sample(np.array([0.1, 2e-9, 1e-9, -1.0])) == 2
    assert first_sample(APART) == NEVER
