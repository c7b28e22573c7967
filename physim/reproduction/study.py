"""What a reproduction consists of: claims of the paper by figure, studies, verdicts on both.

A claim says what the paper reports, which figures of a run decide, and the grade. A study has
arms that differ in one thing, seeds, measures, and verdicts of its own.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from physim.record import Record
    from physim.world import World
    from physim.world.file import Document


Measures = Mapping[str, float]
"""Figures of one run by name; nan where one has no meaning for it."""
Runs = Sequence[Measures]
"""Figures of an arm, a run a seed."""
Table = Sequence[Runs]
"""Figures of an experiment, for every arm in order."""


class Outcome(StrEnum):
    """How what was measured stands to what was claimed."""

    MET = "met"
    PARTLY = "partly met"
    NOT_MET = "not met"


@dataclass(frozen=True)
class Verdict:
    """One claim, what was measured for it, and how the two agree; computed, never typed."""

    claim: str
    reported: str
    measured: str
    """of the pictured run; of all arms and seeds in a study"""
    outcome: Outcome
    remark: str = ""
    """one sentence: why an exact match is impossible, or what the verdict takes for granted"""
    spread: str = ""
    """median and range over seeds; empty in a study"""
    met: str = ""
    """in how many seeds, "97 of 100"; empty in a study"""
    without: str = ""
    """in how many seeds without avoidance; empty where that was not tried"""


@dataclass(frozen=True)
class Arm:
    """One way of running: a world, shipped or of the study's own, with some values changed.

    Arms that differ in their labels alone are equal: they are the same run.
    """

    label: str = field(compare=False)
    """as it stands on an axis or in a table"""
    world: str
    overrides: tuple[str, ...] = ()
    """``KEY=VALUE`` as for ``physim run --set``"""
    text: Callable[[int], str] | None = None
    """where the study has a world of its own: module-level function from the seed to the text of
    its world file, which ``world`` names"""

    def read(self, seed: int) -> tuple[World, Document]:
        """World of this arm for one seed, and its document, which holds what is to be noted.

        Raises WorldError when its overrides don't fit.
        """
        from physim.world.file import read_document, read_world, world_of

        if self.text is None:
            return read_world(self.world, overrides=self.overrides)
        document = read_document(self.text(seed), self.world)
        return world_of(document, overrides=self.overrides)

    def load(self, seed: int) -> World:
        """World of this arm for one seed, without what is to be noted about it."""
        return self.read(seed)[0]


@dataclass(frozen=True)
class Study:
    """An experiment: the same seeds in every arm.

    ``measure`` is a module-level function (it is sent to worker processes) from a record to
    figures; it must not keep the record. ``conclude`` and ``draw`` get what was measured; ``draw``
    also the figure to draw in, and the labels of the arms.
    """

    name: str
    """word for files and the command line"""
    title: str
    claim: str
    """the paper's claim in our words"""
    arms: tuple[Arm, ...]
    measure: Callable[[Record], Measures]
    conclude: Callable[[Table], Sequence[Verdict]]
    draw: Callable[[Figure, Sequence[str], Table], None]
    seeds: int = 20
    quick_seeds: int = 2

    @property
    def labels(self) -> tuple[str, ...]:
        """Labels of the arms."""
        return tuple(arm.label for arm in self.arms)


MOST_SEEDS = 0.9
"""[-] share of the seeds that must meet a claim before it is met."""

WORDS = "words"
"""Stands in the place of a figure's number."""
PAIR_TIMES = "pair_times"
"""The picture that only a reproduction has: collision times of all pairs."""

Grade = Callable[[Measures], Outcome]
"""How one run stands to a claim."""


@dataclass(frozen=True)
class Quantity:
    """One figure of a run, and how it is written."""

    key: str
    unit: str = ""
    """"%" shows a share; "yes" shows 1 as yes and 0 as no"""
    decimals: int = 2
    label: str = ""
    """stands before the figure"""

    def text(self, value: float) -> str:
        """The figure with its unit; "none" for one that has no meaning."""
        if self.unit == "yes":
            return self._labelled("none" if math.isnan(value) else "yes" if value > 0 else "no")
        known = math.isfinite(value)
        return self._labelled(self._number(value), self.unit if known else "")

    def spread(self, values: Sequence[float]) -> str:
        """Median and range over seeds, of those where the figure has a meaning."""
        known = [v for v in values if not math.isnan(v)]
        if not known:
            return self._labelled("none")
        if self.unit == "yes":
            return self._labelled(f"yes in {sum(v > 0 for v in known)} of {len(known)}")
        middle, low, high = (
            self._number(v) for v in (float(np.median(known)), min(known), max(known))
        )
        several = middle if low == high else f"{middle} ({low} to {high})"
        return self._labelled(several, self.unit)

    def _labelled(self, text: str, unit: str = "") -> str:
        return " ".join(part for part in (self.label, text, unit) if part)

    def _number(self, value: float) -> str:
        if math.isnan(value):
            return "none"
        if math.isinf(value):
            return "never" if value > 0 else "-never"
        return f"{100.0 * value if self.unit == '%' else value:,.{self.decimals}f}"


@dataclass(frozen=True)
class Claim:
    """One number or statement of the paper."""

    claim: str
    """in our words"""
    reported: str
    quantities: tuple[Quantity, ...]
    grade: Grade
    remark: str = ""
    """one sentence: why an exact match is impossible, or what the grade takes for granted"""

    needed: float = MOST_SEEDS
    """[-] share of the seeds that must meet it; 1 where the paper says always"""

    def measured(self, run: Measures) -> str:
        """The figures of one run."""
        return ", ".join(q.text(run.get(q.key, math.nan)) for q in self.quantities)

    def spread(self, runs: Sequence[Measures]) -> str:
        """The figures over seeds."""
        return "; ".join(
            q.spread([run.get(q.key, math.nan) for run in runs]) for q in self.quantities
        )

    def graded(self, run: Measures) -> Outcome:
        """How one run stands to the claim; figures that it does not have never meet it."""
        return self.grade(defaultdict(lambda: math.nan, run))

    def met(self, runs: Sequence[Measures]) -> int:
        """In how many runs the claim is met."""
        return sum(self.graded(run) is Outcome.MET for run in runs)

    def outcome(self, pictured: Measures, runs: Sequence[Measures]) -> Outcome:
        """Grade of the pictured run, taken down to *partly* where too few seeds meet the claim.

        And up to *partly* where the pictured run misses what nearly all seeds meet.
        """
        grade = self.graded(pictured)
        if not runs:
            return grade
        most = self.met(runs) >= self.needed * len(runs)
        if grade is Outcome.MET:
            return Outcome.MET if most else Outcome.PARTLY
        return Outcome.PARTLY if most else grade

    def verdict(
        self, pictured: Measures, runs: Sequence[Measures], bare: Sequence[Measures]
    ) -> Verdict:
        """How the pictured run and all others stand to it; ``bare`` are runs without avoidance."""
        outcome, remark = self.outcome(pictured, runs), self.remark
        if bare and outcome is Outcome.MET and self.met(bare) >= self.needed * len(bare):
            remark = f"{remark} It holds without avoidance, too.".strip()
        return Verdict(
            self.claim, self.reported, self.measured(pictured), outcome, remark,
            self.spread(runs) if runs else "",
            f"{self.met(runs)} of {len(runs)}" if runs else "",
            f"{self.met(bare)} of {len(bare)}" if bare else "",
        )  # fmt: skip


@dataclass(frozen=True)
class Part:
    """A figure of the paper, or its words: what it shows, the world, the pictures, the claims."""

    figure: str
    """number, or `WORDS`"""
    title: str
    world: str
    pictures: tuple[str, ...]
    """of `physim.drawing.plots`, or `PAIR_TIMES`"""
    claims: tuple[Claim, ...]
    bare: bool = False
    """whether its claims are held against runs without avoidance, too"""
    film: bool = False
    snapshots: float | None = None
    """[s] between the robots in the map"""

    @property
    def arms(self) -> tuple[Arm, ...]:
        """Its world with every seed, and where asked the same without avoidance."""
        bare = Arm("", self.world, ("controller.avoidance=none",))
        return (Arm("", self.world), bare) if self.bare else (Arm("", self.world),)


def holds(condition: Callable[[Measures], bool]) -> Grade:
    """Met where a condition holds, otherwise not met; figures without meaning never meet it."""
    return lambda run: Outcome.MET if condition(run) else Outcome.NOT_MET


def steps(full: Callable[[Measures], bool], part: Callable[[Measures], bool]) -> Grade:
    """Met where ``full`` holds, partly where ``part`` does."""

    def grade(run: Measures) -> Outcome:
        if full(run):
            return Outcome.MET
        return Outcome.PARTLY if part(run) else Outcome.NOT_MET

    return grade


def near(key: str, reported: float, same: float, order: float) -> Grade:
    """Met within a share ``same`` of the reported figure, partly within a factor ``order``."""
    return steps(
        lambda run: abs(run[key] - reported) <= same * reported,
        lambda run: reported / order <= run[key] <= reported * order,
    )
