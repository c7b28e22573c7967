"""What a metric is (`Definition`), and what it is for one run (`Metric`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from physim.metrics.formation import formation_energy
from physim.metrics.motion import AveragedSpeeds, averaged_speeds
from physim.metrics.values import Each, Moment, Place, Series
from physim.metrics.width import Width, corridor_width
from physim.record import Record

Found = bool | int | float | Moment | Place | Each | None
"""What finding a metric gives; None where it has no meaning."""


class Courses:
    """A record with the courses over time that several metrics share, each worked out once."""

    def __init__(self, record: Record) -> None:
        self.record = record

    @cached_property
    def averaged(self) -> AveragedSpeeds:
        """Speeds averaged over 10 s."""
        return averaged_speeds(self.record)

    @cached_property
    def energy(self) -> Series | None:
        """Formation energy W."""
        return formation_energy(self.record)

    @cached_property
    def width(self) -> Width | None:
        """Width along the first robot's path."""
        return corridor_width(self.record) if self.record.robots else None


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
