"""A controller made of a function, for runs of `tests.roads`; and whether an error says enough."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from physim.parts.controller import Decision, Observation

THREE = [[20.0, -10.0, 0.3], [30.0, 0.0, -2.0], [40.0, 10.0, 0.0]]
"""Start poses of three robots [m, m, rad]."""


class Says:
    """A controller made of a function of the observation."""

    def __init__(self, decide: Callable[[Observation], Any]) -> None:
        self.answer = decide
        self.asked: list[tuple[int, int]] = []

    def decide(self, observation: Observation, memory: Any) -> Decision:
        self.asked.append((observation.index, round(observation.time / observation.dt)))
        answer: Decision = self.answer(observation)
        return answer


def check_error(told: str, place: str, *parts: str) -> None:
    """An error of one line that begins with its place and says each of the parts, whole.

    A part is a key, what was given, or what is allowed; not how the sentence puts it.
    """
    assert told.endswith("\n")
    assert told.count("\n") == 1, told
    assert "Traceback" not in told
    after = "" if place.endswith(":") else r"(?![\w.])"
    assert re.match(re.escape(place) + after, told), told
    for part in parts:
        whole = rf"(?<![\w.-]){re.escape(part)}(?![\w-]|\.\d)"
        assert re.search(whole, told), f"{part} is not said: {told}"
