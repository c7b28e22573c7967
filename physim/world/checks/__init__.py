"""Check worlds before running them: all errors and warnings with their places, and room."""

from physim.world.checks.check import check_world
from physim.world.checks.findings import Finding, Findings
from physim.world.checks.room import ClearanceProfile

__all__ = ["ClearanceProfile", "Finding", "Findings", "check_world"]
