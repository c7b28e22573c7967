"""A disagreement of two sources about a pair of bodies, and the causes that it may have."""

from __future__ import annotations

from dataclasses import dataclass

from physim.record import Record

TOLERANCE = "within tolerance"
GRAZE = "graze between samples"
REJECTED = "rejected false contact of the engine"
UNEXPLAINED = "unexplained"

ROUNDING = 1e-12
"""[m] Two ways to compute one distance differ by less, up to 10 km from the origin."""

DEPTH_SLACK = 1e-9
"""[m] How well a recorded depth or distance must agree with the one computed here."""


@dataclass(frozen=True)
class Disagreement:
    """A stretch of consecutive samples over which two sources disagree about a pair."""

    a: int
    b: int | None
    """body ids; None where one body is concerned"""
    step: int
    """first sample"""
    steps: int
    """number of samples"""
    time: float
    """[s] of the first sample; of a swept contact, of its first touch"""
    distance: float
    """[m] signed, at the first sample, from the poses; of a swept contact the least between its
    samples; NaN where no distance is in question"""
    cause: str
    what: str
    """what each of the two says"""

    @classmethod
    def at(
        cls,
        record: Record,
        pair: tuple[int, int | None],
        step: int,
        distance: float,
        what: str,
        *,
        steps: int = 1,
        cause: str = UNEXPLAINED,
    ) -> Disagreement:
        """One that begins at a sample of a record, without a cause unless one is given."""
        return cls(*pair, int(step), steps, float(step * record.dt), float(distance), cause, what)
