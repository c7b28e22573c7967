"""Validation of a run from its record alone: do the analytic checks and the physics agree?"""

from __future__ import annotations

from physim.validation.report import report
from physim.validation.validation import Validation, validate

__all__ = ["Validation", "report", "validate"]
