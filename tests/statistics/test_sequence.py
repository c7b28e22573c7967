"""The confidence sequence holds at every look; the exact interval, looked at as often, does not."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

from tests.helpers import inside
from tests.statistics.coverage import LEAST, REPETITIONS, draws, share

clopper_pearson = inside("physim.statistics", "clopper_pearson")
at_each_look, log_evidence = inside("physim.statistics", "at_each_look", "log_evidence")
looks_needed, running = inside("physim.statistics", "looks_needed", "running")

LOOKS = 1000
RATES = [0.1, 0.5, 0.9, 0.99, 0.999]
Ends = tuple[NDArray[np.float64], NDArray[np.float64]]


@cache
def every_count(method: object) -> Ends:
    """Ends of the interval by (look - 1, successes), of a method of counts: all that can be."""
    looks, successes = np.tril_indices(LOOKS + 1)
    ends = method(successes[1:], looks[1:])  # type: ignore[operator]
    tables = []
    for end in ends:
        table = np.full((LOOKS + 1, LOOKS + 1), np.nan)
        table[looks[1:], successes[1:]] = end
        tables.append(table[1:])
    return tables[0], tables[1]


def sequence(successes: NDArray[np.int64], looks: NDArray[np.int64]) -> Ends:
    return at_each_look(successes, looks - successes)


def walks(rate: float) -> NDArray[np.int64]:
    """Successes after each look, a row a repetition."""
    outcomes = draws(int(1000 * rate)).random((REPETITIONS, LOOKS)) < rate
    return np.cumsum(outcomes, axis=1)


def held_at_every_look(method: object, rate: float) -> float:
    low, high = every_count(method)
    successes = walks(rate)
    look = np.arange(LOOKS)
    held = (low[look, successes] <= rate) & (rate <= high[look, successes])
    return share(held.all(axis=1))


@pytest.mark.parametrize("rate", RATES)
def test_it_holds_at_every_one_of_1000_looks(rate: float) -> None:
    assert held_at_every_look(sequence, rate) >= LEAST


@pytest.mark.parametrize(("rate", "most"), [(0.1, 0.75), (0.5, 0.75), (0.9, 0.75), (0.99, 0.87)])
def test_the_exact_interval_does_not(rate: float, most: float) -> None:
    assert held_at_every_look(clopper_pearson, rate) < most


@pytest.mark.parametrize("rate", [0.0, 1.0])
def test_it_holds_where_all_runs_end_alike(rate: float) -> None:
    assert held_at_every_look(sequence, rate) == 1.0


@pytest.mark.parametrize(("s", "f"), [(0, 0), (3, 1), (0, 9), (40, 2), (500, 500)])
def test_evidence_is_the_mixture_of_likelihoods(s: int, f: int) -> None:
    """By integration over rates p = sin^2 x, over which the prior is even."""

    def likelihood(x: float) -> float:
        scale = math.comb(s + f, s)
        return scale * math.sin(x) ** (2 * s) * math.cos(x) ** (2 * f) * 2 / math.pi

    mixed, _ = quad(likelihood, 0.0, math.pi / 2, epsabs=1e-13, limit=500)
    for rate in (0.2, 0.5, 0.93):
        alone = math.comb(s + f, s) * rate**s * (1 - rate) ** f
        if alone > 1e-200:
            expected = math.log(mixed / alone)
            assert float(log_evidence(s, f, rate)) == pytest.approx(expected, abs=1e-6)


def test_evidence_has_mean_1_under_the_rate_itself() -> None:
    """A martingale: its mean over what the next run may be is what it is now."""
    for s, f, rate in [(0, 0, 0.3), (4, 1, 0.9), (700, 3, 0.99)]:
        now = math.exp(float(log_evidence(s, f, rate)))
        after = [math.exp(float(log_evidence(s + 1, f, rate))),
                 math.exp(float(log_evidence(s, f + 1, rate)))]  # fmt: skip
        assert rate * after[0] + (1 - rate) * after[1] == pytest.approx(now, rel=1e-9)


@pytest.mark.parametrize(("s", "f"), [(1, 0), (0, 1), (3, 9), (990, 10), (99_999, 1)])
def test_ends_are_where_the_evidence_is_twenty(s: int, f: int) -> None:
    low, high = (float(end) for end in at_each_look(s, f))
    for end, edge in ((low, 0.0), (high, 1.0)):
        if end != edge:
            assert float(log_evidence(s, f, end)) == pytest.approx(math.log(20.0), abs=1e-6)
            assert float(log_evidence(s, f, end)) >= math.log(20.0) - 1e-9 * (s + f + 1)
    assert low <= s / (s + f) <= high


def test_nothing_is_known_before_the_first_run() -> None:
    assert tuple(map(float, at_each_look(0, 0))) == (0.0, 1.0)
    assert len(running([]).low) == 0


def test_the_running_intersection_is_the_intersection() -> None:
    for case in range(50):
        outcomes = draws(case).random(300) < 0.8
        looks = running(outcomes)
        for k in (0, 7, 299):
            good = np.cumsum(outcomes[: k + 1])
            low, high = at_each_look(good, np.arange(1, k + 2) - good)
            assert (looks.low[k], looks.high[k]) == (low.max(), high.min())
            assert looks.successes[k] == good[-1]
        assert np.all(np.diff(looks.low) >= 0.0)
        assert np.all(np.diff(looks.high) <= 0.0)


def test_an_empty_intersection_leaves_the_last_that_was_not() -> None:
    """A rate that changes on the way is none that a sequence speaks of."""
    looks = running([True] * 300 + [False] * 3000)
    assert np.all(looks.low <= looks.high)
    assert looks.low[-1] > 0.9


def test_the_price_of_looking_is_bounded() -> None:
    """Against the exact interval: less than twice as wide, at a rate and where nothing fails."""
    for s, n in [(900, 1000), (5000, 10_000), (3000, 3000)]:
        low, high = at_each_look(s, n - s)
        exact = clopper_pearson(s, n)
        assert 1.0 < float(high - low) / float(exact[1] - exact[0]) < 2.2


@pytest.mark.parametrize("rate", [0.5, 0.9, 0.999])
def test_looks_needed_are_enough_and_no_more(rate: float) -> None:
    runs = looks_needed(rate)
    assert float(at_each_look(runs, 0)[0]) >= rate > float(at_each_look(runs - 1, 0)[0])
