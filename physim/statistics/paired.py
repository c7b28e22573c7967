"""Two arms on the same seeds: is one better than the other, and by how much?

What both arms share, the difficulty of a seed, cancels in the differences of its two runs. All
here are exact: they assume that seeds are independent of one another, and nothing about how a
measure is distributed (`wilcoxon` alone assumes that its differences are symmetric).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.statistics.proportion import CONFIDENCE, clopper_pearson_each

FloatArray = NDArray[np.float64]
SHARE_OF_SIDE = 0.8
"""of the allowed error of `rate_difference` that goes to which arm is better, the rest to how often
they differ: the sign of a difference matters more than its size"""


class Interval(NamedTuple):
    """A value and the interval around it."""

    value: float
    low: float
    high: float


def mcnemar(only_a: int, only_b: int) -> float:
    """P value of McNemar's test, exact and two-sided (McNemar, Psychometrika 12, 1947).

    ``only_a`` seeds succeed with A alone, ``only_b`` with B alone; if none is better each of these
    is A's or B's with equal probability. Errs to the high side: without a difference it rejects at
    p <= alpha in at most the share alpha of cases. 1 where the arms never differ.
    """
    from scipy.special import bdtr

    differing = only_a + only_b
    return float(min(1.0, 2.0 * bdtr(min(only_a, only_b), differing, 0.5))) if differing else 1.0


def rate_difference(
    only_a: int, only_b: int, pairs: int, confidence: float = CONFIDENCE
) -> Interval:
    """Rate of A minus rate of B on the same seeds, with a conservative interval.

    See `rate_differences`. Raises ValueError unless ``only_a + only_b <= pairs``.
    """
    low, high = rate_differences(only_a, only_b, pairs, confidence)
    value = (only_a - only_b) / pairs if pairs else math.nan
    return Interval(value, float(low), float(high))


def rate_differences(
    only_a: ArrayLike, only_b: ArrayLike, pairs: ArrayLike, confidence: float = CONFIDENCE
) -> tuple[FloatArray, FloatArray]:
    """Both ends of the interval of a paired difference of rates; arrays are broadcast.

    The difference is d (2 t - 1): d the share of seeds on which the arms differ, t the share of
    these on which A is the better one. Given how many differ, those of A are binomial, so both have
    an exact interval (Clopper and Pearson 1934); their errors add up to ``1 - confidence``
    (Bonferroni), `SHARE_OF_SIDE` of it for t, and the interval is all that d and t allow. Errs to
    the wide side: it covers the true difference with at least ``confidence`` for any rates and
    number of pairs.
    """
    a, b, n = np.broadcast_arrays(*(np.asarray(each, float) for each in (only_a, only_b, pairs)))
    error = 1.0 - confidence
    side = clopper_pearson_each(a, a + b, 1.0 - SHARE_OF_SIDE * error)
    often = clopper_pearson_each(a + b, n, 1.0 - (1.0 - SHARE_OF_SIDE) * error)
    low, high = (2.0 * end - 1.0 for end in side)
    return (
        np.minimum(low * often[0], low * often[1]),
        np.maximum(high * often[0], high * often[1]),
    )


def sign_test(differences: ArrayLike) -> float:
    """P value of the two-sided sign test: is the median of the differences 0? Exact.

    Differences of 0 say nothing and are left out. Errs to the high side. 1 without any other; nan
    where a difference is.
    """
    d = np.asarray(differences, float)
    if np.isnan(d).any():
        return math.nan
    return mcnemar(int(np.count_nonzero(d > 0)), int(np.count_nonzero(d < 0)))


def rank_beyond(count: int, confidence: float = CONFIDENCE) -> int:
    """Return how many of ``count`` sorted values lie beyond either end of the median's interval.

    The most, k, for which fewer than k + 1 of them are below the median with a probability of at
    most half of ``1 - confidence``; -1 where even the smallest and largest are not sure enough.
    """
    from scipy.special import bdtr

    tail = (1.0 - confidence) / 2.0
    below = bdtr(np.arange(0, count // 2 + 1), count, 0.5)
    return int(np.searchsorted(below, tail, side="right")) - 1


def median_difference(differences: ArrayLike, confidence: float = CONFIDENCE) -> Interval:
    """Median of paired differences (n,), with an interval between two of them; exact.

    The order statistics with which the sign test would not reject (Thompson, Annals of Mathematical
    Statistics 7, 1936). Errs to the wide side, for any distribution, ties included. It is the
    median of the differences, not the difference of the medians. With too few for any such interval
    (five or less for 95 %) it is infinite. Without any, or where one is nan, the median is nan and
    the interval infinite.
    """
    d = np.sort(np.asarray(differences, float))
    if not len(d) or np.isnan(d[-1]):
        return Interval(math.nan, -math.inf, math.inf)
    beyond = rank_beyond(len(d), confidence)
    value = float(np.median(d))
    if beyond < 0:
        return Interval(value, -math.inf, math.inf)
    return Interval(value, float(d[beyond]), float(d[-1 - beyond]))


def holm(p_values: Sequence[float]) -> list[float]:
    """P values corrected for how many there are (Holm, Scandinavian Journal of Statistics 6, 1979).

    Of all true null hypotheses, any is rejected at ``p <= alpha`` with a probability of at most
    alpha, however the tests depend on one another. Errs to the high side.
    """
    order = np.argsort(p_values, kind="stable")
    sizes = len(order) - np.arange(len(order))
    corrected = np.minimum(1.0, np.maximum.accumulate(np.asarray(p_values, float)[order] * sizes))
    back = np.empty(len(order))
    back[order] = corrected
    return [float(p) for p in back]
