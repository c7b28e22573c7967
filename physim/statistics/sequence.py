"""A confidence sequence of a rate: intervals that hold at every look, all of them at once.

A campaign that stops when its interval suits it looks after every run. The exact interval for a
fixed number of runs then misses the true rate far more often than it says; this one does not.

For outcomes of a fixed rate p, s successes and f failures so far, and a prior Beta(a, b), the ratio

    M(p) = B(a + s, b + f) / B(a, b) / (p^s (1 - p)^f)

of the mixture's likelihood to that of p is a martingale with mean 1 that is never negative. By
Ville's inequality it reaches 1 / alpha at any time with a probability of at most alpha. So the
rates with M(p) < 1 / alpha hold p at all looks at once with at least 1 - alpha (Robbins, Annals
of Mathematical Statistics 41, 1970; Howard, Ramdas, McAuliffe and Sekhon, Annals of Statistics
49, 2021). They are an interval, as p^s (1 - p)^f has one maximum.

The running intersection of these intervals holds p whenever all of them do, so it has the same
probability and never grows wider; it is what is used here. It may become empty, in the share
alpha of cases in which some interval misses p; then the last one that was not empty stays.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.statistics.proportion import CONFIDENCE

FloatArray = NDArray[np.float64]
PRIOR = (0.5, 0.5)
"""a and b of the mixture, of Jeffreys: narrow near 0 and 1, where the rates of interest are. The
prior has a say in the width alone, not in whether the sequence holds."""
HALVINGS = 52
"""of an interval at most 1 wide: down to the distance of neighbouring numbers at 1"""


def log_evidence(
    successes: ArrayLike, failures: ArrayLike, rate: ArrayLike, prior: tuple[float, float] = PRIOR
) -> FloatArray:
    """Logarithm of M(rate), the evidence against a rate from 0 to 1; arrays are broadcast."""
    s, f, p = (np.asarray(each, float) for each in (successes, failures, rate))
    return _mixture(s, f, prior) - _likelihood(s, f, p)


def _mixture(s: FloatArray, f: FloatArray, prior: tuple[float, float]) -> FloatArray:
    """Logarithm of the likelihood under the prior."""
    from scipy.special import betaln

    a, b = prior
    return np.asarray(betaln(a + s, b + f) - betaln(a, b))


def _likelihood(s: FloatArray, f: FloatArray, p: FloatArray) -> FloatArray:
    """Logarithm of the likelihood of a rate; that of a success at rate 0 is -inf."""
    from scipy.special import xlog1py, xlogy

    return np.asarray(xlogy(s, p) + xlog1py(f, -p))


def at_each_look(
    successes: ArrayLike, failures: ArrayLike, confidence: float = CONFIDENCE
) -> tuple[FloatArray, FloatArray]:
    """Both ends of the interval after given counts, arrays that can be broadcast.

    Without the intersection with earlier ones. Errs to the wide side, by less than 1e-15 for the
    arithmetic: of the last halving the outer end is taken.
    """
    s, f = np.broadcast_arrays(np.asarray(successes, float), np.asarray(failures, float))
    least = _mixture(s, f, PRIOR) + math.log(1.0 - confidence)
    best = np.divide(s, s + f, out=np.full(s.shape, 0.5), where=s + f > 0)
    ends = []
    for edge in (0.0, 1.0):
        outer, inner = np.full(s.shape, edge), best.copy()
        for _ in range(HALVINGS):
            middle = 0.5 * (outer + inner)
            inside = _likelihood(s, f, middle) > least
            inner, outer = np.where(inside, middle, inner), np.where(inside, outer, middle)
        reached = _likelihood(s, f, np.full(s.shape, edge)) > least
        ends.append(np.where(reached, edge, outer))
    return ends[0], ends[1]


@dataclass(frozen=True)
class Looks:
    """The running intersection after each of a number of outcomes, both ends (K,)."""

    low: FloatArray
    high: FloatArray
    successes: NDArray[np.int64]


def running(outcomes: ArrayLike, confidence: float = CONFIDENCE) -> Looks:
    """Confidence sequence of outcomes (K,), true or false, in the order in which they count.

    The k-th interval rests on the first k + 1 outcomes alone. All hold at once with at least
    ``confidence`` if the outcomes are independent and of one rate. Errs to the wide side.
    """
    good = np.asarray(outcomes, bool)
    successes = np.cumsum(good, dtype=np.int64)
    failures = np.arange(1, len(good) + 1) - successes
    low, high = at_each_look(successes, failures, confidence)
    low, high = np.maximum.accumulate(low), np.minimum.accumulate(high)
    if empty := int(np.count_nonzero(low > high)):
        last = len(good) - empty - 1  # once empty, always empty
        low[last + 1 :], high[last + 1 :] = low[last], high[last]
    return Looks(low, high, successes)


@functools.lru_cache(maxsize=8)
def looks_needed(rate: float, confidence: float = CONFIDENCE) -> int:
    """Return how many runs, none of which fails, show at any look a rate of at least ``rate``.

    The fewest after which the lower end is at least ``rate``: 8062 for 99.9 %, against 2995 of a
    number fixed beforehand. Raises ValueError unless 0 < rate < 1.
    """
    if not 0.0 < rate < 1.0:
        raise ValueError("rate must be between 0 and 1")
    few, enough = 0, 1
    while float(at_each_look(enough, 0, confidence)[0]) < rate:
        few, enough = enough, 2 * enough
    while enough - few > 1:
        middle = (few + enough) // 2
        if float(at_each_look(middle, 0, confidence)[0]) < rate:
            few = middle
        else:
            enough = middle
    return enough
