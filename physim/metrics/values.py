"""What a figure of a run can be: a moment, shares of robots, a course over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from physim.geometry.shapes import FloatArray


@dataclass(frozen=True)
class Moment:
    """An extreme value, when it was taken and by whom."""

    value: float
    """[m] or [s]"""
    step: int
    time: float
    """[s]"""
    a: int
    """body id"""
    b: int | None = None
    """body id, where the value belongs to two bodies"""


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


@dataclass(frozen=True)
class DangerShare:
    """How much of its active time a robot was in danger mode (Fig. 8); None without decisions."""

    robot: int
    decisions: float | None
    """[-] share of its decisions"""
    time: float | None
    """[-] share of its time: each decision weighs as long as it held"""


class Series(NamedTuple):
    """A figure over time."""

    time: FloatArray
    """(K,) [s]"""
    values: FloatArray
    """(K, N), a column a robot, or (K,); NaN where there is no value"""
