"""What a check of a controller found: rule, world, robot, time and what is wrong."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from typing import Any


class Rule(StrEnum):
    """What every controller keeps to."""

    RAISES = "raises"
    """`decide` raises nothing"""
    DECISION = "decision"
    """it returns a `Decision` that a run can take: numbers, within limits, fit for the record"""
    REPEATS = "repeats"
    """the same settings, observation and memory give the same decision"""
    STATE = "state"
    """what one decision leaves for the next is in its memory: on the object, its class or its
    module nothing changes"""
    ORDER = "order"
    """nothing depends on the order in which robots are asked, nor on who else is"""
    MEMORY = "memory"
    """the memory that is handed over is left as it is"""
    COPIES = "copies"
    """memory can be deep-copied and pickled, and a copy gives the same decision"""
    OBSERVATION = "observation"
    """nothing is written into what is seen"""
    BATCH = "batch"
    """the batch form, where there is one, decides as the plain form"""
    BATCH_ORDER = "batch_order"
    """and in whatever portions and order it is asked for the robots that are due"""


@dataclass(frozen=True)
class Finding:
    """One rule that a controller breaks in one world: where this is seen first."""

    rule: Rule
    world: str
    """name or file, or that of a situation (`physim.testing.situations`)"""
    robot: str
    time: float
    """[s]"""
    text: str
    """one line"""

    def __str__(self) -> str:
        """``rule: world, robot at time s: text``."""
        return f"{self.rule}: {self.world}, {self.robot} at {self.time:g} s: {self.text}"

    def as_json(self) -> dict[str, Any]:
        """Return the finding as JSON holds it."""
        return {**asdict(self), "rule": str(self.rule)}


class FindingLog:
    """Findings of one world as they come: the first of each rule, and how many more there were."""

    def __init__(self, world: str) -> None:
        self.world = world
        self._first: dict[Rule, Finding] = {}
        self._more: dict[Rule, int] = {}

    def add(self, rule: Rule, robot: str, time: float, text: str) -> None:
        """Take down a finding; ``text`` is brought onto one line."""
        if rule in self._first:
            self._more[rule] += 1
            return
        line = " ".join(text.split())
        self._first[rule] = Finding(rule, self.world, robot, time, line)
        self._more[rule] = 0

    def __contains__(self, rule: Rule) -> bool:
        """Whether a rule is broken."""
        return rule in self._first

    def findings(self) -> tuple[Finding, ...]:
        """One finding a rule, in the order in which they were made."""
        return tuple(
            replace(one, text=f"{one.text} (and {more} more)") if more else one
            for one, more in ((one, self._more[rule]) for rule, one in self._first.items())
        )
