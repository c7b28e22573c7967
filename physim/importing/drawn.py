"""Robots as they are drawn: each where it stands, on its own path or beside the reference path."""

from __future__ import annotations

from math import atan2, cos, pi, sin

import numpy as np
import shapely

from physim.geometry.polygon import counter_clockwise
from physim.geometry.shapes import FloatArray
from physim.importing.drawing import Drawing, DrawnRobot
from physim.importing.fit import Fit
from physim.importing.lanes import lane
from physim.importing.line import directions_at, points_at, station_of
from physim.importing.stops import Footprint, Placed


def as_drawn(drawing: Drawing, found: Fit) -> list[Placed]:
    """Robots where they are drawn, each on its own path or beside the reference path.

    A robot heads along its path: of the four directions of the smallest rectangle about its
    outline the one nearest to the direction of the path. Its reference point is the middle of
    that rectangle.
    """
    return [_as_drawn(robot, drawing, found) for robot in drawing.robots]


def _as_drawn(robot: DrawnRobot, drawing: Drawing, found: Fit) -> Placed:
    rectangle = shapely.Polygon(robot.outline).minimum_rotated_rectangle
    centre = np.array(rectangle.centroid.coords[0]).round(3)
    own = drawing.paths.get(robot.name)
    line = found.reference if own is None else own
    station = station_of(line, centre)
    tx, ty = directions_at(line, station, found.size)
    edge = np.diff(np.array(rectangle.exterior.coords)[:2], axis=0)[0]
    turned = [atan2(edge[1], edge[0]) + k * pi / 2.0 for k in range(4)]
    heading = max(turned, key=lambda angle: cos(angle) * tx + sin(angle) * ty)
    heading = round((heading + pi) % (2.0 * pi) - pi, 4)
    footprint = _footprint(robot.outline, centre, heading)
    pose = (float(centre[0]), float(centre[1]), heading)
    if own is not None:
        return Placed(robot.name, footprint, pose, own, None)
    x, y = centre - points_at(line, station)
    gap = round(float(shapely.LineString(line).distance(shapely.Point(centre))), 2)
    offset = gap if tx * y - ty * x >= 0.0 else -gap
    one = lane(line, offset, drawing.area, found.room, found.size)
    if narrowing := one.narrowing():
        drawing.changes.append(
            f"path of {robot.name}, {offset:+.2f} m beside the reference path, {narrowing}"
        )
    return Placed(robot.name, footprint, pose, one.line, one.plain_offset)


def _footprint(outline: FloatArray, centre: FloatArray, heading: float) -> Footprint:
    """Outline in the robot's frame [m], counter-clockwise; a rectangle as (length, width)."""
    c, s = cos(heading), sin(heading)
    own = counter_clockwise(((outline - centre) @ np.array([[c, -s], [s, c]])).round(3))
    half = np.abs(own).max(axis=0)
    if len(own) == 4 and np.abs(np.abs(own) - half).max() <= 0.0015:
        return round(2.0 * float(half[0]), 2), round(2.0 * float(half[1]), 2)
    return own
