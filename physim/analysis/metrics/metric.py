"""What a metric is (`Definition`), what it is for one run (`Metric`), and what it may give."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from physim.errors import Fault, WorldError
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.record.checks import reading_world

if TYPE_CHECKING:
    from physim.analysis.metrics.figures import Figures
    from physim.world.base import Model

    Section = TypeVar("Section", bound=Model)


@dataclass(frozen=True)
class Moment:
    """An extreme value, when it was taken and by whom."""

    value: float
    """in the unit of what it is a moment of"""
    step: int
    time: float
    """[s]"""
    a: int
    """body id"""
    b: int | None = None
    """body id, where the value belongs to two bodies"""

    @classmethod
    def at(cls, record: Record, value: Any, step: Any, a: Any, b: Any = None) -> Moment:
        """A value at a step of a run, all of them numbers of numpy or Python."""
        step = int(step)
        return cls(float(value), step, step * record.dt, int(a), None if b is None else int(b))

    @property
    def bodies(self) -> tuple[int, ...]:
        """Ids of the bodies that the value belongs to."""
        return (self.a,) if self.b is None else (self.a, self.b)


@dataclass(frozen=True)
class Each:
    """A figure of all robots together, and of each."""

    value: float
    robots: tuple[float | None, ...]
    """by index; None where it has no meaning for that robot"""


@dataclass(frozen=True)
class Place:
    """A value at a station of a robot's path."""

    value: float
    """[m]"""
    station: float
    """[m] along the path"""
    robot: int


class Series(NamedTuple):
    """A figure over time."""

    time: FloatArray
    """(K,) [s]"""
    values: FloatArray
    """(K, N), a column a robot, or (K,); NaN where there is no value"""


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
    find: Callable[[Figures], Found]


@dataclass(frozen=True)
class Metric:
    """A metric of one run."""

    name: str
    unit: str
    value: bool | int | float
    time: float | None = None
    """[s] when the value was taken, where it was at a moment"""
    station: float | None = None
    """[m] along the path of the robot, where the value belongs to a place"""
    bodies: tuple[int, ...] = ()
    """ids of the bodies that the value belongs to"""
    robots: tuple[float | None, ...] | None = None
    """value of each robot by index, where each has one; None where it has no meaning for it"""

    @classmethod
    def of(cls, definition: Definition, run: Figures) -> Metric | None:
        """Take a metric of a run; None where it has no meaning."""
        found, (name, unit) = definition.find(run), (definition.name, definition.unit)
        match found:
            case None:
                return None
            case Moment():
                return cls(name, unit, found.value, time=found.time, bodies=found.bodies)
            case Place():
                return cls(name, unit, found.value, station=found.station, bodies=(found.robot,))
            case Each():
                return cls(name, unit, found.value, robots=found.robots)
            case _:
                return cls(name, unit, found)


def section(record: Record, key: str, model: type[Section]) -> Section | None:
    """A part of the world inside a record by its model, ``arrival``, say; None where it has none.

    The rest of that world need not be valid. Raises RecordError where this part is not.
    """
    given = record.world_settings.get(key)
    if given is None:
        return None
    with reading_world(record.where):
        if not isinstance(given, Mapping):
            raise WorldError([Fault((key,), "must be a mapping of keys to values")])
        try:
            return model(**given)
        except WorldError as error:
            faults = [replace(one, location=(key, *one.location)) for one in error.faults]
            raise WorldError(faults) from None
