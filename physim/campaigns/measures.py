"""Columns that reports sum up and comparisons test: names, units, and which values are better."""

from __future__ import annotations

from types import MappingProxyType
from typing import NamedTuple

from physim.campaigns.rows import title_of
from physim.statistics import RATES


class Measure(NamedTuple):
    """What a column of numbers is."""

    title: str
    unit: str
    """``%``: shares from 0 to 1, written as percentages"""
    better: int
    """1 where more is better, -1 where less is, 0 where neither is"""

    @property
    def label(self) -> str:
        """``least distance [m]``."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title


MEASURES = MappingProxyType(
    {
        "least_distance": Measure("least distance", "m", 1),
        "shortest_distance": Measure("shortest distance of robots", "m", 1),
        "shortest_boundary_distance": Measure("shortest distance to a wall", "m", 1),
        "closing_speed": Measure("closing speed of contacts", "m/s", -1),
        "energy_lost": Measure("energy lost in contacts", "J", -1),
        "impulse": Measure("impulse of contacts", "N s", -1),
        "shortest_collision_time": Measure("least collision time", "s", 1),
        "shortest_pair_collision_time": Measure("least collision time of two robots", "s", 1),
        "time_to_finish": Measure("finish time", "s", -1),
        "deviation_peak": Measure("largest deviation", "m", -1),
        "formation_error_peak": Measure("largest formation error", "m", -1),
        "danger_share": Measure("in danger modes", "%", -1),
        "decisions": Measure("decisions", "", 0),
        "messages": Measure("messages", "", -1),
        "cpu_seconds": Measure("processor time", "s", -1),
    }
)
RATE_TITLES = MappingProxyType(
    {"rate": "contact-free and finished", "contact_free": "contact-free", "finished": "finished"}
)
NEAREST, SEVERITY = "least_distance", ("closing_speed", "energy_lost", "impulse")
"""By which runs are ranked: the worst contact of a run first, then how near anything came"""
TOLD = (NEAREST, "closing_speed", "time_to_finish", "deviation_peak", "formation_error_peak")
"""What the terminal tells; pages and values have all"""
DIRECTIONS = MappingProxyType(
    dict.fromkeys(RATES, 1) | {name: one.better for name, one in MEASURES.items() if one.better}
)
"""What can be compared: 1 where more is better, -1 where less is"""
USUAL = MappingProxyType(
    {
        name: DIRECTIONS[name]
        for name in (*RATES, NEAREST, "time_to_finish", "deviation_peak", "formation_error_peak")
    }
)
"""What is compared where nothing else is asked for"""


def measure_of(column: str) -> Measure:
    """What a rate, a column of numbers or a metric of one's own is."""
    if column in RATE_TITLES:
        return Measure(RATE_TITLES[column], "%", 1)
    return MEASURES[column] if column in MEASURES else Measure(*title_of(column), 0)
