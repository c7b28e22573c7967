"""What a disagreement of two ledgers is, and the causes that it may have."""

from __future__ import annotations

from dataclasses import dataclass

TOLERANCE = "within tolerance"
GRAZE = "graze between samples"
REJECTED = "rejected false contact of the engine"
UNEXPLAINED = "unexplained"

ROUNDING = 1e-12
"""[m] Two ways to work out one distance differ by less, up to 10 km from the origin."""

DEPTH_SLACK = 1e-9
"""[m] How well a recorded depth or distance must agree with the one worked out here."""


@dataclass(frozen=True)
class Disagreement:
    """A stretch of consecutive samples over which two ledgers disagree about a pair."""

    a: int
    b: int | None
    """body ids; None where one body is concerned"""
    step: int
    """first sample"""
    steps: int
    """number of samples"""
    time: float
    """[s] of the first sample; of a graze, of its first touch"""
    distance: float
    """[m] signed, at the first sample, from the poses; of a graze the least between its samples;
    NaN where no distance is in question"""
    cause: str
    what: str
    """what each of the two says"""
