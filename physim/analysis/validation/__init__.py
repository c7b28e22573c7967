"""Validation of a run from its record alone: do the analytic checks and the physics agree?"""

from physim.analysis.validation.report import report, warning_lines
from physim.analysis.validation.validation import Validation, judge, validate

__all__ = ["Validation", "judge", "report", "validate", "warning_lines"]
