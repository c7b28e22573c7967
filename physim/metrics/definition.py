"""What a metric is (`Definition`), and what it is for one run (`Metric`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from physim.metrics.values import Each, Moment, Place

if TYPE_CHECKING:
    from physim.metrics.registry import Courses

Found = bool | int | float | Moment | Place | Each | None
"""What finding a metric gives; None where it has no meaning."""


@dataclass(frozen=True)
class Definition:
    """What a metric is."""

    name: str
    unit: str
    """"-" for shares and counts"""
    meaning: str
    source: str
    """equation or figure of the paper; "-" for none"""
    find: Callable[[Courses], Found]


@dataclass(frozen=True)
class Metric:
    """A metric of one run."""

    definition: Definition
    value: bool | int | float
    time: float | None = None
    """[s] when the value was taken, where it was at a moment"""
    station: float | None = None
    """[m] along the path of the robot, where the value belongs to a place"""
    bodies: tuple[int, ...] = ()
    """ids of the bodies that the value belongs to"""
    robots: tuple[float | None, ...] | None = None
    """value of each robot by index, where each has one; None where it has no meaning for it"""

    @property
    def name(self) -> str:
        """Name in the registry."""
        return self.definition.name

    @property
    def unit(self) -> str:
        """Unit of the value."""
        return self.definition.unit
