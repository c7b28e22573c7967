"""Crash test: random cases that mostly end in contact, physics engine against analysis.

Random shapes are driven into each other at constant (v, omega) by the physics that runs every
world; the first physical contact of each case must lie in the sample that the collision time
predicts, or the analytic contact holds no sample. See "The crash test" in the documentation.
"""

from __future__ import annotations

from physim.analysis.crashtest.experiment import crash_test
from physim.analysis.crashtest.report import CrashReport, Unexplained

__all__ = ["CrashReport", "Unexplained", "crash_test"]
