"""When a campaign has seen enough: ``0.02``, ``rate > 0.99``; read by a small grammar.

    GOAL   = WIDTH | RATE SIGN NUMBER
    RATE   = rate | contact_free | finished
    SIGN   = < | >
    NUMBER = a decimal number from 0 to 1, or from 0% to 100%

``rate`` is that of runs which are contact-free and finished. A width is the most that the interval
of ``rate`` may span. Nothing of it is evaluated.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from physim.escaping import escaped
from physim.statistics.proportion import CONFIDENCE
from physim.statistics.sequence import at_each_look, running

RATES = ("rate", "contact_free", "finished")
ALLOWED = (
    'a width above 0 and below 1, as 0.02 or 2%, or RATE < or > NUMBER, as "rate > 0.99", '
    f"RATE one of {', '.join(RATES)}"
)
PARTS = re.compile(
    r"\s*(?:(?P<word>[A-Za-z_]+)|(?P<sign>[<>])|(?P<number>\d*\.?\d+)(?P<percent>\s*%)?"
    r"|(?P<other>\S))"
)
LONGEST = 100
"""Characters of a goal; longer ones are refused unread."""


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
        """Write it in the grammar; reading that gives the same goal."""
        return f"{self.rate} {self.sign} {self.number!r}" if self.sign else f"{self.number!r}"

    def reached(self, low: ArrayLike, high: ArrayLike) -> np.ndarray:
        """Whether intervals decide: narrow enough, or wholly on one side of the number."""
        low, high = np.asarray(low), np.asarray(high)
        if not self.sign:
            return np.asarray(high - low <= self.number)
        return np.asarray((low > self.number) | (high < self.number))


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


def read_goal(text: str) -> Goal:
    """Read a goal. Raises ValueError with what is allowed and the place of the first fault."""
    if len(text) > LONGEST:
        raise ValueError(ALLOWED)
    parts = list(PARTS.finditer(text.rstrip()))
    kinds = ["number" if part["number"] else str(part.lastgroup) for part in parts]
    expected = ["number"] if kinds[:1] == ["number"] else ["word", "sign", "number"]
    for k, kind in enumerate(expected):
        if k == len(kinds):
            raise ValueError(f"{ALLOWED}; it ends before its {kind}")
        if kinds[k] != kind or (kind == "word" and parts[k]["word"] not in RATES):
            raise _fault(text, parts[k].start(), f"stands where a {kind} should")
    if len(kinds) > len(expected):
        raise _fault(text, parts[len(expected)].start(), "is too much")
    number = float(parts[-1]["number"]) / (100.0 if parts[-1]["percent"] else 1.0)
    inside = 0.0 < number < 1.0 if len(expected) == 1 else 0.0 <= number <= 1.0
    if not inside:
        raise _fault(text, parts[-1].start(), "is out of range")
    if len(expected) == 1:
        return Goal("rate", "", number)
    return Goal(parts[0]["word"], parts[1]["sign"], number)


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
    low, high = float(looks.low[at]), float(looks.high[at])
    return _decision(goal, at + 1, int(looks.successes[at]), low, high, bool(enough[at]))


class Watch:
    """Outcomes held against a goal one by one, as they come; it says what `decide` says of all."""

    def __init__(self, goal: Goal, confidence: float = CONFIDENCE) -> None:
        self.goal, self.confidence = goal, confidence
        self.runs = self.successes = 0
        self.is_empty = False
        """whether the intervals have nothing in common any more; the last one that had stays"""
        self.low, self.high = 0.0, 1.0
        self.decided = False

    def add(self, good: bool) -> bool:
        """Whether it is decided with one more outcome; what comes after that has no say."""
        if self.decided:
            return True
        self.runs += 1
        self.successes += good
        ends = at_each_look([self.successes], [self.runs - self.successes], self.confidence)
        low, high = max(self.low, float(ends[0][0])), min(self.high, float(ends[1][0]))
        self.is_empty |= low > high
        if not self.is_empty:
            self.low, self.high = low, high
        self.decided = bool(self.goal.reached(self.low, self.high))
        return self.decided

    @property
    def decision(self) -> Decision:
        """What the outcomes so far say."""
        return _decision(
            self.goal, self.runs, self.successes, self.low, self.high, self.decided
        )  # fmt: skip


def _decision(
    goal: Goal, runs: int, successes: int, low: float, high: float, decided: bool
) -> Decision:
    holds = (low > goal.number) == (goal.sign == ">") if goal.sign and decided else None
    return Decision(runs, successes, low, high, decided, holds)


def _fault(text: str, at: int, what: str) -> ValueError:
    at += len(text[at:]) - len(text[at:].lstrip())
    sign = text[at : at + 12].split()[0]
    return ValueError(f'{ALLOWED}; at character {at + 1}, "{escaped(sign)}" {what}')
