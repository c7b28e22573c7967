"""Which of the areas that lines enclose is the place of the robots; asked for where in doubt.

A path, a robot, a point (--from) or a polygon says where robots are. Without any of them the
largest area is taken, unless it may well be the inside of a wall: that is refused, as its size
tells nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import shapely

from physim.authoring.importing.drawing import Drawing, DrawnRobot, place, refused
from physim.authoring.importing.joining import OUTSIDE, beyond_of, faces_and_loose
from physim.authoring.importing.lines import is_closed
from physim.authoring.importing.openings import open_ends, opening
from physim.errors import plural

APART = 0.5
"""[-] share that outlines which meet have of their hull, below which they seem to be walls"""
THIN = 0.6
"""[m] what is not wider may be the inside of a wall"""
DIAGONAL = 2.0**0.5
"""[-] times as wide walls are where they cross"""
OTHERS = 2.0
"""[-] times as long as the outline of an area all lines beyond it are at most: walls about it are
drawn with two sides"""
SAY = "say where robots are (--from X,Y, or a path)"
ADVICE = f"close it, or {SAY}"


def place_of(
    path: Path, drawing: Drawing, inside: tuple[float, float] | None
) -> tuple[Any, list[Any]]:
    """The shapely polygon, among those that boundaries enclose, where the robots are.

    And the lines that enclose nothing. Raises ImportSourceError where there is none, or none with
    the reference path or the point ``inside`` in it, and where it is in doubt.
    """
    if not drawing.boundaries:
        raise refused(path, "no boundary found; a world needs lines that enclose an area")
    faces, loose = faces_and_loose(drawing.boundaries)
    if not faces:
        said, at = open_ends(drawing)
        message = f"the boundaries enclose no area; {said}"
        raise drawing.refused_at(path, message, at, "boundary")
    is_said = drawing.reference is not None or inside is not None or bool(drawing.robots)
    places = _places(path, drawing, inside, faces, [] if is_said else drawing.painted)
    face = chosen_area(places, drawing, inside)
    if drawing.reference is not None:
        if face.intersection(shapely.LineString(drawing.reference)).length <= 0.0:
            middle = shapely.LineString(drawing.reference).interpolate(0.5, normalized=True)
            message = "no area that the boundaries enclose contains the path"
            message += _where_open(drawing, middle) or _said_by_a_polygon(drawing)
            raise drawing.refused_at(path, message, drawing.reference[0], "path")
    elif inside is not None:
        if not face.contains(point := shapely.Point(inside)):
            message = f"--from {place(inside)}: in no area that the boundaries enclose"
            raise refused(path, message + _where_open(drawing, point))
    elif drawing.robots:
        robot, middle = drawing.robots[0], _middle(drawing.robots[0])
        if not any(face.contains(_middle(one)) for one in drawing.robots):
            message = f"no area that the boundaries enclose contains {robot.name!r}"
            message += _where_open(drawing, middle) or _said_by_a_polygon(drawing)
            raise drawing.refused_at(path, message, robot.outline[0], "robot")
    elif drawing.within is None:
        _check_no_doubt(path, drawing, face, loose)
        if len(places) > 1:
            drawing.changes.insert(0, _others(face, len(places)))
    return face, loose


def chosen_area(areas: Sequence[Any], drawing: Drawing, inside: tuple[float, float] | None) -> Any:
    """The shapely polygon that is meant for the robots.

    The one that holds the most of the reference path, else the point ``inside`` or is nearest to
    it, else the most robots, else the largest.
    """
    if drawing.reference is not None:
        line = shapely.LineString(drawing.reference)
        return max(areas, key=lambda area: (area.intersection(line).length, area.area))
    if inside is not None:
        point = shapely.Point(inside)
        return min(areas, key=lambda area: (area.distance(point), -area.area))
    robots = [_middle(one) for one in drawing.robots]
    return max(areas, key=lambda area: (sum(area.contains(r) for r in robots), area.area))


def _middle(robot: DrawnRobot) -> Any:
    return shapely.MultiPoint(robot.outline).convex_hull.centroid


def _said_by_a_polygon(drawing: Drawing) -> str:
    if drawing.within is None:
        return ""
    at = place(drawing.within.representative_point().coords[0])
    return (
        f"; a polygon of {drawing.within.area:.3g} m² about {at} says where robots may go: one "
        "without a role does, too"
    )


def _places(
    path: Path,
    drawing: Drawing,
    inside: tuple[float, float] | None,
    faces: list[Any],
    painted: list[Any],
) -> list[Any]:
    """Areas where robots could be: not within walls, and where a polygon says that they may."""
    solids = shapely.union_all([*drawing.solids, *painted])
    shapely.prepare(solids)
    inner = [(one, one.representative_point()) for one in faces]
    places = [
        one
        for one, point in inner
        if not solids.contains(point) and (drawing.within is None or drawing.within.covers(point))
    ]
    if not places:
        message = "the walls enclose no area beside what they fill themselves"
        middle = None if inside is None else shapely.Point(inside)
        if drawing.reference is not None:
            middle = shapely.LineString(drawing.reference).interpolate(0.5, normalized=True)
        message += _where_open(drawing, middle)
        message += "; close the room, or call its outline boundary, not wall"
        message += f", or {SAY}" if painted else ""
        raise drawing.refused_at(path, message, drawing.boundaries[0][0], "boundary")
    return places


def _where_open(drawing: Drawing, inside: Any) -> str:
    """``; the walls leave it open ...`` for the place about a shapely point, as far as known."""
    lines = shapely.union_all([shapely.LineString(line) for line in drawing.boundaries])
    walls = shapely.union_all([lines, *drawing.solids, *([] if inside else drawing.painted)])
    said = opening(walls, inside)
    return f"; {said}" if said else ""


def _others(face: Any, count: int) -> str:
    at = place(face.representative_point().coords[0])
    return (
        f"note: the lines enclose {plural(count, 'area')}: the largest, {face.area:.1f} m² about "
        f"{at}, is taken; --from X,Y takes that with the point"
    )


def _check_no_doubt(path: Path, drawing: Drawing, face: Any, loose: list[Any]) -> None:
    """Refuse an area that may be the inside of a wall or of a thing, and not the place."""
    at = shapely.get_coordinates(face.exterior)[0]
    what = f"the largest area that the lines enclose, {face.area:.3g} m² about "
    what += place(face.representative_point().coords[0])
    beyond = beyond_of(face, loose)
    if beyond > OUTSIDE * face.exterior.length:
        said, at = open_ends(drawing)
        message = f"{what}, is hardly the place: {beyond:.3g} m of lines beyond it enclose nothing "
        message += f"({said}); leave them out, {ADVICE}"
        raise drawing.refused_at(path, message, at, "boundary")
    others = beyond_of(face, [shapely.LineString(line) for line in drawing.boundaries])
    if others > OTHERS * face.exterior.length:
        message = f"{what}, is hardly the place: there are {others:.3g} m of walls beyond it; {SAY}"
        raise drawing.refused_at(path, message, at, "boundary")
    about = _walls_about(drawing, face)
    if about is not None and about.area < APART * about.convex_hull.area:
        message = f"{what}, seems to be the inside of a wall that others meet, and the room between"
        message += f" them open{_where_open(drawing, about.convex_hull.centroid)}; {ADVICE}"
        raise drawing.refused_at(path, message, at, "boundary")
    is_thin = 2.0 * face.area < THIN * face.length
    if is_thin and shapely.buffer(face, -0.5 * DIAGONAL * THIN, quad_segs=2).is_empty:
        message = f"{what}, is not wider than {THIN} m: it seems to be the inside of a wall"
        message += f"{_where_open(drawing, None)}; {ADVICE}, and check --scale"
        raise drawing.refused_at(path, message, at, "boundary")


def _walls_about(drawing: Drawing, face: Any) -> Any:
    """The one outline that a face is within, with those that meet it, as one shapely shape.

    Of those that are known to be solid none is such a one.
    """
    solids = shapely.union_all([*drawing.solids, *drawing.painted])
    shapely.prepare(solids)
    lines = [line for line in drawing.boundaries if is_closed(line) and len(line) > 3]
    closed = [shapely.Polygon(line) for line in lines]
    closed = [one for one in closed if not solids.contains(one.representative_point())]
    point = face.representative_point()
    around = [one for one in closed if one.covers(point)]
    if len(around) != 1:
        return None
    others = [one for one in closed if one.intersects(around[0]) and not around[0].covers(one)]
    return shapely.union_all([around[0], *others]) if others else None
