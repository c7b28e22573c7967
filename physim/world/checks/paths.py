"""Paths: inside the accessible area, with room for the robot, in order, and long enough."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import shapely
from shapely.ops import substring

from physim.errors import Fault, Location, place_text, plural
from physim.geometry.path import SHARPEST_TURN
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT, LENGTH
from physim.units import figure
from physim.world import Offset
from physim.world.checks.room import NOT, ClearanceProfile
from physim.world.checks.stations import lines_of
from physim.world.faults import describe
from physim.world.ground.area import NEAR_EDGE, united
from physim.world.ground.corridor import offset_polyline
from physim.world.scene import Layout
from physim.world.walls import stretch_text

SHORTEST = 1.0
"""[m] A path or reference path shorter than this is hardly meant."""
JOINED = 1.0
"""[m] A path whose ends are nearer than this is closed: it may run either way."""


def check_paths(laid: Layout) -> Iterator[Fault]:
    """Every path lies inside the accessible area, and in the sense of the reference path."""
    told: set[Location] = set()
    reference = shapely.LineString(laid.reference)
    for i, line in enumerate(lines_of(laid)):
        where, name = laid.path_key(i), describe(laid.names[i])
        if where in told:
            continue  # the path of others of the group
        told.add(where)
        yield from _outside(laid, i, line)
        if line.intersects(laid.area.inner):
            met = shapely.points(shapely.get_coordinates(line.intersection(laid.area.inner)))
            stations = shapely.line_locate_point(line, met)
            k = int(np.argmin(stations))
            wall = min(laid.walls, key=lambda one: float(one[1].distance(met[k])))[0]
            more = f" and at {plural(len(met) - 1, 'more place')}" if len(met) > 1 else ""
            yield Fault(
                where,
                f"the path of {name} leads through {wall} at {place_text(met[k].x, met[k].y)}, "
                f"{stations[k]:.2f} m along it{more}; the robot will have to find a way around "
                "it; lead the path around it",
                "warning",
            )
        if isinstance(path := laid.robots[i].path, Offset):
            yield from _folds(laid, i, path.offset)
        else:
            yield from _against(laid, i, line, reference)
            yield from _turns(laid.paths[i], where, f"the path of {name}")


def _outside(laid: Layout, i: int, line: Any) -> Iterator[Fault]:
    """What of a path lies outside the area; through an obstacle it may lead, around it."""
    outside = laid.area.outside_stretches(laid.paths[i])
    if not len(outside):
        return
    first, last = outside[0]
    left = len(outside) - 1
    more = f" and on {plural(left, 'more stretch', 'more stretches')}" if left else ""
    place = f"from {first:.2f} m to {last:.2f} m along it{more}"
    edge = first + NEAR_EDGE if first > 0.0 else last - NEAR_EDGE  # where it goes out, or comes in
    met = [name for name, solid in laid.solids if solid.covers(line.interpolate(edge))]
    stretch = substring(line, first, last)
    solids = united([one for _, one in laid.solids if one.intersects(stretch)])
    path = f"the path of {describe(laid.names[i])}"
    if not met:
        said = f"{path} leaves the accessible area {place}; keep it between the boundaries"
        yield Fault(laid.path_key(i), said)
    elif stretch.difference(solids).length > LENGTH:
        yield Fault(
            laid.path_key(i),
            f"{path} leaves the accessible area {place}: {met[0]} cuts off what lies beyond it; "
            "make it smaller or move it, or let the path end there",
        )
    else:
        yield Fault(
            laid.path_key(i),
            f"{path} leads through {met[0]} {place}; the robot will have to find a way around it; "
            "lead the path around it",
            "warning",
        )


def _folds(laid: Layout, i: int, offset: float) -> Iterator[Fault]:
    """Of a path beside the reference path that runs backwards in a tight bend."""
    beside = offset_polyline(laid.reference, np.full(len(laid.reference), offset))
    legs = np.diff(laid.reference, axis=0)
    along = (np.diff(beside, axis=0) * legs).sum(axis=1)
    turned = along < -LENGTH * np.hypot(*legs.T)  # one that vanishes is no part of the path
    if turned.any():
        x, y = beside[int(np.argmax(turned))]
        yield Fault(
            laid.path_key(i),
            f"{offset:g} m to the side, the path of {describe(laid.names[i])} runs backwards near "
            f"{place_text(x, y)}, where the reference path bends more tightly than that; use a "
            "smaller offset, or waypoints of its own",
            "warning",
        )


def _against(laid: Layout, i: int, line: Any, reference: Any) -> Iterator[Fault]:
    """Of an own path that is very short, or goes against the reference path.

    Without a formation, which measures on that, it may go any way: then it is told of a robot that
    starts near the end.
    """
    name = describe(laid.names[i])
    if line.length < SHORTEST:
        said = f"the path of {name} is only {line.length:.4g} m long; lengths are in metres"
        yield Fault(laid.path_key(i), said, "warning")
    ends = shapely.get_coordinates(line)[[0, -1]]
    first, last = (reference.project(shapely.Point(end)) for end in ends)
    is_begun = line.project(shapely.Point(laid.start[i, :2])) < 0.5 * line.length
    is_meant = laid.world.formation is None and is_begun
    if last < first - LENGTH and np.hypot(*(ends[0] - ends[1])) >= JOINED and not is_meant:
        yield Fault(
            laid.path_key(i),
            f"the path of {name} runs against the reference path, from station {first:.2f} m back "
            f"to {last:.2f} m; are the waypoints in order?",
            "warning",
        )


def check_reference(laid: Layout) -> Iterator[Fault]:
    """The reference path goes forward and does not pass through itself."""
    line, where = shapely.LineString(laid.reference), laid.reference_key
    if where[0] != "corridor":  # whose walls cannot be drawn there
        yield from _turns(laid.reference, where, "the reference path")
        if not line.is_simple:
            yield Fault(
                where,
                "the reference path crosses or touches itself; a robot near that place may be "
                "projected onto the wrong branch",
                "warning",
            )
    if line.length < SHORTEST:
        said = f"the reference path is only {line.length:.4g} m long; lengths are in metres"
        yield Fault(where, said, "warning")


def _turns(line: FloatArray, where: Location, called: str) -> Iterator[Fault]:
    """Of the first place where a path turns back on itself."""
    steps = np.diff(line, axis=0)
    steps /= np.hypot(*steps.T)[:, None]
    turn = np.arccos(np.clip((steps[:-1] * steps[1:]).sum(axis=1), -1.0, 1.0))
    back = np.flatnonzero(turn > SHARPEST_TURN)
    if len(back):
        k = int(back[0])
        more = f" and at {plural(len(back) - 1, 'more place')}" if len(back) > 1 else ""
        yield Fault(
            where,
            f"{called} turns back by {np.degrees(turn[k]):.0f} degrees at "
            f"{place_text(*line[k + 1])}{more}, where a robot may stand for ever; are the "
            "waypoints in order?",
            "warning",
        )


def check_room(
    laid: Layout, profiles: Iterable[ClearanceProfile], told: Iterable[Fault]
) -> Iterator[Fault]:
    """Paths on which the robot fits at no heading; no way from start to stop, whatever it takes.

    There is none where the area less a margin of the inscribed radius falls apart between the two.
    What ``told`` says of a path is not said again.
    """
    told = tuple(told)
    known = {fault.location for fault in told}
    faulty = {fault.location[:2] for fault in told if fault.severity == "error"}
    together: dict[tuple[float, ...], list[ClearanceProfile]] = {}
    parts: dict[float, Any] = {}
    for profile in profiles:
        i, r = profile.number, profile.inscribed
        is_told = laid.path_key(i) in known and profile.narrowest[3] <= CONTACT
        if profile.verdict == NOT and not is_told:
            together.setdefault(profile.narrowest, []).append(profile)
        if laid.entry_key(i) in faulty:
            continue
        if r not in parts:
            parts[r] = shapely.get_parts(laid.area.shrunk(r, 8))
        stop = shapely.LineString(laid.paths[i]).interpolate(profile.reached[1])
        ends = [shapely.Point(laid.start[i, :2]), stop]
        rooms = {int(np.argmin(shapely.distance(parts[r], end))) for end in ends if len(parts[r])}
        if len(rooms) != 1:
            yield Fault(
                laid.path_key(i),
                f"no route leads {describe(profile.robot)} from its start to its stop: somewhere "
                f"the free space is narrower than {2.0 * r:.4g} m, the least that the robot can "
                "pass; widen the place, or make the robot smaller",
            )
    for (station, x, y, clearance), group in together.items():
        point, first = shapely.Point(x, y), group[0]
        near = [(s.distance(point), name, s) for name, s in (*laid.walls, *laid.solids)]
        _, name, wall = min(near, key=lambda one: one[:2])
        foot = shapely.get_coordinates(shapely.shortest_line(wall, point))[0]
        others = f", shared with {len(group) - 1} more," if len(group) > 1 else ","
        yield Fault(
            laid.path_key(first.number),
            f"{describe(first.robot)} does not fit at station {station:.2f} m of its path{others} "
            f"at {place_text(x, y)}: {figure(clearance)} m to {name} "
            f"{stretch_text(laid.world.boundaries, name, foot)}, while the footprint reaches "
            f"{figure(first.inscribed)} m from the reference point even at its narrowest; lead the "
            "path further away, or widen the place",
            "warning",
        )
