"""Medians with intervals by order statistics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.helpers import inside

count, estimate, share_text = inside("physim.reproduction", "count", "estimate", "share_text")
time_constant = inside("physim.reproduction", "time_constant")


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
    assert estimate([]).count == 0


def test_shares() -> None:
    assert count([{"a": 0.0}, {"a": 2.0}], "a", lambda value: value == 0.0) == (1, 2)
    assert share_text(20, 20) == "20 of 20 [83 %, 100 %]"


def test_time_constant() -> None:
    time = np.linspace(0.0, 10.0, 50)
    assert time_constant(time, 3.0 * np.exp(-time / 4.0)) == pytest.approx(4.0)
    assert time_constant(time, np.exp(time / 4.0)) == pytest.approx(-4.0)
    assert math.isnan(time_constant(time[:4], np.ones(4)))
