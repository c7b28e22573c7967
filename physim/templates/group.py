"""Robots in lanes, as many abreast as the road is wide enough for, and where they start."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from physim.templates.roads import LONGEST, ROADS, Road

LANE = 2.0
"""[m] from one lane to the next: robots 1 m wide pass at 1 m, above the distance at which the
controller's danger mode begins and ends"""
EDGE = 1.3
"""[m] from the middle of an outer lane to the wall at least: the danger area and some more"""
ROW, FILE_ROW = 4.0, 3.0
"""[m] from one robot to the next in a lane; where there is one lane only"""
BACK, FRONT = 1.0, 4.0
"""[m] from the beginning of the straight stretch to the last robot, from the first to its end"""

FOOTPRINTS = (
    "{length: 1.8, width: 1.0}",
    "{length: 1.5, width: 0.9}",
    "[[0.9, 0.0], [0.4, 0.5], [-0.8, 0.5], [-0.8, -0.5], [0.4, -0.5]]",
)
"""Taken in turn"""


@dataclass(frozen=True)
class Place:
    """Where one robot starts: x [m] along the straight stretch, and its lane's offset [m]."""

    x: float
    offset: float
    footprint: str


def lanes_of(width: float) -> int:
    """Lanes that a road of that width [m] has room for, at least one."""
    return max(1, 1 + int((width - 2.0 * EDGE) / LANE + 1e-9))


def lane_offsets(lanes: int) -> list[float]:
    """Offsets [m] of lanes abreast, left positive, in the order in which robots take them.

    From the middle outwards, left before right.
    """
    offsets = [LANE * (k - 0.5 * (lanes - 1)) for k in range(lanes)]
    return sorted(offsets, key=lambda offset: (abs(offset), -offset))


def places(width: float, robots: int) -> list[Place]:
    """Starts of a group in lanes that fit into a width [m], the first robot foremost.

    The last one stands at x = `BACK`. Neighbours stand staggered, so that each has one robot beside
    it at a time. Small groups take fewer lanes.
    """
    lanes = min(lanes_of(width), ceil(robots / 2))
    offsets = lane_offsets(lanes)
    apart = (ROW if lanes > 1 else FILE_ROW) / lanes
    return [
        Place(
            round(BACK + apart * (robots - 1 - i), 2),
            offsets[i % lanes],
            FOOTPRINTS[i % len(FOOTPRINTS)],
        )
        for i in range(robots)
    ]


def fitted(template: str, robots: int) -> tuple[Road, list[Place]]:
    """Road of a template, as long as the group needs, and where that starts.

    Raises ValueError for more robots than its longest straight stretch holds.
    """
    make = ROADS[template]
    found = places(make(LONGEST).narrowest, robots)
    straight = found[0].x + FRONT
    if straight > LONGEST:
        raise ValueError(f"{robots} robots do not fit; {most_robots(template)} do")
    return make(straight), found


def most_robots(template: str) -> int:
    """Largest group that a template has room for."""
    width, robots = ROADS[template](LONGEST).narrowest, 1
    while places(width, robots + 1)[0].x + FRONT <= LONGEST:
        robots += 1
    return robots
