"""What a reproduction consists of: arms, studies, and the verdict on each claim."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from physim.record import Record
    from physim.world import World

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

    def load(self, seed: int) -> World:
        """World of this arm for one seed. Raises WorldError when its overrides don't fit."""
        from physim.world_file import load_world, parse_world

        if self.text is None:
            return load_world(self.world, overrides=self.overrides)
        return parse_world(self.text(seed), self.world, overrides=self.overrides)


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
