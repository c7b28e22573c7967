"""Where paths begin for robots that are drawn: behind those that wait for them, laps at each.

A formation measures its distances along the path, so that all of it must begin before any robot.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from physim.authoring.importing.drawing import DIGITS, Drawing, DrawnRobot, place, rounded
from physim.authoring.importing.enclosure import HALF_WALL
from physim.authoring.importing.lines import (
    directions_at,
    is_closed,
    length_of,
    station_of,
    stretch,
)
from physim.authoring.importing.outlines import rectangle_of, spans_of
from physim.geometry.shapes import FloatArray
from physim.geometry.thinning import simplified

BEHIND = 0.1
"""[m] at size 1: as far behind its robot a lap begins"""
TOLD = 0.01
"""[m] by which a path begins earlier from which on it is told"""
HOOK = 0.1
"""[m] at size 1: what a path turns within it is not meant"""


def follow_the_nearest(drawing: Drawing) -> None:
    """Give robots without a path the nearest of those of the others, where every path has a name.

    The nearest that no wall is before; of equal ones the reference path, beside which they have a
    lane, if it is that.
    """
    if not drawing.are_paths_named or drawing.reference is None:
        return
    lines = [drawing.reference, *drawing.paths.values()]
    shapes = np.array([shapely.LineString(line) for line in lines])
    for robot in drawing.robots:
        if robot.name not in drawing.paths:
            centre = shapely.Polygon(robot.outline).centroid
            ways = shapely.shortest_line(centre, shapes)
            walled = shapely.length(shapely.difference(ways, drawing.area)) > HALF_WALL
            nearest = int(np.lexsort((shapely.length(ways), walled))[0])
            if lines[nearest] is not drawing.reference:
                drawing.paths[robot.name] = lines[nearest]


def begin_at_robots(drawing: Drawing, size: float) -> None:
    """Let every path of a drawing begin behind the robots drawn on it, which is told.

    ``size`` is the factor on the group: `Fit`. A path stays as it is where no such way is free.
    """
    assert drawing.reference is not None
    lines = {id(line): line for line in (drawing.reference, *drawing.paths.values())}
    begun = {}
    for key, line in lines.items():
        robots = robots_on(drawing, line)
        what = "path" if line is drawing.reference else path_of(robots)
        begun[key] = _begun(drawing, line, robots, size, what)
    drawing.paths = {name: begun[id(line)] for name, line in drawing.paths.items()}
    drawing.reference = begun[id(drawing.reference)]


def path_of(robots: Sequence[DrawnRobot]) -> str:
    """What messages call the path of one robot, or of several."""
    return f"path of {robots[0].name}" + (" and others" if len(robots) > 1 else "")


def robots_on(drawing: Drawing, line: FloatArray) -> list[DrawnRobot]:
    """Robots that go along a path: those whose own it is, and without one on the reference path."""
    return [one for one in drawing.robots if drawing.paths.get(one.name, drawing.reference) is line]


def stand_on(robot: DrawnRobot, line: FloatArray, size: float) -> tuple[FloatArray, float]:
    """Reference point (2,) [m] and heading [rad] of a robot that goes along a path (n, 2) [m].

    The middle of the rectangle about its outline that heads along the path: `rectangle_of`.
    """
    centre = np.array(shapely.Polygon(robot.outline).centroid.coords[0])
    return rectangle_of(robot.outline, directions_at(line, station_of(line, centre), size))


def directions_at_ends(line: FloatArray, size: float) -> tuple[FloatArray, FloatArray]:
    """Unit directions (2,) of a path at its beginning and its end, without hooks of a hand."""
    plain = simplified(line, HOOK * size)
    legs = np.stack([plain[1] - plain[0], plain[-1] - plain[-2]])
    first, last = legs / np.hypot(*legs.T)[:, None]
    return first, last


def _begun(
    drawing: Drawing, line: FloatArray, robots: Sequence[DrawnRobot], size: float, what: str
) -> FloatArray:
    """A path (n, 2) [m] that begins behind some robots; the same where it does, and of a lap."""
    if not robots or is_closed(line):
        return line
    centres = np.array([stand_on(one, line, size)[0] for one in robots])
    ahead, _ = directions_at_ends(line, size)
    away = [one - line[0] for one in centres if station_of(line, one) <= 0.0]
    behind = [-float(one @ ahead) for one in away]
    least = max(behind, default=0.0)
    if least < 10.0**-DIGITS:
        return line
    begin = (line[0] - least * ahead).round(DIGITS)
    way = shapely.LineString([begin, line[0]])
    width = max(float(spans_of(one.outline)[0]) for one in robots)
    is_free = drawing.area.covers(way)
    is_free &= way.distance(drawing.area.boundary) > 0.5 * width
    beside = [  # of those behind, from the beginning to the side where they stand
        shapely.LineString([line[0], line[0] + one + far * ahead])
        for one, far in zip(away, behind, strict=True)
        if far > 10.0**-DIGITS
    ]
    if not is_free or not all(map(drawing.area.covers, beside)):  # as round a corner
        drawing.changes.append(
            f"WARNING: a robot stands {least:.2f} m before the {what} begins at {place(line[0])}, "
            f"not straight behind it on a way that is free; draw the {what} from behind the robots"
        )
        return line
    if least >= TOLD:
        drawing.changes.append(
            f"{what} begun {least:.2f} m earlier, at {place(begin)}, where a robot stands behind it"
        )
    dx, dy = line[1] - line[0]
    is_straight = abs(float(ahead[0] * dy - ahead[1] * dx)) < 10.0**-DIGITS
    return np.vstack([begin, line[1 if is_straight else 0 :]])


def lap_from(line: FloatArray, point: FloatArray, size: float) -> FloatArray:
    """A lap (n, 2) [m], closed or nearly, that begins just behind a point (2,) [m] beside it.

    To the millimetre.
    """
    ring = line if is_closed(line) else np.vstack([line, line[:1]])
    length = length_of(ring)
    begin = (station_of(ring, point) - BEHIND * size) % length
    head, tail = stretch(ring, 0.0, begin), stretch(ring, begin, length)
    return rounded(np.vstack([tail[:-1], head]))
