"""Robots as they are drawn: where they stand and head, and the paths on which they go.

A robot heads along its path, or as the drawing says. One without a path of its own keeps its
distance from the reference path; on a closed path every robot drives a lap, from where it stands.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import count
from math import cos, hypot, sin

import numpy as np
import shapely

from physim.authoring.importing.area import Place
from physim.authoring.importing.drawing import DIGITS, Drawing, Shape, place, rounded
from physim.escaping import escaped
from physim.geometry.polygon import counter_clockwise
from physim.geometry.shapes import FloatArray
from physim.world.ground.corridor import offset_polyline
from physim.world.ground.polyline import Polyline

MOST_DRAWN = 500
"""Robots of a drawing"""
BEHIND = 0.1
"""[-] of its length: as far behind its robot a lap begins"""

Footprint = tuple[float, float] | FloatArray
"""Length and width [m], or an outline (n, 2) [m] in the robot's frame"""
Pose = tuple[float, float, float]
"""x, y [m] and heading [rad]"""


@dataclass(frozen=True)
class Placed:
    """One robot of the world: ``box`` its length and width [m], ``path`` points (n, 2) [m].

    ``offset`` [m] of its path from the reference path, left positive; None where it is said by its
    points. ``shape`` is that of the drawing.
    """

    name: str
    footprint: Footprint
    box: tuple[float, float]
    pose: Pose
    path: FloatArray
    offset: float | None = None
    shape: Shape | None = None


def robot_names(robots: Sequence[Shape]) -> list[str]:
    """Their names in the world: as drawn, else by number, of those that are free."""
    drawn = [escaped(one.name)[:80].strip() for one in robots]
    free = (name for k in count(1) if (name := f"r{k}") not in drawn)
    return [name or next(free) for name in drawn]


def as_drawn(
    drawing: Drawing, where: Place, reference: FloatArray, own: dict[str, FloatArray]
) -> tuple[FloatArray, list[Placed]]:
    """The reference path (n, 2) [m], and robots where they are drawn.

    Paths, ``own`` ones too, begin straight behind those that wait for them. Raises
    ImportSourceError for a lane without room for its robot.
    """
    shapes = drawing.of("robot")
    if len(shapes) > MOST_DRAWN:
        raise drawing.refusal(
            f"{len(shapes)} robots are drawn; at most {MOST_DRAWN} are read; draw fewer, or have "
            "boxes placed instead by --robots N"
        )
    robots = [
        _stand(shape, name, own.get(name, reference))
        for name, shape in zip(robot_names(shapes), shapes, strict=True)
    ]
    on_it = [one for one in robots if one.name not in own]
    reference = _begun(drawing, where, reference, on_it, "path")
    placed = list[Placed]()
    for one in robots:
        if one.name in own:
            line, offset = _begun(drawing, where, one.path, [one], f"path of {one.name}"), None
        else:
            offset = _offset(reference, one)
            line = lane(drawing, reference, offset, one.shape)
        one = replace(one, path=line, offset=offset)
        placed.append(lap(one) if (line[0] == line[-1]).all() else one)
    return reference, placed


def _stand(shape: Shape, name: str, line: FloatArray) -> Placed:
    """A robot on a path (n, 2) [m]; the middle of the box along its heading is its reference."""
    way, outline = Polyline(line), shape.points[:-1]
    extent = float(np.ptp(outline, axis=0).max())
    heading = shape.heading
    if heading is None:
        middle = np.array(shape.geometry.centroid.coords[0])
        ahead = way.chords(way.nearest(middle)[0], extent)
        heading = float(np.arctan2(ahead[1], ahead[0]))
    heading = round(heading, 4)
    turn = np.array([[cos(heading), -sin(heading)], [sin(heading), cos(heading)]])
    own = outline @ turn
    low, high = own.min(axis=0), own.max(axis=0)
    centre = (turn @ (low + high) / 2.0).round(DIGITS)
    own = counter_clockwise((own - centre @ turn).round(DIGITS))
    half = np.abs(own).max(axis=0)
    length, width = (round(2.0 * float(v), 2) for v in half)
    is_box = len(own) == 4 and np.abs(np.abs(own) - half).max() <= 1.5 * 10.0**-DIGITS
    footprint: Footprint = (length, width) if is_box else own
    pose = (float(centre[0]), float(centre[1]), heading)
    return Placed(name, footprint, (length, width), pose, line, shape=shape)


def _begun(
    drawing: Drawing, where: Place, line: FloatArray, robots: Sequence[Placed], what: str
) -> FloatArray:
    """A path (n, 2) [m] that begins where the last robot straight behind it stands.

    A formation measures its distances along the path, so that it must begin before any robot.
    """
    if not robots or (line[0] == line[-1]).all():
        return line
    ahead = line[1] - line[0]
    ahead /= hypot(*ahead)
    centres = np.array([one.pose[:2] for one in robots])
    stations = Polyline(line).nearest(centres)
    least = max(float((-(centres - line[0]) @ ahead)[stations <= 0.0].max(initial=0.0)), 0.0)
    if least < 10.0**-DIGITS:
        return line
    begin = (line[0] - least * ahead).round(DIGITS)
    half = 0.5 * max(one.box[1] for one in robots)
    way = shapely.LineString([begin, line[0]])
    if not where.area.covers(way) or where.clearance.of(way).min() <= half:
        drawing.changes.append(
            f"WARNING: a robot stands {least:.2f} m before the {what} begins at {place(line[0])}, "
            f"not straight behind it on a way that is free; draw the {what} from behind the robots"
        )
        return line
    drawing.changes.append(
        f"{what} begun {least:.2f} m earlier, at {place(begin)}, where a robot stands behind it"
    )
    return np.vstack([begin, line[1:]])  # its first piece is straight on


def _offset(line: FloatArray, robot: Placed) -> float:
    """How far [m] left of a path a robot stands, to the centimetre; 0 within half of one."""
    way, at = Polyline(line), np.array(robot.pose[:2])
    point, (tx, ty) = (one[0] for one in way.at(way.nearest(at)))
    x, y = at - point
    side = tx * y - ty * x
    is_beside = 0.0 < way.nearest(at)[0] < way.length or way.is_ring()
    return round(float(np.sign(side) * hypot(x, y) if is_beside else side), 2) + 0.0


def lane(
    drawing: Drawing, line: FloatArray, offset: float, shape: Shape | None = None
) -> FloatArray:
    """Path (n, 2) [m] beside another, left positive; refused where that bends too tightly."""
    if offset == 0.0:
        return line
    is_ring = bool((line[0] == line[-1]).all())
    whole = np.vstack([line[-2:-1], line, line[1:2]]) if is_ring else line
    with suppress(ValueError):  # a sharp turn, of which the same is to be told
        beside = offset_polyline(whole, np.full(len(whole), offset))
        beside = np.vstack([beside[1:-2], beside[1]]) if is_ring else beside
        along = (np.diff(beside, axis=0) * np.diff(line, axis=0)).sum(axis=1)
        if (along > 0.0).all():
            return beside
    raise drawing.refusal(
        f"the path bends too tightly for a lane {offset:+g} m beside it; smooth it, fewer --lanes, "
        "or draw the robot a path of its own with its name",
        shape,
    )


def lap(robot: Placed) -> Placed:
    """A robot on a closed path that drives a lap of its own, begun just behind it."""
    way = Polyline(robot.path)
    begin = (way.nearest(robot.pose[:2])[0] - BEHIND * robot.box[0]) % way.length
    head, tail = way.stretch(0.0, begin), way.stretch(begin, way.length)
    return replace(robot, path=rounded(np.vstack([tail[:-1], head])), offset=None)
