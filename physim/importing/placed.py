"""A robot as it goes into the world, and whether robots stop too near each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from physim.geometry.shapes import FloatArray
from physim.importing.fit import Fit
from physim.importing.lanes import lane
from physim.importing.stops import WAITING, corners_of, least_stop_gap


@dataclass(frozen=True)
class Placed:
    """One robot of the world: footprint in its own frame, a (length, width) or outline (n, 2)."""

    name: str
    footprint: tuple[float, float] | FloatArray
    pose: tuple[float, float, float]
    path: float | FloatArray
    """offset [m] from the reference path, or points (n, 2)"""


def told_stops(found: Fit, robots: Sequence[Placed], area: Any) -> list[str]:
    """Say which two robots stop so near each other that they may wait for ever; else nothing."""
    lines = [
        lane(found.reference, one.path, area, found.room, found.size).line
        if isinstance(one.path, float)
        else one.path
        for one in robots
    ]
    poses, outlines = [one.pose for one in robots], [corners_of(one.footprint) for one in robots]
    gap, i, j = least_stop_gap(found.reference, lines, poses, outlines, found.size)
    if gap >= WAITING * found.size:
        return []
    return [
        f"mind: {robots[i].name} and {robots[j].name} stop {gap:.2f} m from each other at the end "
        "of the path, and may wait for each other and never arrive; another end of the path "
        "(--to), fewer --robots or --lanes 1"
    ]
