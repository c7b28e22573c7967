"""Crash test: a laboratory that must end in contacts, engine against analysis.

Random shapes are thrown at each other at constant (v, omega) through the physics that runs every
world; the first physical contact of each throw must lie in the sample that the collision time
says, or the analytic contact holds no sample. See docs/CRASHTEST.md.
"""

from __future__ import annotations

from physim.crashtest.laboratory import crash_test
from physim.crashtest.report import Report, Unexplained

__all__ = ["Report", "Unexplained", "crash_test"]
