"""Validation of a run from its record alone: do the analytic checks and the physics agree?"""

from __future__ import annotations

from physim.analysis.validation.near_misses import decision_times
from physim.analysis.validation.report import report, warning_lines
from physim.analysis.validation.validation import Validation, judge, validate
from physim.compiled import is_cached


def is_warm() -> bool:
    """Whether the kernels of a validation lie compiled on disk; the last one stands for all."""
    return is_cached(decision_times)


__all__ = ["Validation", "is_warm", "judge", "report", "validate", "warning_lines"]
