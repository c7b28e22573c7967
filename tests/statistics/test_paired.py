"""Paired comparisons: against their definitions, by enumeration, and for coverage."""

from __future__ import annotations

from collections.abc import Callable
from math import comb, inf, isnan, nan

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.helpers import inside
from tests.statistics.coverage import LEAST, MONTE_CARLO, REPETITIONS, draws, share

holm, sign_test = inside("physim.statistics", "holm", "sign_test")
median_difference, rank_beyond = inside("physim.statistics", "median_difference", "rank_beyond")
rate_difference = inside("physim.statistics", "rate_difference")


@pytest.mark.parametrize(("a", "b"), [(0, 0), (1, 0), (5, 0), (3, 9), (10, 10), (2, 40)])
def test_the_sign_test_is_the_share_of_tosses_as_uneven(a: int, b: int) -> None:
    n = a + b
    uneven = sum(comb(n, k) for k in range(n + 1) if abs(2 * k - n) >= abs(a - b))
    assert sign_test(a, b) == pytest.approx(uneven / 2**n)
    assert sign_test(b, a) == sign_test(a, b)


@pytest.mark.parametrize("pairs", [10, 100, 1000])
@pytest.mark.parametrize("differing", [0.0, 0.02, 0.3])
def test_it_finds_no_difference_that_is_not_there(pairs: int, differing: float) -> None:
    rng = draws(1, pairs, int(100 * differing))
    m = rng.binomial(pairs, differing, REPETITIONS)
    a = rng.binomial(m, 0.5)
    rejected = np.array([sign_test(int(x), int(n - x)) <= 0.05 for x, n in zip(a, m, strict=True)])
    assert share(~rejected) >= LEAST


@pytest.mark.parametrize("pairs", [5, 30, 300, 3000])
@pytest.mark.parametrize(
    "rates",
    [(0.0, 0.0), (0.01, 0.0), (0.2, 0.0), (0.02, 0.02), (0.3, 0.25), (0.05, 0.6), (0.5, 0.5)],
)
def test_coverage_of_differences_of_rates(rates: tuple[float, float], pairs: int) -> None:
    a, b = rates
    rng = draws(2, pairs, int(1000 * a), int(1000 * b))
    counts = rng.multinomial(pairs, [a, b, max(0.0, 1 - a - b)], REPETITIONS)
    low, high = rate_difference(counts[:, 0], counts[:, 1], pairs)
    assert share((low <= a - b) & (a - b <= high)) >= LEAST


def test_a_difference_of_rates_is_not_kept_by_width_alone() -> None:
    """Beside the interval of Wald, which is too narrow: at most 1.6 times as wide."""
    for a, b, n in [(20, 20, 400), (40, 0, 400), (100, 60, 1000), (500, 300, 1000)]:
        value, (low, high) = (a - b) / n, rate_difference(a, b, n)
        assert low <= value <= high
        wald = 2 * 1.96 * (((a + b) / n - value**2) / n) ** 0.5
        assert wald < high - low < 1.6 * wald


def test_ends_of_differences_of_rates() -> None:
    assert rate_difference(0, 0, 0) == (-1.0, 1.0)
    low, high = rate_difference(0, 0, 1000)
    assert -0.006 < low == -high < 0.0
    low, high = map(float, rate_difference(3, 17, 60))
    assert rate_difference(17, 3, 60) == (pytest.approx(-high), pytest.approx(-low))
    with pytest.raises(ValueError, match="trials"):
        rate_difference(3, 3, 5)


@pytest.mark.parametrize("seed", range(4))
def test_sign_test_and_interval_of_the_median_agree(seed: int) -> None:
    d = draws(3, seed).normal(0.3, 1.0, 40)
    for shift in np.linspace(-1.0, 1.5, 101):
        _, low, high = median_difference(d - shift)
        above = int(np.count_nonzero(d > shift))
        assert (sign_test(above, 40 - above) > 0.05) == (low <= 0.0 <= high)


def test_ranks_of_the_interval_of_the_median() -> None:
    """The tables of the sign test: Conover (1999), and by hand."""
    assert [rank_beyond(n) for n in (0, 5, 6, 8, 9, 20, 25, 100)] == [-1, -1, 0, 0, 1, 5, 7, 39]
    assert median_difference([1.0, 2.0, 4.0]) == (2.0, -inf, inf)
    assert isnan(median_difference([])[0])
    assert median_difference(range(20)) == (9.5, 5.0, 14.0)


Draw = Callable[[np.random.Generator, tuple[int, int]], NDArray[np.float64]]
DISTRIBUTIONS: dict[str, tuple[Draw, float]] = {
    "normal": (lambda rng, n: rng.normal(1.0, 2.0, n), 1.0),
    "skewed": (lambda rng, n: rng.exponential(1.0, n), float(np.log(2.0))),
    "heavy": (lambda rng, n: rng.standard_cauchy(n), 0.0),
    "ties": (lambda rng, n: rng.integers(-2, 3, n).astype(float), 0.0),
    "mostly 0": (lambda rng, n: rng.normal(0.5, 1.0, n) * (rng.random(n) < 0.3), 0.0),
}  # fmt: skip


@pytest.mark.parametrize("count", [3, 6, 20, 101])
@pytest.mark.parametrize("name", DISTRIBUTIONS)
def test_coverage_of_median_differences(name: str, count: int) -> None:
    draw, true = DISTRIBUTIONS[name]
    d = np.sort(draw(draws(5, count), (REPETITIONS, count)), axis=1)
    beyond = rank_beyond(count)
    assert median_difference(d[0])[1:] == ((d[0, beyond], d[0, -1 - beyond]) if beyond >= 0
                                           else (-inf, inf))  # fmt: skip
    if beyond >= 0:
        assert share((d[:, beyond] <= true) & (true <= d[:, -1 - beyond])) >= LEAST


@pytest.mark.parametrize("count", [8, 60])
def test_the_tests_reject_what_is_true_once_in_twenty_at_most(count: int) -> None:
    d = draws(6, count).normal(0.0, 1.0, (REPETITIONS, count))
    positive = np.count_nonzero(d > 0, axis=1)
    p_of = np.array([sign_test(k, count - k) for k in range(count + 1)])
    assert share(p_of[positive] > 0.05) >= LEAST


def test_holm_by_hand() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == [1.0, 1.0]
    assert holm([0.02]) == [0.02]
    assert holm([]) == []
    assert holm([0.03, 0.01, 0.03]) == pytest.approx([0.06, 0.03, 0.06])


def test_holm_keeps_the_error_of_all_together() -> None:
    """Twenty measures of which none differs; without the correction six in ten have a finding."""
    p = draws(7).random((REPETITIONS, 20))
    found = np.array([min(holm(list(row))) <= 0.05 for row in p])
    assert share(~found) >= LEAST
    assert np.mean(p.min(axis=1) <= 0.05) > 0.6 - MONTE_CARLO


def test_a_difference_that_is_not_known_leaves_nothing_known() -> None:
    for d in ([1.0, nan, 2.0], [nan], [nan] * 60, [*range(60), nan]):
        middle, *ends = median_difference(d)
        assert isnan(middle)
        assert ends == [-inf, inf]
