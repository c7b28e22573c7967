"""Judge poses that no run of physim made: a log of real robots, or of another simulator."""

from __future__ import annotations

from physim.judging.judge import judge
from physim.judging.steps import MAYBE_DEGREES

__all__ = ["MAYBE_DEGREES", "judge"]
