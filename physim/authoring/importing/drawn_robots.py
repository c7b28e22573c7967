"""Robots that are drawn: their poses, and paths as far beside the reference path as they stand."""

from __future__ import annotations

from dataclasses import replace
from math import hypot

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing, DrawnRobot, place, rounded
from physim.authoring.importing.enclosure import HALF_WALL
from physim.authoring.importing.fit import Fit
from physim.authoring.importing.formation import no_formation
from physim.authoring.importing.lanes import Lane, lane, leaves_out
from physim.authoring.importing.lines import (
    Outline,
    directions_at,
    is_closed,
    length_of,
    points_at,
    station_of,
    stretch,
)
from physim.authoring.importing.outlines import footprint_of
from physim.authoring.importing.path_area import TOLD
from physim.authoring.importing.path_starts import (
    directions_at_ends,
    lap_from,
    robots_on,
    stand_on,
)
from physim.authoring.importing.placed import Placed
from physim.authoring.importing.queues import (
    Group,
    first_of,
    queue_up,
    queues_of,
    stations,
)
from physim.authoring.importing.stops import stop_stations
from physim.geometry.shapes import FloatArray

LEAST = 0.1
"""[m] at size 1 that a robot goes that has no way"""
LEAST_WAY = 0.25
"""[-] share of the path that the robot that goes farthest goes at least"""
MOST_NAMED = 6
"""Robots of which it is told where they stop"""
FAR = 2.0
"""[m] from its path at size 1 that a robot has to find a way to it"""


def as_drawn(drawing: Drawing, found: Fit) -> list[Placed]:
    """Robots where they are drawn, each on its own path or beside the reference path.

    A robot heads along its path, as far as the rectangle about its outline allows, whose middle
    is its reference point: `rectangle_of`.
    """
    lanes = _lanes(drawing, found)
    robots = [_as_drawn(robot, drawing, found, lanes) for robot in drawing.robots]
    groups = _groups(drawing, found, robots)
    queues = queues_of(groups, found)
    short, doubts = dict[str, float](), list[str]()
    for queue in queues:
        lags, told = queue_up(queue, found)
        short |= lags
        doubts += told
    free: dict[str, Placed] = {}  # as they go without a formation
    for line, some in groups:
        for one in some:
            is_lap = is_closed(line)
            free[one.name] = (
                _on_own_lap(one, found.size) if is_lap else _stopping_behind(one, short, found.size)
            )
    alone = [free[one.name] for one in robots]
    has_lap = any(is_closed(line) for line, _ in groups)
    if reason := "a path is closed" if has_lap else no_formation(found, robots, alone):
        drawing.has_formation = False
        drawing.facts.append(f"no formation: {reason}; {_ways_without(groups)}")
        said = "robots stop before the ends of their paths, behind others"
        drawing.facts += _short_told(short, said)
        drawing.facts += doubts
        robots = alone
    else:
        drawing.facts += _stops_told(found, groups)
    drawing.changes[:0] = _hardly_moving(drawing, found, robots, queues)
    return robots


def _groups(drawing: Drawing, found: Fit, robots: list[Placed]) -> list[Group]:
    """Each path of robots (n, 2) [m], with those on it or in lanes beside it; s* in any case."""
    by_name = {one.name: one for one in robots}
    lines = {id(line): line for line in (found.reference, *drawing.paths.values())}
    groups = [
        (line, [by_name[one.name] for one in robots_on(drawing, line)]) for line in lines.values()
    ]
    return [(line, some) for line, some in groups if some or line is found.reference]


def _lanes(drawing: Drawing, found: Fit) -> dict[float, Lane]:
    """Lanes of robots without a path of their own, by how far [m] left of the path they stand."""
    outline = Outline(drawing.area)
    offsets = {
        _offset(found, stand_on(robot, found.reference, found.size)[0])
        for robot in drawing.robots
        if robot.name not in drawing.paths
    }
    reference, room, size = found.reference, found.room, found.size
    is_ring = is_closed(reference)
    return {
        offset: lane(reference, offset, outline, room, size, len(offsets), is_ring)
        for offset in sorted(offsets)
    }


def _stops_told(found: Fit, groups: list[Group]) -> list[str]:
    """What is said of a formation on several paths: who stops how far before the end of its own."""
    robots = [one for _, some in groups for one in some]
    lead = robots[int(np.argmax(stations(found.reference, robots)))]
    if any(lead in some and len(some) == len(robots) for _, some in groups):
        return []
    lines = [one.path for one in robots]
    stops = stop_stations(found.reference, lines, [one.pose for one in robots])
    short = {
        one.name: length_of(one.path) - float(stop) for one, stop in zip(robots, stops, strict=True)
    }
    return _short_told(
        short,
        "as a formation, robots stop as far before the ends of their paths as they start behind "
        f"{lead.name} along the reference path",
    )


def _short_told(short: dict[str, float], said: str) -> list[str]:
    """Who stops how far [m] before the end of its path, after what is said of them; or nothing."""
    told = [f"{name} {left:.2f} m" for name, left in short.items() if left > TOLD]
    more = f" and {len(told) - MOST_NAMED} more" if len(told) > MOST_NAMED else ""
    return [f"{said}: {', '.join(told[:MOST_NAMED])}{more}"] if told else []


def _ways_without(groups: list[Group]) -> str:
    """What robots do that have no formation."""
    ways = {is_closed(line) for line, some in groups if some}
    lap = "every robot on a closed path drives a lap of its own, back to where it starts"
    end = "where several end, they stop one behind the other"
    if ways == {True, False}:
        return f"{lap}, the others go to the ends of theirs; {end}"
    return lap if ways == {True} else f"every robot goes to the end of its own path; {end}"


def _on_own_lap(robot: Placed, size: float) -> Placed:
    """A robot that drives a lap, begun just behind where it stands."""
    return replace(robot, path=lap_from(robot.path, np.array(robot.pose[:2]), size), offset=None)


def _hardly_moving(
    drawing: Drawing, found: Fit, robots: list[Placed], queues: list[list[Group]]
) -> list[str]:
    """What is said of paths of which no robot goes a good share, and why that is."""
    leads = {id(line): first_of(queue) for queue in queues for line, _ in queue}
    ends = [length_of(one.path) for one in robots]
    if drawing.has_formation:
        poses = [one.pose for one in robots]
        ends = stop_stations(found.reference, [one.path for one in robots], poses).tolist()
    ways = {
        one.name: max(end - station_of(one.path, np.array(one.pose[:2])), 0.0)
        for one, end in zip(robots, ends, strict=True)
    }
    lead = robots[int(np.argmax(stations(found.reference, robots)))].name
    told = []
    for line, group in _groups(drawing, found, robots):
        if not group or max(ways[one.name] for one in group) >= LEAST_WAY * length_of(line):
            continue
        if not drawing.has_formation:
            lead = leads.get(id(line), "")
        behind = [one for one in group if one.name != lead] or group
        one = max(behind, key=lambda one: ways[one.name])
        said = f"WARNING: {one.name} goes {ways[one.name]:.2f} m of a path of "
        said += f"{length_of(line):.2f} m, and no other "
        said += "on it farther: " if len(behind) == len(group) else f"behind {lead} farther: "
        rear = group[int(np.argmin(stations(line, group)))]
        if station_of(line, np.array(rear.pose[:2])) > 0.5 * length_of(line):
            said += f"it stands near its end, {place(line[-1])}; if that is where it is to begin, "
            said += "draw it the other way round"
        elif drawing.has_formation:
            said += f"it stops as far before its end as it starts behind {lead}, "
            said += "without which it would go on"
        else:
            said += f"it stops behind {lead}, without which it would go on"
        told.append(said)
    return told


def _stopping_behind(robot: Placed, short: dict[str, float], size: float) -> Placed:
    """A robot that stops as far before the end of its path as is said, behind others there."""
    if (lag := short[robot.name]) <= 0.0:
        return robot
    here = station_of(robot.path, np.array(robot.pose[:2]))
    end = max(length_of(robot.path) - lag, here + LEAST * size)  # or where it stands
    return replace(robot, path=rounded(stretch(robot.path, 0.0, end)), offset=None)


def _as_drawn(robot: DrawnRobot, drawing: Drawing, found: Fit, lanes: dict[float, Lane]) -> Placed:
    own = drawing.paths.get(robot.name)
    line = found.reference if own is None else own
    middle, heading = stand_on(robot, line, found.size)
    centre, heading = middle.round(3), round(heading, 4)
    footprint = footprint_of(robot.outline, centre, heading)
    pose = (float(centre[0]), float(centre[1]), heading)
    one = None if own is not None else lanes[_offset(found, middle)]
    if one is not None:
        beside = f"path of {robot.name}, {one.offset:+.2f} m beside the reference path,"
        if narrowing := one.narrowing():
            drawing.changes.append(f"{beside} {narrowing}")
        if leaves_out(line, one.line, found.size):
            drawing.changes.insert(
                0,
                f"WARNING: {beside} is {length_of(one.line):.2f} m long instead of "
                f"{length_of(line):.2f} m: it leaves out a part, as where that comes back beside "
                f"itself; draw it a path of its own, named {robot.name}",
            )
    path = line if one is None else one.line
    _tell_far(drawing, found, robot, centre, path)
    return Placed(robot.name, footprint, pose, path, None if one is None else one.plain_offset)


def _offset(found: Fit, centre: FloatArray) -> float:
    """How far [m] left of the reference path a robot goes that has no path of its own."""
    return round(_beside(found.reference, centre, found.size), 2) + 0.0


def _tell_far(
    drawing: Drawing, found: Fit, robot: DrawnRobot, centre: FloatArray, line: FloatArray
) -> None:
    """Tell of a robot that stands far from its path, or behind a wall from it."""
    point = shapely.Point(centre)
    away = point.distance(shapely.LineString(found.reference))
    if robot.name not in drawing.paths and away > FAR * found.size:
        for other, own in drawing.paths.items():
            if point.distance(shapely.LineString(own)) < 0.5 * found.box[1]:
                drawing.changes.append(
                    f"WARNING: {robot.name} at {place(centre)} stands on the path of {other}, and "
                    f"goes {away:.2f} m beside the reference path; draw it a path of its own, "
                    f"named {robot.name}"
                )
                return
    way = shapely.shortest_line(point, shapely.LineString(line))
    is_walled = way.difference(drawing.area).length > HALF_WALL
    if not is_walled and way.length <= FAR * found.size:
        return
    behind = ", behind a wall" if is_walled else ""
    stands = f"WARNING: {robot.name} at {place(centre)} stands {way.length:.2f} m from"
    is_own = sum(line is own for own in drawing.paths.values()) == 1
    drawing.changes.append(
        f"{stands} the path with its name{behind}"
        if robot.name in drawing.paths and is_own
        else f"{stands} its path{behind}; draw it a path of its own, named {robot.name}"
    )


def _beside(line: FloatArray, point: FloatArray, size: float) -> float:
    """How far [m] left of a path a point (2,) is; beyond an end, of the straight way on from it."""
    station = station_of(line, point)
    x, y = point - points_at(line, station)
    end = length_of(line)
    if 0.0 < station < end or is_closed(line):
        tx, ty = directions_at(line, station, 1e-6 * end)
        return hypot(x, y) if tx * y - ty * x >= 0.0 else -hypot(x, y)
    tx, ty = directions_at_ends(line, size)[int(station > 0.0)]
    return float(tx * y - ty * x)
