"""Where robots are to stop: on their paths at their stop stations, heading along the path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from physim.geometry.outline import placed_outline
from physim.geometry.path import Path, project
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world.checks.way import Way
from physim.world.layout.shared import Shared, sharing
from physim.world.scene import Layout


@dataclass(frozen=True)
class Stop:
    """Where a robot is to stop."""

    number: int
    """of the robot, from 0"""
    station: float
    """[m] along its path"""
    pose: FloatArray
    """(3,) [m, m, rad]"""
    outline: Any
    """its footprint there, as a shapely polygon in the world frame"""
    reach: float
    """[m] how far its footprint reaches before the reference point"""


def stops(laid: Layout) -> list[Stop]:
    """Where the robots are to stop, as `physim.world.layout.scene_builder` has it.

    Empty where some robot's footprint, path or start is not known.
    """
    way, found = Shared(Way), []
    for i, station in stop_stations(laid).items():
        path = way(laid.paths[i])
        (place,), _ = path.at(np.array([station]))
        _, ((dx, dy),) = path.at(np.array([station - LENGTH]))  # as it comes, at a waypoint too
        pose = np.array([*place, np.arctan2(dy, dx)])
        outline = laid.footprints[i]
        shape = placed_outline(outline, pose)
        found.append(Stop(i, station, pose, shape, float(outline[:, 0].max())))
    return found


def stop_stations(laid: Layout) -> dict[int, float]:
    """Stations [m] at which robots are to stop, by number; empty where these are not known."""
    lead = leads(laid)
    if lead is None:
        return {}
    length = Shared(lambda path: float(shapely.LineString(path).length))
    behind = lead.max(initial=0.0) - lead
    return {i: max(length(path) - float(behind[i]), 0.0) for i, path in enumerate(laid.paths)}


def reached(laid: Layout) -> dict[int, tuple[float, float]]:
    """First and last station [m] of its path at which each robot is to be, by number.

    From the point nearest to its start to its stop station; where one of them is not known, from
    the last that its region has, or the beginning, or to the end of the path.
    """
    way, stop = Shared(Way), stop_stations(laid)
    start: dict[int, float] = {}
    for group in sharing(laid.paths):
        stations = way(laid.paths[group[0]]).nearest(laid.start[group, :2])
        start.update(zip(group, stations.tolist(), strict=True))
    ends = {i: stop.get(i, float(way(path).station[-1])) for i, path in enumerate(laid.paths)}
    return {i: (min(start[i], ends[i]), ends[i]) for i in range(len(laid.paths))}


def leads(laid: Layout) -> FloatArray | None:
    """Leads (N,) [m] in the formation; None where they are not known."""
    plan, count = laid.world.formation, len(laid.world.robots)
    if plan is None:
        return np.zeros(count)
    if plan.spacing != "initial":
        spacing = plan.spacing
        is_whole = isinstance(spacing, tuple) and len(spacing) == count
        return np.array(spacing) if is_whole and None not in spacing else None
    path = Path(laid.reference)
    return np.array([
        project(path.lines, 0, float(x), float(y), 0.0, path.length)[0] for x, y, _ in laid.start
    ])  # fmt: skip
