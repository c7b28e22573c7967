"""Robots as they are drawn: each where it stands, on its own path or beside the reference path."""

from __future__ import annotations

from math import atan2, cos, sin

import numpy as np
import shapely

from physim.geometry.polygon import counter_clockwise
from physim.geometry.shapes import FloatArray
from physim.importing.drawing import Drawing
from physim.importing.fit import Fit
from physim.importing.lanes import drawn_in, is_narrower, lane
from physim.importing.line import directions_at, points_at
from physim.importing.placed import Placed


def as_drawn(drawing: Drawing, found: Fit) -> list[Placed]:
    """Robots where they are drawn, each on its own path or beside the reference path.

    A robot heads along its path: of the four directions of the smallest rectangle about its
    outline the one nearest to the direction of the path. Its reference point is the middle of
    that rectangle.
    """
    reference = shapely.LineString(found.reference)
    placed = []
    for robot in drawing.robots:
        rectangle = shapely.Polygon(robot.outline).minimum_rotated_rectangle
        centre = np.array(rectangle.centroid.coords[0]).round(3)
        own = drawing.paths.get(robot.name)
        line = found.reference if own is None else own
        station = np.array([shapely.LineString(line).project(shapely.Point(centre))])
        tx, ty = directions_at(line, station, found.size)[0]
        edge = np.diff(np.array(rectangle.exterior.coords)[:2], axis=0)[0]
        axis = atan2(edge[1], edge[0])
        turned = [axis + k * np.pi / 2.0 for k in range(4)]
        heading = max(turned, key=lambda angle: cos(angle) * tx + sin(angle) * ty)
        heading = float((heading + np.pi) % (2.0 * np.pi) - np.pi)
        heading = round(heading, 4)
        follows: float | FloatArray
        if own is not None:
            follows = own
        else:
            beside = points_at(line, station)[0]
            gap = round(float(reference.distance(shapely.Point(centre))), 2)
            left = tx * (centre[1] - beside[1]) - ty * (centre[0] - beside[0]) >= 0.0
            follows = _own_lane(drawing, found, robot.name, gap if left else -gap)
        placed.append(
            Placed(
                robot.name,
                _footprint(robot.outline, centre, heading),
                (float(centre[0]), float(centre[1]), heading),
                follows,
            )
        )
    return placed


def _footprint(
    outline: FloatArray, centre: FloatArray, heading: float
) -> tuple[float, float] | FloatArray:
    """Outline in the robot's frame [m], counter-clockwise; a rectangle as (length, width)."""
    c, s = cos(heading), sin(heading)
    own = counter_clockwise(((outline - centre) @ np.array([[c, -s], [s, c]])).round(3))
    half = np.abs(own).max(axis=0)
    if len(own) == 4 and np.abs(np.abs(own) - half).max() <= 0.0015:
        return round(2.0 * float(half[0]), 2), round(2.0 * float(half[1]), 2)
    return own


def _own_lane(drawing: Drawing, found: Fit, name: str, offset: float) -> float | FloatArray:
    one = lane(found.reference, offset, drawing.area, found.room, found.size)
    if one.is_plain:
        return one.offset
    if is_narrower(one):
        drawing.changes.append(
            f"path of {name}, {offset:+.2f} m beside the reference path, {drawn_in(one)}"
        )
    return one.line
