"""A stage of any kind, made of a function."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Changes:
    """Senses, filters or disturbs by a function of what it is given; remembers nothing."""

    def __init__(self, change: Callable[[Any], Any]) -> None:
        self.change = change

    def start(self, scene: Any) -> None:
        return None

    def sense(self, scene: Any, truth: Any, sensed: Any, state: Any) -> Any:
        return self.change(sensed), state

    def filter(self, scene: Any, sensed: Any, nominal: Any, state: Any) -> Any:
        return self.change(nominal), state

    def disturb(self, scene: Any, truth: Any, filtered: Any, state: Any) -> Any:
        return self.change(filtered), state
