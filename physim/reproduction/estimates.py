"""What studies measure, and how it is summed up: medians and shares with 95 % intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from physim.analysis.metrics import evaluations
from physim.analysis.metrics import measure as take
from physim.analysis.metrics.progress import active_time
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction.decided import formation_error_peak
from physim.reproduction.study import Outcome, Runs
from physim.statistics import clopper_pearson, rank_beyond


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
        text = rounded[0]
        if len(set(rounded)) > 1:
            text += f" [{rounded[1]}, {rounded[2]}]"
        return text if text == "never" else f"{text} {unit}".strip()


def estimate(values: Iterable[float]) -> Estimate:
    """Median and its 95 % interval by order statistics, free of any distribution; nan is left out.

    The interval lies between the k-th smallest and the k-th largest value, with the largest k
    whose coverage is 95 % or more. Fewer than six values cannot reach that: all of them then.
    """
    given = np.sort([value for value in values if not math.isnan(value)])
    n = len(given)
    if not n:
        return Estimate(math.nan, math.nan, math.nan, 0)
    k = max(0, rank_beyond(n))
    return Estimate(float(np.median(given)), float(given[k]), float(given[n - 1 - k]), n)


def _rounded(value: float, digits: int) -> str:
    """Number with so many digits, never "-0.00"; "never" for a time that is inf."""
    if math.isinf(value):
        return "never"
    text = f"{value:.{digits}f}"
    return f"{0.0:.{digits}f}" if float(text) == 0.0 else text


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


FEWEST = 5
"""Points that a fit needs."""


def time_constant(time: FloatArray, values: FloatArray) -> float:
    """Time constant [s] of values (K,) > 0 that die away: least squares on their logarithm.

    nan with fewer than `FEWEST` points; negative where the values grow.
    """
    if len(time) < FEWEST:
        return math.nan
    slope = float(np.polyfit(time - time[0], np.log(values), 1)[0])
    return math.inf if slope == 0.0 else -1.0 / slope


def root_mean_square(values: FloatArray) -> FloatArray:
    """Root of the mean square over robots: (K,) of values (K, N)."""
    return np.asarray(np.sqrt(np.square(values).mean(axis=1)))


GROUP = (
    "contacts", "shortest_distance", "shortest_boundary_distance", "farthest_distance", "finished",
    "time_to_finish", "danger_share", "mode_switches", "averaged_speed_min", "updates_per_second",
    "messages",
)  # fmt: skip
"""Metrics that experiments with a group compare."""


def figures(record: Record, *names: str) -> dict[str, float]:
    """Metrics by name; nan where one has no meaning for the run."""
    found = take(record, names)
    values = {name: found[name].value if name in found else None for name in names}
    return {name: math.nan if value is None else float(value) for name, value in values.items()}


def rule_shares(record: Record) -> dict[str, float]:
    """Shares of decisions by (12) and by (13); nan where the controller has no such rule."""
    names = [rule.name for rule in record.declared.rules]
    given = record.updates["rule"]
    found = {}
    for key, name in (("by_distance", "distance"), ("by_time", "time")):
        known = name in names and len(given)
        found[key] = float(np.mean(given == names.index(name))) if known else math.nan
    return found


def measure_group(record: Record) -> dict[str, float]:
    """What experiments with a group compare: safety, arrival, modes, formation and work.

    ``kept`` is the shortest distance [m] of any robot to another or to a wall; ``updates``,
    ``messages`` and ``evaluations`` (collision times computed) are per robot and second until it
    has arrived.
    """
    found = figures(record, *GROUP)
    distances = (found["shortest_distance"], found["shortest_boundary_distance"])
    seconds = float(active_time(record).sum()) or math.nan
    computed = evaluations(record)
    return {
        **found,
        "formation_error_peak": formation_error_peak(record),
        "kept": min((value for value in distances if not math.isnan(value)), default=math.nan),
        "updates": found["updates_per_second"],
        "messages": found["messages"] / seconds,
        "evaluations": (math.nan if computed is None else computed) / seconds,
        **rule_shares(record),
    }
