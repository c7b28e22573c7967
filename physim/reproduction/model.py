"""What a reproduction consists of: arms that are run, claims of the paper by figure, verdicts, and
the report, which the pages are written from and which is kept beside them as JSON.
"""

from __future__ import annotations

import json
import math
import re
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from pydantic import TypeAdapter

from physim.json_text import json_text
from physim.record import Record
from physim.reproduction.measures import Measures, measures

if TYPE_CHECKING:
    from physim.world import World

Measure = Callable[[Record], Measures]
Condition = Callable[[Measures], bool]

FORMAT, VERSION = "physim-reproduction", 2
MOST_SEEDS = 0.9
"""[-] share of the seeds that must meet a claim before it is met"""
WORDS = "words"
"""Stands in the place of a figure's number."""
PAIR_TIMES = "pair_times"
"""The picture that only a reproduction has: collision times of all pairs."""


class Outcome(StrEnum):
    """How what was measured stands to what was claimed."""

    MET = "met"
    PARTLY = "partly met"
    NOT_MET = "not met"


def outcome(met: bool, partly: bool = False) -> Outcome:
    """Met, else partly met, else not met."""
    return Outcome.MET if met else Outcome.PARTLY if partly else Outcome.NOT_MET


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

    def load(self, seed: int) -> World:
        """World of this arm for one seed. Raises WorldError when its overrides don't fit."""
        from physim.world.file import parse_world, read_world

        if self.text is None:
            return read_world(self.world, overrides=self.overrides)[0]
        return parse_world(self.text(seed), overrides=self.overrides)


FIGURE = re.compile(r"\{(\w+):([^}]*)\}")


def shown(template: str, runs: Sequence[Measures]) -> str:
    """Words with figures in the place of ``{name:DECIMALS UNIT}``: of one run, or the median and in
    parentheses the range of several.

    The unit % shows a share, ``{name:yes}`` a figure as yes or no. "none" is what has no meaning.
    """

    def figure(found: re.Match[str]) -> str:
        values = [run.get(found[1], math.nan) for run in runs]
        known = [value for value in values if not math.isnan(value)]
        if not known:
            return "none"
        if found[2] == "yes":
            good = sum(value > 0 for value in known)
            return f"yes in {good} of {len(known)}" if len(runs) > 1 else "yes" if good else "no"
        digits, _, unit = found[2].partition(" ")
        middle, low, high = (
            f"{100.0 * value if unit == '%' else value:,.{digits}f}".replace("inf", "never")
            for value in (float(np.median(known)), min(known), max(known))
        )
        several = middle if low == high else f"{middle} ({low} to {high})"
        return several if several == "never" else f"{several} {unit}".rstrip()

    return FIGURE.sub(figure, template)


@dataclass(frozen=True)
class Claim:
    """One number or statement of the paper, and when a run meets it.

    Conditions are asked of the figures of one run; a figure that it does not have is nan.
    """

    figure: str
    """number of the paper's figure, or `WORDS`"""
    words: str
    """in ours"""
    reported: str
    measured: str
    """words with figures, as `shown` takes them"""
    met: Condition
    partly: Condition | None = None
    remark: str = ""
    """one sentence: why an exact match is impossible, or what the grade takes for granted"""
    needed: float = MOST_SEEDS
    """[-] share of the seeds that must meet it; 1 where the paper says always"""

    def graded(self, run: Measures) -> Outcome:
        """How one run stands to the claim."""
        found = defaultdict(lambda: math.nan, run)
        return outcome(self.met(found), self.partly is not None and self.partly(found))

    def count(self, runs: Sequence[Measures]) -> int:
        """In how many runs the claim is met."""
        return sum(self.graded(run) is Outcome.MET for run in runs)

    def outcome(self, pictured: Measures, runs: Sequence[Measures]) -> Outcome:
        """Grade of the pictured run, taken down to *partly* where too few seeds meet the claim.

        And up to *partly* where the pictured run misses what nearly all seeds meet.
        """
        grade = self.graded(pictured)
        if not runs:
            return grade
        most = self.count(runs) >= self.needed * len(runs)
        if grade is Outcome.MET:
            return Outcome.MET if most else Outcome.PARTLY
        return Outcome.PARTLY if most else grade

    def verdict(
        self, pictured: Measures, runs: Sequence[Measures], bare: Sequence[Measures] = ()
    ) -> Verdict:
        """How the pictured run and all others stand to it; ``bare`` are runs without avoidance."""
        found, remark = self.outcome(pictured, runs), self.remark
        if bare and found is Outcome.MET and self.count(bare) >= self.needed * len(bare):
            remark = f"{remark} It holds without avoidance, too.".strip()
        return Verdict(
            self.words, self.reported, shown(self.measured, [pictured]), found, remark,
            shown(self.measured, runs) if runs else "",
            *(f"{self.count(some)} of {len(some)}" if some else "" for some in (runs, bare)),
        )  # fmt: skip


def near(key: str, reported: float, same: float, order: float) -> tuple[Condition, Condition]:
    """Met within a share ``same`` of the reported figure, partly within a factor ``order``."""
    return (
        lambda run: abs(run[key] - reported) <= same * reported,
        lambda run: reported / order <= run[key] <= reported * order,
    )


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
    seeds: int = 100
    quick_seeds: int = 5

    @property
    def measure(self) -> Measure:
        """What is measured of its runs."""
        return measures

    @property
    def arms(self) -> tuple[Arm, ...]:
        """Its world with every seed, and where asked the same without avoidance."""
        bare = Arm("", self.world, ("controller.avoidance=none",))
        return (Arm("", self.world), bare) if self.bare else (Arm("", self.world),)


@dataclass(frozen=True)
class Section:
    """A figure of the paper, its words, or a study: pictures, commands and claims."""

    key: str
    title: str
    about: str
    """a sentence: what was run"""
    commands: tuple[str, ...]
    rows: tuple[Verdict, ...]
    pictures: tuple[str, ...] = ()
    """files, relative to the page"""
    captions: tuple[str, ...] = ()
    films: tuple[str, ...] = ()
    """videos and pages of the run, relative to the page"""
    missing: str = ""
    """why it is not whole; empty when it is"""

    @property
    def short(self) -> str:
        """What it is called in a line: "Figure 4", "study alpha"."""
        what, _, _ = self.title.partition(":")
        return f"study {self.key}" if what == "Study" else what


@dataclass(frozen=True)
class Report:
    """All that the pages say, as plain values."""

    physim: str
    """version"""
    command: str
    seeds: int
    """asked for, of each world"""
    sections: tuple[Section, ...]
    figures: dict[str, dict[str, float]] = field(default_factory=dict)
    """figures of the pictured runs by world; absent where they have no meaning"""
    interrupted: bool = False
    paper: str = "mode_switching"
    """name of one of `physim.reproduction.papers`"""

    @property
    def rows(self) -> tuple[Verdict, ...]:
        """Every claim."""
        return tuple(row for section in self.sections for row in section.rows)

    def to_json(self) -> str:
        """As JSON text; figures with nine digits."""
        figures = {
            world: {name: float(f"{value:.9g}") for name, value in run.items()}
            for world, run in self.figures.items()
        }
        tree = {"format": FORMAT, "version": VERSION, **asdict(replace(self, figures=figures))}
        return json_text(tree)

    @classmethod
    def from_json(cls, text: str) -> Report:
        """Read back. Raises ValueError for what is no such text."""
        tree = json.loads(text)
        if (tree.pop("format", None), tree.pop("version", None)) != (FORMAT, VERSION):
            raise ValueError("no reproduction of this version")
        return TypeAdapter(cls).validate_python(tree)
