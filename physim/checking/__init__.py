"""Check worlds before running them: all errors and warnings with their places, and room."""

from physim.checking.check import check_world
from physim.checking.clearance import ClearanceProfile, Stretch
from physim.checking.findings import Finding, Findings

__all__ = ["ClearanceProfile", "Finding", "Findings", "Stretch", "check_world"]
