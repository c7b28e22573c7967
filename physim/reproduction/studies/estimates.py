"""Medians over seeds with 95 % intervals, and shares with theirs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from physim.reproduction.study import Outcome, Runs
from physim.validation.seeds import CONFIDENCE, clopper_pearson


@dataclass(frozen=True)
class Estimate:
    """Median of a sample, with an interval for the median of what it was drawn from."""

    median: float
    low: float
    high: float
    count: int
    """values that have a meaning (are not nan)"""

    def text(self, digits: int = 2, unit: str = "") -> str:
        """ "1.23 [1.10, 1.31] m"; the median alone where all are equal, "none" of nothing."""
        if not self.count:
            return "none"
        rounded = [_rounded(value, digits) for value in (self.median, self.low, self.high)]
        shown = rounded[0]
        if len(set(rounded)) > 1:
            shown += f" [{rounded[1]}, {rounded[2]}]"
        return shown if shown == "never" else f"{shown} {unit}".strip()


def estimate(values: Iterable[float]) -> Estimate:
    """Median and its 95 % interval by order statistics, free of any distribution; nan is left out.

    The interval lies between the k-th smallest and the k-th largest value, with the largest k
    whose coverage is 95 % or more. Fewer than six values cannot reach that: all of them then.
    """
    given = np.sort([value for value in values if not math.isnan(value)])
    n = len(given)
    if not n:
        return Estimate(math.nan, math.nan, math.nan, 0)
    k = _rank(n)
    return Estimate(float(np.median(given)), float(given[k]), float(given[n - 1 - k]), n)


def _rounded(value: float, digits: int) -> str:
    """Number with so many digits, never "-0.00"; "never" for a time that is inf."""
    if math.isinf(value):
        return "never"
    shown = f"{value:.{digits}f}"
    return f"{0.0:.{digits}f}" if float(shown) == 0.0 else shown


def _rank(n: int) -> int:
    """Number of values beyond either end of the interval of the median."""
    beyond, miss = 0, 2.0 * 0.5**n
    while True:
        miss += 2.0 * math.comb(n, beyond + 1) * 0.5**n
        if miss > 1.0 - CONFIDENCE:
            return beyond
        beyond += 1


def column(runs: Runs, name: str) -> list[float]:
    """One measure of every run of an arm, in the order of seeds."""
    return [float(run[name]) for run in runs]


def estimated(runs: Runs, name: str) -> Estimate:
    """Median and interval of one measure of an arm."""
    return estimate(column(runs, name))


def count(runs: Runs, name: str, is_fine: Callable[[float], bool]) -> tuple[int, int]:
    """Number of runs whose measure is fine, and of all runs."""
    return sum(is_fine(value) for value in column(runs, name)), len(runs)


def contact_free(runs: Runs) -> tuple[int, int]:
    """Number of runs without any contact, and of all runs."""
    return count(runs, "contacts", lambda value: value == 0.0)


def arrived(runs: Runs) -> tuple[int, int]:
    """Number of runs in which all robots arrived, and of all runs."""
    return count(runs, "finished", lambda value: value > 0.0)


def share_text(good: int, of: int) -> str:
    """ "19 of 20 [75 %, 100 %]", the interval by Clopper and Pearson."""
    low, high = clopper_pearson(good, of)
    return f"{good} of {of} [{100 * low:.0f} %, {100 * high:.0f} %]"


def free_text(runs: Runs) -> str:
    """Share of the runs without any contact, as text."""
    return share_text(*contact_free(runs))


def outcome(met: bool, partly: bool = False) -> Outcome:
    """Outcome of a claim: met, else partly met, else not met."""
    return Outcome.MET if met else Outcome.PARTLY if partly else Outcome.NOT_MET
