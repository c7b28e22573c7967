"""Room ahead of the robots at their stops, against the thresholds of the controller.

Each is looked at where it is to stop: on its path at its stop station, heading along the path. What
lies ahead is what its footprint would meet going straight on. Where that is nearer than the
controller lets it come outside danger mode, the robot may never arrive. A wall counts from
`boundary_low` on: one that is farther is no danger to a robot that stands before it. Another robot
counts from the collision time on, too, since nobody knows that it will stay where it stands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from physim.errors import Location, plural
from physim.geometry.outline import placed_outline
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world.checks.findings import Diagnostics
from physim.world.checks.standing import Stop
from physim.world.faults import describe
from physim.world.scene import Layout
from physim.world.walls import stretch_text

SLENDER = 0.98
"""[-] of its width a robot must have ahead of it: what it passes at its side is not ahead"""

MOST_PAIRS = 5_000
"""Pairs of robots at their stops that are looked at: of a crowd that stops in one place, some."""


@dataclass(frozen=True)
class StopLimits:
    """What the controller keeps ahead of a robot; None where it has no such setting."""

    speed: float | None
    """[m/s] without a formation"""
    time_low: float | None
    """[s]"""
    boundary_low: float | None
    """[m]"""
    distance_low: float | None
    """[m]"""


def check_tolerance(laid: Layout, found: Diagnostics) -> None:
    """Warn of a tolerance of arrival of more than half a robot's length: it would count as arrived
    well before it stands at its stop station."""
    lengths = {k: float(np.ptp(np.asarray(one)[:, 0])) for k, one in enumerate(laid.footprints)}
    if not lengths or any(fault.location[-1:] == ("footprint",) for fault in found.warnings):
        return  # what is out of scale is told first
    number, length = min(lengths.items(), key=lambda one: one[1])
    allowed = laid.world.arrival.tolerance
    if allowed > 0.5 * length:
        found.warn(
            ("arrival", "tolerance"),
            f"is {allowed:g} m, more than half the length of {describe(laid.names[number])} "
            f"({length:.3g} m), which counts as arrived that far before its stop; lower it, and "
            "with it the arrival_tolerance of a controller that has one",
        )


def check_stops(laid: Layout, at: list[Stop], limits: StopLimits, found: Diagnostics) -> None:
    """Warn of walls, and of other robots at their stops, too near ahead of where robots stop."""
    if limits.time_low is None or limits.boundary_low is None:
        return
    if any(fault.location[-1:] in (("footprint",), ("v",)) for fault in found.warnings):
        return  # what is out of scale is told first: the rest follows from it
    plan = laid.world.formation
    speed = (limits.speed or 1.0) if plan is None else plan.speed
    if not at:
        return
    fastest = {one.number: min(speed, laid.world.robots[one.number].limits.v) for one in at}
    expect = laid.world.expect
    told = any(fault.location == ("controller", "boundary_low") for fault in found.warnings)
    if not told and (expect is None or expect.finished is not False):
        _check_walls(laid, at, dict.fromkeys(fastest, limits.boundary_low), found)
    needed = {i: max(v * limits.time_low, limits.distance_low or 0.0) for i, v in fastest.items()}
    _check_robots(laid, at, needed, found)


def _way_on(stop: Stop, outline: FloatArray, length: float) -> Any:
    """The rectangle [m] ahead of a robot at its stop, as wide as the robot and ``length`` long.

    It begins in the middle of the footprint, wherever that lies to the reference point.
    """
    (back, right), (front, left) = outline.min(axis=0), outline.max(axis=0)
    x, y, half = 0.5 * (back + front), 0.5 * (right + left), 0.5 * SLENDER * (left - right)
    far = front + length
    ahead = np.array([(x, y - half), (far, y - half), (far, y + half), (x, y + half)])
    return placed_outline(ahead, stop.pose)


def _half_length(outline: FloatArray) -> float:
    return 0.5 * float(np.ptp(outline[:, 0]))


def _ahead(stop: Stop, shape: Any) -> float:
    """How far [m] ahead of the robot's foremost point the nearest point of a shape lies."""
    x, y, heading = stop.pose
    points = shapely.get_coordinates(shape) - (x, y)
    return float((points @ (np.cos(heading), np.sin(heading))).min()) - stop.reach


def _is_beside(stop: Stop, met: Any) -> bool:
    """Whether what is met of a wall lies along the way, rather than across it."""
    c, s = np.cos(stop.pose[2]), np.sin(stop.pose[2])
    along, across = np.ptp(shapely.get_coordinates(met) @ [[c, -s], [s, c]], axis=0)
    return bool(along > across)


def _check_walls(
    laid: Layout, at: list[Stop], needed: dict[int, float], found: Diagnostics
) -> None:
    named = [*laid.walls, *laid.solids]
    shapes = [shape for _, shape in named]
    if not shapes:
        return
    tree = shapely.STRtree(shapes)
    near: list[tuple[float, Stop, int]] = []
    for stop in at:
        way = _way_on(stop, laid.footprints[stop.number], needed[stop.number])
        met = [
            (_ahead(stop, shapes[k].intersection(way)), k)
            for k in tree.query(way, predicate="intersects").tolist()
        ]
        if met and min(met)[0] < needed[stop.number] - LENGTH:
            near.append((min(met)[0], stop, min(met)[1]))
    if not near:
        return
    gap, stop, k = max(near, key=lambda one: needed[one[1].number] - one[0])
    wall, way = named[k][0], _way_on(stop, laid.footprints[stop.number], needed[stop.number])
    met = shapes[k].intersection(way)
    foot = shapely.get_coordinates(shapely.shortest_line(met, stop.outline))
    place = stretch_text(laid.world.boundaries, wall, foot[0])
    least, mends = needed[stop.number], "end its path earlier, or move the wall"
    where: Location = laid.path_key(stop.number)
    corridor = laid.world.corridor
    side = "before"
    if gap <= 0.0 and _is_beside(stop, met):
        side, mends = "beside", "lead its path farther from the wall"
    elif corridor is not None and laid.world.boundaries is None and wall in dict(laid.walls):
        where = ("corridor", "end_margin")
        wanted = np.ceil((corridor.end_margin + least - gap) * 100.0) / 100.0
        mends = f"set end_margin to {wanted:g} m or more"
    others = f", and {plural(len(near) - 1, 'more robot')} stop so" if len(near) > 1 else ""
    found.warn(
        where,
        f"{describe(laid.names[stop.number])} stops {max(gap, 0.0):.4g} m {side} {wall} {place}"
        f"{others}; nearer than {least:.4g} m (controller.boundary_low) it is in danger mode there "
        f"and may never arrive; {mends}, or lower boundary_low",
    )


def _check_robots(
    laid: Layout, at: list[Stop], needed: dict[int, float], found: Diagnostics
) -> None:
    """Warn of robots that come to their stops behind others that may stand at theirs already."""
    outlines = [stop.outline for stop in at]
    tree = shapely.STRtree(outlines)
    near: list[tuple[float, Stop, Stop]] = []
    looked_at = 0
    for stop in at:
        if looked_at > MOST_PAIRS:
            break
        way = _way_on(stop, laid.footprints[stop.number], needed[stop.number])
        for k in tree.query(way, predicate="intersects").tolist():
            looked_at += 1
            if at[k] is stop or looked_at > MOST_PAIRS:
                continue
            gap = _ahead(stop, outlines[k].intersection(way))
            behind = LENGTH - _half_length(laid.footprints[stop.number])
            if behind < gap < needed[stop.number] - LENGTH:
                near.append((gap, stop, at[k]))
    if not near:
        return
    gap, stop, other = min(near, key=lambda one: one[0])
    least = needed[stop.number]
    others = f", as {plural(len(near) - 1, 'more pair')} do" if len(near) > 1 else ""
    found.warn(
        laid.path_key(stop.number),
        f"{describe(laid.names[stop.number])} stops {max(gap, 0.0):.4g} m behind "
        f"{describe(laid.names[other.number])}{others}; nearer than {least:.4g} m (speed x "
        "controller.time_low, or distance_low) to a robot that stands there it is in danger mode "
        "and may never arrive; start them farther apart, end its path earlier, or lower time_low",
    )
