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
BEHIND = 0.1
"""[m] at size 1: robots of a lap that are less far apart along it are abreast; it begins as far
behind the last"""
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
    drawing.changes[:0] = _hardly_moving(drawing, found, robots)
    return found, robots


def _hardly_moving(drawing: Drawing, found: Fit, robots: list[Placed]) -> list[str]:
    """What is said of paths of which no robot goes a good share: these may stand at its end."""
    paths = [one.path for one in robots]
    lengths = np.array([length_of(path) for path in paths])
    stops = lengths
    if drawing.is_one_way:
        stops = stop_stations(found.reference, paths, [one.pose for one in robots])
    starts = [station_of(one.path, np.array(one.pose[:2])) for one in robots]
    ways = np.maximum(stops - starts, 0.0)
    on_it = {one.name for one in _on_it(drawing)}
    groups = [[k for k, one in enumerate(robots) if one.name in on_it]]
    groups += [[k] for k, one in enumerate(robots) if one.name not in on_it]
    told = []
    for group in filter(None, groups):
        k = max(group, key=lambda one: float(ways[one]))
        if ways[k] < LEAST_WAY * lengths[k]:
            told.append(
                f"WARNING: {robots[k].name} goes {ways[k]:.2f} m of a path of {lengths[k]:.2f} m, "
                f"and no other on it farther: it stands near its end, {place(paths[k][-1])}; if "
                "that is where it is to begin, draw it the other way round"
            )
    return told


def _goes_along(reference: FloatArray, path: FloatArray) -> bool:
    """Whether a path makes most of its way along another, where a formation measures it."""
    length = length_of(path)
    is_lap = (path[0] == path[-1]).all()
    shares = (0.25, 0.75) if is_lap else (0.0, 1.0)
    first, last = (station_of(reference, points_at(path, share * length)) for share in shares)
    return last - first > ALONG * (shares[1] - shares[0]) * length


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
        if 0.0 < lag < length_of(robot.path) - found.size:
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
    away = [
        centre - line[0]
        for centre in map(_centroid, _on_it(drawing))
        if station_of(line, centre) <= 0.0
    ]
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
    return _begun(drawing, found, np.vstack([begin, line[1 if is_straight else 0 :]]))


def _on_it(drawing: Drawing) -> list[DrawnRobot]:
    """Robots on the reference path: those without one of their own, or of which it is that."""
    reference = drawing.reference
    return [one for one in drawing.robots if drawing.paths.get(one.name, reference) is reference]


def _begun(drawing: Drawing, found: Fit, line: FloatArray) -> Fit:
    """The fit with another reference path (n, 2) [m], also of the robot of which it is the own."""
    for name, own in drawing.paths.items():
        if own is drawing.reference:
            drawing.paths[name] = line
    drawing.reference = line
    return replace(found, reference=line)


def _lap(drawing: Drawing, found: Fit) -> Fit:
    """The fit with a closed path that begins just behind the last of the robots on it.

    That is the one behind which, all round, the longest way without another is.
    """
    line, least = found.reference, BEHIND * found.size
    length = length_of(line)
    at = np.array([station_of(line, _centroid(one)) for one in _on_it(drawing)])
    if not at.size:
        return found
    gaps = (at[:, None] - at[None]) % length
    gaps[(gaps < least) | (gaps > length - least)] = length  # abreast, or the robot itself
    last = gaps.min(axis=1) >= gaps.min(axis=1).max() - least
    first_of_last = at[last][0]
    behind = (at[last] - first_of_last + least) % length  # of those abreast the rearmost
    begin = float((first_of_last - least + behind.min() - least) % length)
    lap = np.vstack([stretch(line, begin, length)[:-1], stretch(line, 0.0, begin)])
    if 0.0 < begin < length:
        line = rounded(lap)
    drawing.changes.append(f"closed path begun at {place(line[0])}, where the last robot stands")
    return _begun(drawing, found, line)


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
