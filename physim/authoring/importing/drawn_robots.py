"""Robots that are drawn: their poses, and paths as far beside the reference path as they stand."""

from __future__ import annotations

from dataclasses import replace
from math import hypot

import numpy as np
import shapely

from physim.authoring.importing.drawing import DIGITS, Drawing, DrawnRobot, place, rounded
from physim.authoring.importing.enclosure import HALF_WALL
from physim.authoring.importing.fit import Fit
from physim.authoring.importing.lines import (
    Outline,
    directions_at,
    lane,
    length_of,
    points_at,
    station_of,
    stretch,
)
from physim.authoring.importing.outlines import footprint_of, rectangle_of
from physim.authoring.importing.robots import Placed, stop_stations
from physim.geometry.shapes import FloatArray
from physim.geometry.thinning import simplified

ALONG = 0.5
"""[-] share of its length that a path has along the reference path, if a formation goes on it"""
LEAST_WAY = 0.25
"""[-] share of the path that the robot that goes farthest goes at least"""
FAR = 2.0
"""[m] from its path at size 1 that a robot has to find a way to it"""
HOOK = 0.1
"""[m] at size 1: what a path turns within it is not meant"""


def as_drawn(drawing: Drawing, found: Fit) -> tuple[Fit, list[Placed]]:
    """Robots where they are drawn, each on its own path or beside the reference path.

    A robot heads along its path, as far as the rectangle about its outline allows, whose middle
    is its reference point: `rectangle_of`. Returns the fit with the path that they follow, which
    begins where the last of them stands.
    """
    outline = Outline(drawing.area)
    found = _begun_behind(drawing, found)
    robots = [_as_drawn(robot, drawing, found, outline) for robot in drawing.robots]
    others = [
        robot.name
        for robot in robots
        if robot.name in drawing.paths and not _goes_along(found.reference, robot.path)
    ]
    if others:
        drawing.is_one_way = False
        drawing.facts.append(
            f"{others[0]} {'and others go' if len(others) > 1 else 'goes'} another way than the "
            "reference path: no formation, every robot goes to the end of its own path"
        )
        robots = _stopping_behind(drawing, found, robots)
    else:
        drawing.changes[:0] = _hardly_moving(found, robots)
    return found, robots


def _hardly_moving(found: Fit, robots: list[Placed]) -> list[str]:
    """What is said where no robot goes a good share of the path: they may stand at its end."""
    line, paths = found.reference, [one.path for one in robots]
    stops = stop_stations(line, paths, [one.pose for one in robots])
    starts = [station_of(one.path, np.array(one.pose[:2])) for one in robots]
    farthest = float((stops - starts).max())
    if farthest >= LEAST_WAY * length_of(line):
        return []
    return [
        f"WARNING: no robot goes farther than {max(farthest, 0.0):.2f} m of the path of "
        f"{length_of(line):.2f} m: they stand near its end, {place(line[-1])}; if that is where "
        "they are to begin, draw it the other way round"
    ]


def _goes_along(reference: FloatArray, path: FloatArray) -> bool:
    """Whether a path makes most of its way along another, where a formation measures it."""
    first, last = (station_of(reference, path[k]) for k in (0, -1))
    return last - first > ALONG * length_of(path)


def _stopping_behind(drawing: Drawing, found: Fit, robots: list[Placed]) -> list[Placed]:
    """Robots of which those on the reference path stop as far behind its end as they start behind.

    Behind the first of them: as a formation has it, but each on a path of its own.
    """
    own = [robot for robot in robots if robot.name not in drawing.paths]
    starts = {robot.name: station_of(found.reference, np.array(robot.pose[:2])) for robot in own}
    lead = max(starts.values(), default=0.0)
    made = []
    for robot in robots:
        lag = lead - starts.get(robot.name, lead)
        if lag > 0.0:
            line = stretch(robot.path, 0.0, length_of(robot.path) - lag)
            robot = replace(robot, path=rounded(line), offset=None)
        made.append(robot)
    return made


def _begun_behind(drawing: Drawing, found: Fit) -> Fit:
    """The fit with a path that begins straight behind, where robots stand before its beginning.

    A formation cannot measure their distances there. It stays as it is where no such way is free.
    """
    line = found.reference
    if (line[0] == line[-1]).all():
        return _lap(drawing, found)
    ahead, _ = _directions_at_ends(line, found.size)
    centres = [_centroid(one) for one in drawing.robots if one.name not in drawing.paths]
    away = [centre - line[0] for centre in centres if station_of(line, centre) <= 0.0]
    behind = [-float(one @ ahead) for one in away]
    least = max(behind, default=0.0)
    if least < 10.0**-DIGITS:
        return found
    begin = (line[0] - least * ahead).round(DIGITS)
    way = shapely.LineString([begin, line[0]])
    is_free = drawing.area.covers(way)
    is_free &= way.distance(drawing.area.boundary) > 0.5 * found.box[1]
    beside = [  # of those behind, from the beginning to the side where they stand
        shapely.LineString([line[0], line[0] + one + far * ahead])
        for one, far in zip(away, behind, strict=True)
        if far > 10.0**-DIGITS
    ]
    if not is_free or not all(map(drawing.area.covers, beside)):  # as round a corner
        drawing.changes.append(
            f"WARNING: a robot stands {least:.2f} m before the path begins at {place(line[0])}, "
            "not straight behind it on a way that is free; draw the path from behind the robots"
        )
        return found
    drawing.changes.append(
        f"path begun {least:.2f} m earlier, at {place(begin)}, where a robot stands behind it"
    )
    dx, dy = line[1] - line[0]
    is_straight = abs(float(ahead[0] * dy - ahead[1] * dx)) < 10.0**-DIGITS
    return replace(found, reference=np.vstack([begin, line[1 if is_straight else 0 :]]))


def _lap(drawing: Drawing, found: Fit) -> Fit:
    """The fit with a closed path that begins at the last of the robots on it.

    That is the one ahead of which, all round, the others are nearest: behind it is the longest way
    without one.
    """
    line = found.reference
    on_it = [one for one in drawing.robots if one.name not in drawing.paths]
    at = [station_of(line, _centroid(one)) for one in on_it]
    length = length_of(line)
    behind = [min(((own - other) % length for other in at if other != own), default=length)
              for own in at]  # fmt: skip
    if not at:
        return found
    begin = at[int(np.argmax(behind))]
    if 0.0 < begin < length:
        line = np.vstack([stretch(line, begin, length)[:-1], stretch(line, 0.0, begin)])
        drawing.changes.append(
            f"closed path begun at {place(line[0])}, where the last robot stands"
        )
    return replace(found, reference=rounded(line))


def _centroid(robot: DrawnRobot) -> FloatArray:
    return np.array(shapely.Polygon(robot.outline).centroid.coords[0])


def _as_drawn(robot: DrawnRobot, drawing: Drawing, found: Fit, outline: Outline) -> Placed:
    own = drawing.paths.get(robot.name)
    line = found.reference if own is None else own
    middle = _centroid(robot)
    ahead = directions_at(line, station_of(line, middle), found.size)
    centre, heading = rectangle_of(robot.outline, ahead)
    centre, heading = centre.round(3), round(heading, 4)
    footprint = footprint_of(robot.outline, centre, heading)
    pose = (float(centre[0]), float(centre[1]), heading)
    if own is not None:
        _tell_far(drawing, found, robot, centre, own)
        return Placed(robot.name, footprint, pose, own, None)
    offset = round(_beside(line, centre, found.size), 2)
    one = lane(line, offset, outline, found.room, found.size, len(drawing.robots))
    if narrowing := one.narrowing():
        drawing.changes.append(
            f"path of {robot.name}, {offset:+.2f} m beside the reference path, {narrowing}"
        )
    _tell_far(drawing, found, robot, centre, one.line)
    return Placed(robot.name, footprint, pose, one.line, one.plain_offset)


def _tell_far(
    drawing: Drawing, found: Fit, robot: DrawnRobot, centre: FloatArray, line: FloatArray
) -> None:
    """Tell of a robot that stands far from its path, or behind a wall from it."""
    way = shapely.shortest_line(shapely.Point(centre), shapely.LineString(line))
    is_walled = way.difference(drawing.area).length > HALF_WALL
    if not is_walled and way.length <= FAR * found.size:
        return
    behind = ", behind a wall" if is_walled else ""
    stands = f"WARNING: {robot.name} at {place(centre)} stands {way.length:.2f} m from"
    drawing.changes.append(
        f"{stands} the path with its name{behind}"
        if robot.name in drawing.paths
        else f"{stands} its path{behind}; draw it a path of its own, named {robot.name}"
    )


def _directions_at_ends(line: FloatArray, size: float) -> tuple[FloatArray, FloatArray]:
    """Unit directions (2,) of a path at its beginning and its end, without hooks of a hand."""
    plain = simplified(line, HOOK * size)
    legs = np.stack([plain[1] - plain[0], plain[-1] - plain[-2]])
    first, last = legs / np.hypot(*legs.T)[:, None]
    return first, last


def _beside(line: FloatArray, point: FloatArray, size: float) -> float:
    """How far [m] left of a path a point (2,) is; beyond an end, of the straight way on from it."""
    station = station_of(line, point)
    x, y = point - points_at(line, station)
    end = length_of(line)
    if 0.0 < station < end:
        tx, ty = directions_at(line, station, 1e-6 * end)
        return hypot(x, y) if tx * y - ty * x >= 0.0 else -hypot(x, y)
    tx, ty = _directions_at_ends(line, size)[int(station > 0.0)]
    return float(tx * y - ty * x)
