"""Rules of statistics, broken: another interval, another test, another way to stop."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tests.helpers import inside
from tests.mutation.rules import found, given, instead, rule

PAIRED = "physim.statistics:"
PROPORTION = "physim.statistics:"
SEQUENCE = "physim.statistics:"


def counts(a: Any) -> tuple[Any, Any, Any]:
    """Successes, trials (1 at least), and the quantile of the normal distribution."""
    from scipy.special import ndtri

    s, n = np.broadcast_arrays(np.asarray(a.successes, float), np.asarray(a.trials, float))
    return s, np.maximum(n, 1.0), float(ndtri(0.5 + 0.5 * a.confidence))


@rule("statistics")
def interval_is_walds() -> None:
    """A rate has the normal interval about its estimate, which is empty at 0 and 1."""

    def wald(a: Any) -> Any:
        s, n, z = counts(a)
        half = z * np.sqrt(s / n * (1.0 - s / n) / n)
        return np.maximum(s / n - half, 0.0), np.minimum(s / n + half, 1.0)

    instead(PROPORTION + "clopper_pearson", wald)


@rule("statistics")
def interval_is_mid_p() -> None:
    """The ends of a rate's interval count half of the outcome that was seen."""
    from scipy.special import betaincinv

    def mid(value: Any, a: Any) -> Any:
        s, n = np.broadcast_arrays(np.asarray(a.successes, float), np.asarray(a.trials, float))
        tail = 1.0 - a.confidence
        low, high = (np.array(end) for end in value)
        some, most = s > 0, s < n
        low[some] = betaincinv(s[some], n[some] - s[some] + 1.0, tail)
        high[most] = betaincinv(s[most] + 1.0, n[most] - s[most], 1.0 - tail)
        return 0.5 * (value[0] + low), 0.5 * (value[1] + high)

    found(PROPORTION + "clopper_pearson", mid)


@rule("statistics")
def bound_is_the_rule_of_three() -> None:
    """Without a failure the rate of failures is at most 3 over the number of runs."""
    instead(
        PROPORTION + "failure_bound", lambda a: min(1.0, 3.0 / a.trials) if a.trials > 0 else 1.0
    )


@rule("statistics")
def runs_by_the_rule_of_three() -> None:
    """It takes 3 over the rate of failures to show a rate."""
    instead(PROPORTION + "runs_needed", lambda a: math.ceil(3.0 / (1.0 - a.rate)))


@rule("statistics")
def every_look_is_the_only_one() -> None:
    """A campaign that looks after every run takes the interval of a number fixed beforehand."""
    clopper_pearson = inside("physim.statistics", "clopper_pearson")

    instead(
        SEQUENCE + "at_each_look",
        lambda a: clopper_pearson(a.successes, np.add(a.successes, a.failures), a.confidence),
    )


@rule("statistics")
def looks_share_the_error() -> None:
    """The n-th look is given the share 1/2^n of the error: it holds, but never decides."""
    clopper_pearson = inside("physim.statistics", "clopper_pearson")

    def shared(a: Any) -> Any:
        s, f = np.broadcast_arrays(np.asarray(a.successes, float), np.asarray(a.failures, float))
        ends = [
            clopper_pearson(one, one + other, 1.0 - (1.0 - a.confidence) / 2.0 ** (one + other))
            for one, other in zip(s.ravel(), f.ravel(), strict=True)
        ]
        low, high = np.array(ends).reshape(-1, 2).T
        return low.reshape(s.shape), high.reshape(s.shape)

    instead(SEQUENCE + "at_each_look", shared)


@rule("statistics")
def evidence_is_the_best_likelihood() -> None:
    """The evidence against a rate is the ratio to the best rate, which has no mean of 1."""
    from scipy.special import xlogy

    def best(a: Any) -> Any:
        n = np.maximum(a.s + a.f, 1.0)
        return np.asarray(xlogy(a.s, a.s / n) + xlogy(a.f, a.f / n))

    instead(SEQUENCE + "_mixture", best)


@rule("statistics")
def all_runs_have_a_say() -> None:
    """A goal is held against the interval after the last run, not after the first that decides."""
    from types import SimpleNamespace

    running = inside("physim.statistics", "running")

    def last_look(outcomes: Any, confidence: float) -> Any:
        looks = running(outcomes, confidence)
        return SimpleNamespace(
            low=np.full_like(looks.low, looks.low[-1]),
            high=np.full_like(looks.high, looks.high[-1]),
            successes=looks.successes,
        )

    instead("physim.statistics:running", lambda a: last_look(a.outcomes, a.confidence), here=True)


@rule("statistics")
def mcnemar_is_asymptotic() -> None:
    """Two arms are compared by the chi-squared form of McNemar's test."""
    from scipy.special import chdtrc

    instead(
        PAIRED + "sign_test",
        lambda a: (
            float(chdtrc(1, (a.only_a - a.only_b) ** 2 / (a.only_a + a.only_b)))
            if a.only_a + a.only_b
            else 1.0
        ),
    )


@rule("statistics")
def mcnemar_counts_half() -> None:
    """The outcome that was seen counts half (mid-p), so that more than alpha are rejected."""
    from scipy.special import binom

    def mid(p: float, a: Any) -> float:
        n = a.only_a + a.only_b
        return float(p - binom(n, min(a.only_a, a.only_b)) * 0.5**n) if n else p

    found(PAIRED + "sign_test", mid)


@rule("statistics")
def arms_are_independent() -> None:
    """A difference of rates is taken as if the arms had run on seeds of their own."""
    from scipy.special import ndtri

    def independent(a: Any) -> Any:
        x, y, n = (np.asarray(each, float) for each in (a.only_a, a.only_b, a.pairs))
        n = np.maximum(n, 1.0)
        p, q = x / n, y / n
        half = ndtri(0.5 + 0.5 * a.confidence) * np.sqrt((p * (1 - p) + q * (1 - q)) / n)
        return np.maximum(p - q - half, -1.0), np.minimum(p - q + half, 1.0)

    instead(PAIRED + "rate_difference", independent)


@rule("statistics")
def both_parts_have_all_of_the_error() -> None:
    """The two intervals that make one of a difference each have the whole allowed error."""
    given(PAIRED + "rate_difference", confidence=lambda a: a.confidence - (1.0 - a.confidence))


@rule("statistics")
def findings_by_false_discovery() -> None:
    """P values are corrected by Benjamini and Hochberg, not by Holm."""

    def discovery(a: Any) -> list[float]:
        p = np.asarray(a.p_values, float)
        order = np.argsort(p, kind="stable")
        sizes = len(p) / np.arange(1, len(p) + 1)
        corrected = np.minimum.accumulate((p[order] * sizes)[::-1])[::-1]
        back = np.empty(len(p))
        back[order] = np.minimum(1.0, corrected)
        return back.tolist()

    instead(PAIRED + "holm", discovery)


@rule("statistics")
def findings_by_bonferroni() -> None:
    """Every p value is multiplied by the number of all, also behind those rejected before."""
    instead(PAIRED + "holm", lambda a: [float(min(1.0, len(a.p_values) * p)) for p in a.p_values])


@rule("statistics")
def median_is_the_mean() -> None:
    """The middle of paired differences is their mean."""
    found(
        PAIRED + "median_difference",
        lambda value, a: (
            (float(np.mean(a.differences)), *value[1:]) if len(a.differences) else value
        ),
    )


@rule("statistics")
def interval_is_wilsons() -> None:
    """A rate has the score interval, which covers less than it says for some rates."""

    def wilson(a: Any) -> Any:
        s, n, z = counts(a)
        middle = (s + 0.5 * z * z) / (n + z * z)
        half = z / (n + z * z) * np.sqrt(s * (n - s) / n + 0.25 * z * z)
        return np.maximum(middle - half, 0.0), np.minimum(middle + half, 1.0)

    instead(PROPORTION + "clopper_pearson", wilson)


@rule("statistics")
def looks_as_for_a_fixed_number() -> None:
    """It takes as many runs to show a rate at any look as at one look alone."""
    runs_needed = inside("physim.statistics", "runs_needed")

    instead(SEQUENCE + "looks_needed", lambda a: runs_needed(a.rate, a.confidence))
