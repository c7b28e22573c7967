"""Verdicts on cases made up by hand: a step of 0.1 s, shapes that close at 1 m/s; speeds."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers import inside

NEVER, Verdict, classify = inside("physim.analysis.crashtest", "NEVER", "Verdict", "classify")
first_sample = inside("physim.analysis.crashtest", "first_sample")
FloatArray, Witness, arc = inside("physim.geometry", "FloatArray", "Witness", "arc")
closing_speed = inside("physim.analysis.crashtest", "closing_speed")

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


# Speeds of points of moving robots, against small moves along the exact arc

SHORT = 1e-5
"""[s] Central differences over it are good to 1e-9 m/s: omega^3 times the arm times its square."""


@pytest.mark.parametrize("case", range(50))
def test_the_speed_of_a_point_is_that_of_its_arc(case: int) -> None:
    rng = np.random.default_rng([90, case])
    pose = np.array([*rng.uniform(-5.0, 5.0, 2), rng.uniform(-3.0, 3.0)])
    twist = rng.uniform(-2.0, 2.0, 3)
    arm = rng.uniform(-1.0, 1.0, 2)
    angle = rng.uniform(-3.0, 3.0)
    normal = np.array([np.cos(angle), np.sin(angle)])

    def place(t: float) -> np.ndarray:
        x, y, heading = arc(*pose, *twist, t)
        c, s = np.cos(heading), np.sin(heading)
        return np.array([x + c * arm[0] - s * arm[1], y + s * arm[0] + c * arm[1]])

    velocity = (place(SHORT) - place(-SHORT)) / (2.0 * SHORT)
    witness = Witness(0.0, *normal, 0.0, 0.0, 0.0, 0.0)
    found = closing_speed(pose, twist, *place(0.0), witness)
    assert found == pytest.approx(float(velocity @ normal), abs=1e-8)
