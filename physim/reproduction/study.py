"""A study: arms that differ in one thing, the same seeds in each, measures, and verdicts.

What is measured is summed up by medians and shares with 95 % intervals; conclusions are drawn from
these in a few words: `falls`, `same`, `outcome`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from physim.analysis.metrics.progress import active_time
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.reproduction.measures import Measures, figures
from physim.reproduction.model import Arm, Measure, Outcome, Verdict, outcome
from physim.statistics import clopper_pearson, rank_beyond


class Estimate(NamedTuple):
    """Median of a sample, with an interval for the median of what it was drawn from."""

    median: float
    low: float
    high: float
    number: int
    """values that have a meaning (are not nan)"""

    def text(self, digits: int = 2, unit: str = "") -> str:
        """ "1.23 [1.10, 1.31] m"; the median alone where all are equal, "none" of nothing."""
        if not self.number:
            return "none"
        rounded = [f"{value:z.{digits}f}".replace("inf", "never") for value in self[:3]]
        text = rounded[0]
        if len(set(rounded)) > 1:
            text += f" [{rounded[1]}, {rounded[2]}]"
        return text if text == "never" else f"{text} {unit}".strip()

    def is_below(self, other: Estimate) -> bool:
        """Whether it is clearly smaller: the intervals are apart."""
        return self.high < other.low


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


class Share(NamedTuple):
    """How many runs of how many."""

    good: int
    of: int

    @property
    def rate(self) -> float:
        """Share of 1."""
        return self.good / self.of

    @property
    def text(self) -> str:
        """ "19 of 20 [75 %, 100 %]", the interval by Clopper and Pearson."""
        low, high = map(float, clopper_pearson(self.good, self.of))
        return f"{self.good} of {self.of} [{100 * low:.0f} %, {100 * high:.0f} %]"


@dataclass(frozen=True)
class Runs:
    """What an arm came to: the figures of its runs, in the order of seeds."""

    runs: Sequence[Measures]

    def column(self, name: str) -> list[float]:
        """One measure of every run."""
        return [float(run[name]) for run in self.runs]

    def of(self, name: str) -> Estimate:
        """Median and interval of one measure."""
        return estimate(self.column(name))

    def share(self, name: str, is_fine: Callable[[float], bool]) -> Share:
        """Runs whose measure is fine."""
        return Share(sum(map(is_fine, self.column(name))), len(self.runs))

    @cached_property
    def free(self) -> Share:
        """Runs without any contact."""
        return self.share("contacts", lambda value: value == 0.0)

    @cached_property
    def arrived(self) -> Share:
        """Runs in which all robots arrived."""
        return self.share("finished", lambda value: value > 0.0)


class Shown(NamedTuple):
    """How a measure is written, and drawn."""

    words: str
    unit: str = ""
    digits: int = 2
    logarithmic: bool = False
    line: float | None = None
    """what it is compared with in a plot"""


FREE, ARRIVED = "free", "arrived"
GROUP = {
    "shortest_distance": Shown("shortest distance between robots", "m"),
    "kept": Shown("shortest distance to anything", "m", 3),
    "farthest_distance": Shown("largest distance", "m", 1),
    "formation_error_peak": Shown("largest formation error", "m", 1),
    "averaged_speed_min": Shown("slowest speed over 10 s", "m/s"),
    "time_to_finish": Shown("time to finish", "s", 1),
    "danger_share": Shown("share of time in danger mode"),
    "mode_switches": Shown("mode switches of a robot", "1/min", 1),
    "by_distance": Shown("share of decisions by (12)"),
    "by_time": Shown("share of decisions by (13)"),
    "updates": Shown("updates of a robot", "1/s", logarithmic=True),
    "messages": Shown("messages of a robot", "1/s", 1),
    "evaluations": Shown("collision times of a robot", "1/s", 0, logarithmic=True),
}
"""What experiments with a group compare (`measure_group`): safety, arrival, modes, formation and
work. ``kept`` is of any robot to another or to a wall; what is a second is until it has arrived."""


def told(names: Sequence[str], *arms: Runs) -> str:
    """Measures of `GROUP`, and runs that are `FREE` or have `ARRIVED`, of an arm against others."""

    def text(runs: Runs, name: str) -> str:
        if name == FREE:
            return runs.free.text
        if name == ARRIVED:
            return f"{runs.arrived.good} of {runs.arrived.of}"
        return runs.of(name).text(GROUP[name].digits, GROUP[name].unit)

    words = {FREE: "free of contact", ARRIVED: "finished", **{k: v.words for k, v in GROUP.items()}}
    return ", ".join(
        f"{words[name]} {' against '.join(text(runs, name) for runs in arms)}" for name in names
    )


def each(names: Sequence[str], arms: Mapping[str, Sequence[Runs]]) -> str:
    """`told` of several arms, or of one against others, by a word for each."""
    return "; ".join(f"{word}: {told(names, *some)}" for word, some in arms.items())


def free_and_arrived(runs: Runs) -> str:
    """Note at the row of an arm."""
    return f"{runs.free.good} of {runs.free.of} free of contact,\n{runs.arrived.good} finished"


def free_of_contact(runs: Runs) -> str:
    """Note at the row of an arm."""
    return f"{runs.free.good} of {runs.free.of} free\nof contact"


def falls(*courses: Sequence[Estimate]) -> Outcome:
    """Met where each course falls clearly from one to the next, partly where the median of any
    does."""
    clearly = [all(b.is_below(a) for a, b in pairwise(course)) for course in courses]
    seen = [all(b.median < a.median for a, b in pairwise(course)) for course in courses]
    return outcome(all(clearly), any(seen))


def same(found: Iterable[Estimate], within: float) -> Outcome:
    """Met where the medians of all ratios are 1 ``within`` a share, partly where any is."""
    near = [abs(one.median - 1.0) <= within for one in found]
    return outcome(all(near), any(near))


@dataclass(frozen=True)
class Study:
    """An experiment: the same seeds in every arm.

    ``measure`` is a module-level function (it is sent to worker processes) from a record to
    figures; it must not keep the record.
    """

    name: str
    """word for files and the command line"""
    title: str
    claim: str
    """the paper's claim in our words"""
    arms: tuple[Arm, ...]
    measure: Measure
    conclude: Callable[[Sequence[Runs]], Sequence[Verdict]]
    """of what the arms came to"""
    shown: Mapping[str, Shown]
    """measures, an axis each in its plot, which has a row for each arm"""
    note: Callable[[Runs], str] = lambda runs: ""
    """at the end of each row"""
    seeds: int = 20
    quick_seeds: int = 2


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


METRICS = (
    "contacts", "shortest_distance", "shortest_boundary_distance", "farthest_distance", "finished",
    "time_to_finish", "danger_share", "mode_switches", "averaged_speed_min", "updates_per_second",
    "messages", "formation_error_peak",
)  # fmt: skip


def rule_shares(record: Record) -> dict[str, float]:
    """Shares of decisions by (12) and by (13); nan where the controller has no such rule."""
    names, given = [rule.name for rule in record.declared.rules], record.updates["rule"]

    def share(name: str) -> float:
        known = name in names and len(given)
        return float(np.mean(given == names.index(name))) if known else math.nan

    return {"by_distance": share("distance"), "by_time": share("time")}


def measure_group(record: Record) -> dict[str, float]:
    """Figures of a run of a group: those of `GROUP`, and contacts and arrival."""
    found = figures(record, *METRICS)
    distances = (found["shortest_distance"], found["shortest_boundary_distance"])
    seconds = float(active_time(record).sum()) or math.nan
    computed = figures(record, "collision_time_evaluations")["collision_time_evaluations"]
    return {
        **found,
        "kept": min((value for value in distances if not math.isnan(value)), default=math.nan),
        "updates": found["updates_per_second"],
        "messages": found["messages"] / seconds,
        "evaluations": computed / seconds,
        **rule_shares(record),
    }
