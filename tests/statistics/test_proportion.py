"""Exact intervals of rates: their definition, published values, and coverage."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest

from tests.helpers import inside
from tests.statistics.coverage import LEAST, REPETITIONS, draws, share

clopper_pearson = inside("physim.statistics", "clopper_pearson")
failure_bound, runs_needed = inside("physim.statistics", "failure_bound", "runs_needed")


def at_least(k: int, n: int, p: float) -> float:
    return sum(comb(n, i) * p**i * (1 - p) ** (n - i) for i in range(k, n + 1))


@pytest.mark.parametrize(("k", "n"), [(1, 3), (7, 10), (19, 20), (50, 100)])
def test_tails_hold_2_5_percent_each(k: int, n: int) -> None:
    low, high = clopper_pearson(k, n)
    assert at_least(k, n, low) == pytest.approx(0.025, abs=1e-9)
    assert 1 - at_least(k + 1, n, high) == pytest.approx(0.025, abs=1e-9)


def test_ends() -> None:
    assert clopper_pearson(0, 10) == (0.0, pytest.approx(1 - 0.025**0.1))
    assert clopper_pearson(10, 10) == (pytest.approx(0.025**0.1), 1.0)
    assert clopper_pearson(0, 0) == (0.0, 1.0)
    low, high = clopper_pearson(3, 10, confidence=0.99)
    assert at_least(3, 10, low) == pytest.approx(0.005, abs=1e-9)
    assert 1 - at_least(4, 10, high) == pytest.approx(0.005, abs=1e-9)


def test_arrays_are_the_single_values() -> None:
    s, n = np.arange(21), 20
    each = np.array([clopper_pearson(int(k), n) for k in s]).T
    assert np.array_equal(clopper_pearson(s, n), each)


@pytest.mark.parametrize(("k", "n"), [(-1, 3), (4, 3)])
def test_counts_that_cannot_be(k: int, n: int) -> None:
    with pytest.raises(ValueError, match="trials"):
        clopper_pearson(k, n)


@pytest.mark.parametrize("n", [1, 2, 7, 100, 10**6])
def test_at_the_bound_no_failure_is_seen_once_in_twenty(n: int) -> None:
    assert (1.0 - failure_bound(n)) ** n == pytest.approx(0.05)
    assert failure_bound(0) == 1.0


def test_the_rule_of_three() -> None:
    assert failure_bound(1000) == pytest.approx(3.0 / 1000, rel=0.01)
    assert runs_needed(0.999) == 2995
    assert runs_needed(0.99) == 299
    assert runs_needed(0.95) == 59


@pytest.mark.parametrize("rate", [0.5, 0.9, 0.99, 0.999, 0.99999])
def test_runs_needed_are_enough_and_no_more(rate: float) -> None:
    runs = runs_needed(rate)
    assert failure_bound(runs) <= 1.0 - rate < failure_bound(runs - 1)


@pytest.mark.parametrize("runs", [1, 10, 100, 1000])
@pytest.mark.parametrize("rate", [0.0, 0.01, 0.3, 0.5, 0.9, 0.99, 0.999, 1.0])
def test_coverage(rate: float, runs: int) -> None:
    good = draws(runs, int(1000 * rate)).binomial(runs, rate, REPETITIONS)
    low, high = clopper_pearson(good, runs)
    assert share((low <= rate) & (rate <= high)) >= LEAST


@pytest.mark.parametrize(("rate", "runs"), [(0.5, 1000), (0.9, 1000)])
def test_coverage_is_not_by_wide_intervals(rate: float, runs: int) -> None:
    """Where counts are many the exact interval is that of the normal distribution."""
    low, high = clopper_pearson(round(rate * runs), runs)
    normal = 2 * 1.96 * (rate * (1 - rate) / runs) ** 0.5
    assert normal < high - low < 1.06 * normal
