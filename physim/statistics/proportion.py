"""Rates from a number of runs fixed beforehand: exact intervals, and how many runs it takes.

All of these hold for one look at a fixed number of runs only. Where the number of runs depends on
their outcomes, `physim.statistics.sequence` holds and these do not.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
CONFIDENCE = 0.95
"""Probability with which the intervals of all reports hold the true value, at least."""


def clopper_pearson(
    successes: int, trials: int, confidence: float = CONFIDENCE
) -> tuple[float, float]:
    """Exact two-sided interval of a proportion (Clopper and Pearson, Biometrika 26, 1934).

    Errs to the wide side: it covers the true rate with at least ``confidence``, and each of its
    ends is beyond it with at most half of the rest. Without trials it is 0 to 1. Raises ValueError
    unless 0 <= successes <= trials.
    """
    low, high = clopper_pearson_each(successes, trials, confidence)
    return float(low), float(high)


def clopper_pearson_each(
    successes: ArrayLike, trials: ArrayLike, confidence: float = CONFIDENCE
) -> tuple[FloatArray, FloatArray]:
    """`clopper_pearson` of arrays of counts that can be broadcast: both ends, each an array."""
    from scipy.special import betaincinv

    s, n = np.broadcast_arrays(np.asarray(successes, float), np.asarray(trials, float))
    if np.any((s < 0) | (s > n)):
        raise ValueError("successes must be from 0 to the number of trials")
    tail = (1.0 - confidence) / 2.0
    low, high = np.zeros(s.shape), np.ones(s.shape)
    some, not_all = s > 0, s < n
    low[some] = betaincinv(s[some], n[some] - s[some] + 1.0, tail)
    high[not_all] = betaincinv(s[not_all] + 1.0, n[not_all] - s[not_all], 1.0 - tail)
    return low, high


def failure_bound(trials: int, confidence: float = CONFIDENCE) -> float:
    """Upper bound of the rate of failures after ``trials`` runs without a failure; one-sided.

    The exact form of the rule of three: the rate p at which all runs succeed with probability
    ``1 - confidence``, (1 - p)^trials. Errs to the high side; 1 without trials.
    """
    return 1.0 - (1.0 - confidence) ** (1.0 / trials) if trials > 0 else 1.0


def runs_needed(rate: float, confidence: float = CONFIDENCE) -> int:
    """Return how many runs, none of which fails, show that the rate is at least ``rate``.

    The fewest with ``failure_bound(runs) <= 1 - rate``: 2995 for 99.9 %. Raises ValueError unless
    0 < rate < 1.
    """
    if not 0.0 < rate < 1.0:
        raise ValueError("rate must be between 0 and 1")
    return math.ceil(math.log(1.0 - confidence) / math.log(rate))
