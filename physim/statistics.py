"""How sure a figure from a number of runs is: intervals, tests, and goals that stop a campaign.

Rates of a number of runs fixed beforehand have exact intervals (`clopper_pearson`). A campaign that
stops when its interval suits it looks after every run; these then miss the true rate far more often
than they say. A confidence sequence does not (`running`). For outcomes of a fixed rate p, s
successes and f failures so far, and a prior Beta(a, b), the ratio

    M(p) = B(a + s, b + f) / B(a, b) / (p^s (1 - p)^f)

of the mixture's likelihood to that of p is a martingale with mean 1 that is never negative. By
Ville's inequality it reaches 1 / alpha at any time with a probability of at most alpha. So the
rates with M(p) < 1 / alpha hold p at all looks at once with at least 1 - alpha (Robbins, Annals
of Mathematical Statistics 41, 1970; Howard, Ramdas, McAuliffe and Sekhon, Annals of Statistics
49, 2021). They are an interval, as p^s (1 - p)^f has one maximum. The running intersection of these
intervals holds p whenever all of them do; it may become empty, in the share alpha of cases in which
some interval misses p; then the last one that was not empty stays.

Two arms on the same seeds: what both share, the difficulty of a seed, cancels in the differences of
its two runs. The tests are exact: they assume that seeds are independent of one another, and
nothing about how a measure is distributed.
"""

from __future__ import annotations

import bisect
import functools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.randomness import stream

FloatArray = NDArray[np.float64]
CONFIDENCE = 0.95
"""Probability with which the intervals of all reports hold the true value, at least."""
PRIOR = (0.5, 0.5)
"""a and b of the mixture, of Jeffreys: narrow near 0 and 1, where the rates of interest are. The
prior has a say in the width alone, not in whether the sequence holds."""
HALVINGS = 52
"""of an interval at most 1 wide: down to the distance of neighbouring numbers at 1"""
SHARE_OF_SIDE = 0.8
"""of the allowed error of `rate_difference` that goes to which arm is better, the rest to how often
they differ: the sign of a difference matters more than its size"""
RATES = ("rate", "contact_free", "finished")
"""Of runs that are contact-free and finished; contact-free; finished"""
GOAL = re.compile(rf"\s*(?:({'|'.join(RATES)})\s*([<>])\s*)?(\d*\.?\d+)(\s*%)?\s*")


# Rates of a fixed number of runs


def clopper_pearson(
    successes: ArrayLike, trials: ArrayLike, confidence: float = CONFIDENCE
) -> tuple[FloatArray, FloatArray]:
    """Both ends of the exact two-sided interval of a proportion; arrays are broadcast.

    Clopper and Pearson, Biometrika 26, 1934. Errs to the wide side: it covers the true rate with at
    least ``confidence``, and each of its ends is beyond it with at most half of the rest. Without
    trials it is 0 to 1. Raises ValueError unless 0 <= successes <= trials.
    """
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

    The fewest with ``failure_bound(runs) <= 1 - rate``, which is above 0: 2995 for 99.9 %.
    """
    return math.ceil(math.log(1.0 - confidence) / math.log(rate))


# Rates looked at after every run


def log_evidence(successes: ArrayLike, failures: ArrayLike, rate: ArrayLike) -> FloatArray:
    """Logarithm of M(rate), the evidence against a rate from 0 to 1; arrays are broadcast."""
    s, f, p = (np.asarray(each, float) for each in (successes, failures, rate))
    return _mixture(s, f) - _likelihood(s, f, p)


def _mixture(s: FloatArray, f: FloatArray) -> FloatArray:
    """Logarithm of the likelihood under the prior."""
    from scipy.special import betaln

    return np.asarray(betaln(PRIOR[0] + s, PRIOR[1] + f) - betaln(*PRIOR))


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
    best = np.divide(s, s + f, out=np.full(s.shape, 0.5), where=s + f > 0)
    least = _mixture(s, f) + math.log(1.0 - confidence)
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

    The fewest after which the lower end is at least ``rate``, from 0 to below 1: 8062 for 99.9 %,
    against 2995 of a number fixed beforehand.
    """
    return bisect.bisect_left(
        range(2**62), rate, lo=1, key=lambda runs: float(at_each_look(runs, 0, confidence)[0])
    )


# Goals


@dataclass(frozen=True)
class Goal:
    """What is to be known of a rate."""

    rate: str
    """one of `RATES`"""
    sign: str
    """``<`` or ``>``; empty where the goal is a width"""
    number: float
    """the bound that the rate is held against, or the width"""

    def __str__(self) -> str:
        """Write it as `read_goal` reads it; that gives the same goal."""
        return f"{self.rate} {self.sign} {self.number!r}" if self.sign else f"{self.number!r}"

    def reached(self, low: ArrayLike, high: ArrayLike) -> np.ndarray:
        """Whether intervals decide: narrow enough, or wholly on one side of the number."""
        low, high = np.asarray(low), np.asarray(high)
        if not self.sign:
            return np.asarray(high - low <= self.number)
        return np.asarray((low > self.number) | (high < self.number))


def read_goal(text: str) -> Goal:
    """Read a goal: ``0.02`` or ``2%``, the most that the interval of ``rate`` may span; or RATE <
    or > NUMBER, as ``rate > 0.99``.

    Raises ValueError with what was given and what is allowed.
    """
    if found := GOAL.fullmatch(text):
        rate, sign, digits, percent = found.groups()
        number = float(digits) / (100.0 if percent else 1.0)
        if 0.0 <= number <= 1.0 if sign else 0.0 < number < 1.0:
            return Goal(rate or "rate", sign or "", number)
    raise ValueError(
        "a width above 0 and below 1, such as 0.02 or 2%, or a bound from 0 to 1 on one of "
        f'{", ".join(RATES)}, such as "rate > 0.99"; '
        f'given: "{text[:40]}"'
    )


@dataclass(frozen=True)
class Decision:
    """What a number of outcomes says of a goal."""

    runs: int
    """of the first outcomes that decide, or of all where nothing is decided"""
    successes: int
    low: float
    high: float
    decided: bool
    holds: bool | None
    """whether the rate is as the goal says; None where that is open, and for a width"""


def decide(goal: Goal, outcomes: ArrayLike, confidence: float = CONFIDENCE) -> Decision:
    """Hold outcomes (K,) of the goal's rate, in the order of seeds, against a goal.

    The first outcomes that decide do so; what comes after them, because several runs were made at
    a time, has no say. So the decision depends on the outcomes and their order alone. It is wrong
    with a probability of at most ``1 - confidence``, however often it was looked at.
    """
    good = np.asarray(outcomes, bool)
    if not len(good):
        return Decision(0, 0, 0.0, 1.0, False, None)
    looks = running(good, confidence)
    enough = goal.reached(looks.low, looks.high)
    at = int(np.argmax(enough)) if enough.any() else len(good) - 1
    low, high, decided = float(looks.low[at]), float(looks.high[at]), bool(enough[at])
    holds = (low > goal.number) == (goal.sign == ">") if goal.sign and decided else None
    successes = int(looks.successes[at])
    if goal.sign:  # ends of earlier looks may leave the share of now out
        low, high = min(low, successes / (at + 1)), max(high, successes / (at + 1))
    return Decision(at + 1, successes, low, high, decided, holds)


class Watch:
    """Outcomes held against a goal one by one, as they come; it says what `decide` says of all."""

    def __init__(self, goal: Goal, confidence: float = CONFIDENCE) -> None:
        self.goal, self.confidence = goal, confidence
        self.outcomes: list[bool] = []
        """those that have a say"""
        self.successes = 0
        self.is_empty = False
        """whether the intervals have nothing in common any more; the last one that had stays"""
        self.low, self.high = 0.0, 1.0
        self.decided = False

    def add(self, good: bool) -> bool:
        """Whether it is decided with one more outcome; what comes after that has no say."""
        if self.decided:
            return True
        self.outcomes.append(good)
        self.successes += good
        failures = len(self.outcomes) - self.successes
        low, high = map(float, at_each_look(self.successes, failures, self.confidence))
        low, high = max(self.low, low), min(self.high, high)
        self.is_empty |= low > high
        if not self.is_empty:
            self.low, self.high = low, high
        self.decided = bool(self.goal.reached(self.low, self.high))
        return self.decided

    @property
    def decision(self) -> Decision:
        """What the outcomes so far say."""
        return decide(self.goal, self.outcomes, self.confidence)


# Two arms on the same seeds


def sign_test(only_a: int, only_b: int) -> float:
    """P value of the sign test, exact and two-sided: of rates, McNemar's (Psychometrika 12, 1947).

    A is the better one with ``only_a`` seeds, B with ``only_b``; ties say nothing. If none is
    better each of these is A's or B's with equal probability. Errs to the high side: without a
    difference it rejects at p <= alpha in at most the share alpha of cases. 1 where the arms never
    differ.
    """
    from scipy.special import bdtr

    differing = only_a + only_b
    return float(min(1.0, 2.0 * bdtr(min(only_a, only_b), differing, 0.5))) if differing else 1.0


def rate_difference(
    only_a: ArrayLike, only_b: ArrayLike, pairs: ArrayLike, confidence: float = CONFIDENCE
) -> tuple[FloatArray, FloatArray]:
    """Both ends of the interval of rate A minus rate B on the same seeds; arrays are broadcast.

    The difference is d (2 t - 1): d the share of seeds on which the arms differ, t the share of
    these on which A is the better one. Given how many differ, those of A are binomial, so both have
    an exact interval (Clopper and Pearson 1934); their errors add up to ``1 - confidence``
    (Bonferroni), `SHARE_OF_SIDE` of it for t, and the interval is all that d and t allow. Errs to
    the wide side: it covers the true difference with at least ``confidence`` for any rates and
    number of pairs. Raises ValueError unless ``only_a + only_b <= pairs``.
    """
    a, b, n = np.broadcast_arrays(*(np.asarray(each, float) for each in (only_a, only_b, pairs)))
    error = 1.0 - confidence
    side = clopper_pearson(a, a + b, 1.0 - SHARE_OF_SIDE * error)
    often = clopper_pearson(a + b, n, 1.0 - (1.0 - SHARE_OF_SIDE) * error)
    low, high = (2.0 * end - 1.0 for end in side)
    return (
        np.minimum(low * often[0], low * often[1]),
        np.maximum(high * often[0], high * often[1]),
    )


def rank_beyond(count: int, confidence: float = CONFIDENCE) -> int:
    """Return how many of ``count`` sorted values lie beyond either end of the median's interval.

    The most, k, for which fewer than k + 1 of them are below the median with a probability of at
    most half of ``1 - confidence``; -1 where even the smallest and largest are not sure enough.
    """
    from scipy.special import bdtr

    tail = (1.0 - confidence) / 2.0
    below = bdtr(np.arange(0, count // 2 + 1), count, 0.5)
    return int(np.searchsorted(below, tail, side="right")) - 1


def median_difference(
    differences: ArrayLike, confidence: float = CONFIDENCE
) -> tuple[float, float, float]:
    """Median of paired differences (n,), and both ends of its interval, two of them; exact.

    The order statistics with which the sign test would not reject (Thompson, Annals of Mathematical
    Statistics 7, 1936). Errs to the wide side, for any distribution, ties included. It is the
    median of the differences, not the difference of the medians. With too few for any such interval
    (five or less for 95 %) it is infinite. Without any, or where one is nan, the median is nan and
    the interval infinite.
    """
    d = np.sort(np.asarray(differences, float))
    if not len(d) or np.isnan(d[-1]):
        return math.nan, -math.inf, math.inf
    value, beyond = float(np.median(d)), rank_beyond(len(d), confidence)
    if beyond < 0:
        return value, -math.inf, math.inf
    return value, float(d[beyond]), float(d[-1 - beyond])


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


# Many arms in many worlds


@dataclass(frozen=True)
class Duel:
    """Arm a beside arm b over all worlds: the mean difference, a minus b, worlds weighing alike."""

    difference: float
    """nan where no world has enough seeds of both"""
    low: float
    high: float
    worlds: int
    """that have enough seeds of both"""
    only_a: int
    """seeds of these worlds with which a's value is larger"""
    only_b: int
    p: float = 1.0
    """of the sign test over all seeds, corrected for the number of duels (Holm)"""

    @property
    def sure(self) -> int:
        """1 where a's values are surely larger, -1 where b's are, 0 where it cannot be told.

        Sure is what interval and test say alike: the interval, of the mean over worlds, takes what
        never differed in one of few seeds for certain; the test, exact, does not.
        """
        if self.p > 1.0 - CONFIDENCE:
            return 0
        if self.low > 0.0 and self.only_a > self.only_b:
            return 1
        return -1 if self.high < 0.0 and self.only_b > self.only_a else 0


def duels(
    values: Sequence[ArrayLike], fewest: int = 1, draws: int = 2000, confidence: float = CONFIDENCE
) -> dict[tuple[int, int], Duel]:
    """Every two of E arms compared, a before b, over worlds on paired seeds.

    ``values`` are (E, S) of each world, nan where an arm has none; of a world the seeds count that
    both have, if there are at least ``fewest``. Intervals hold for all duels at once with about
    ``confidence``: seeds are drawn anew within each world (bootstrap), the same for all arms, and
    the largest of the standardised deviations gives how wide all are.
    """
    tables = [np.asarray(one, float) for one in values]
    arms = len(tables[0]) if tables else 0
    first, second = np.triu_indices(arms, 1)
    total, drawn = np.zeros(len(first)), np.zeros((draws, len(first)))
    worlds, won, lost = (np.zeros(len(first), int) for _ in range(3))
    for k, table in enumerate(tables):
        seeds = table.shape[1]
        if not seeds:
            continue
        gap = (table[first] - table[second]).T  # (S, P)
        known = ~np.isnan(gap)
        counts = known.sum(axis=0) >= fewest
        gap, known = np.where(known & counts, gap, 0.0), known & counts
        share = np.full(seeds, 1.0 / seeds)
        often = stream(0, "duels", k).multinomial(seeds, share, draws).astype(float)
        mean = gap.sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        have = often @ known
        total += mean
        drawn += np.where(have > 0.0, (often @ gap) / np.maximum(have, 1.0), mean)
        worlds += counts
        won, lost = won + (gap > 0.0).sum(axis=0), lost + (gap < 0.0).sum(axis=0)
    some = np.maximum(worlds, 1)
    mean, drawn = total / some, drawn / some
    spread = drawn.std(axis=0)
    varies = spread > 0.0
    size = np.abs(drawn - mean)[:, varies] / spread[varies]
    reach = float(np.quantile(size.max(axis=1), confidence)) if varies.any() else 0.0
    tests = holm([sign_test(int(a), int(b)) for a, b in zip(won, lost, strict=True)])
    return {
        (int(a), int(b)): Duel(
            float(mean[k]) if worlds[k] else math.nan, float(mean[k] - reach * spread[k]),
            float(mean[k] + reach * spread[k]), int(worlds[k]), int(won[k]), int(lost[k]), tests[k],
        )
        for k, (a, b) in enumerate(zip(first, second, strict=True))
    }  # fmt: skip
