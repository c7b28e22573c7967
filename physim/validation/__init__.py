"""Validation of a run from its record alone: do the analytic checks and the physics agree?"""

from __future__ import annotations

from physim.compiled import is_cached
from physim.validation.near_misses import decision_times
from physim.validation.report import report, warning_lines
from physim.validation.validation import Validation, validate


def is_warm() -> bool:
    """Whether the kernels of a validation lie compiled on disk; the last one stands for all."""
    return is_cached(decision_times)


__all__ = ["Validation", "is_warm", "report", "validate", "warning_lines"]
