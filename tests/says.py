"""A controller made of a function, for runs of `tests.roads`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from physim.control import Decision, Observation

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
