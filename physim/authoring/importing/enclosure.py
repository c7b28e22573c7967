"""The area that drawn lines enclose: checked, closed where ends nearly meet, and chosen.

What is too small or too crooked to become a world is found before any shape is made of it.
Lines away from the area of the robots are dropped.
"""

from __future__ import annotations

from itertools import compress
from operator import not_
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import DIGITS, Drawing, listed, place, refused, rounded
from physim.authoring.importing.lines import is_closed
from physim.authoring.importing.places import chosen_area, place_of
from physim.errors import plural
from physim.geometry.area import inner_lines
from physim.geometry.shapes import FloatArray
from physim.geometry.thinning import simplified
from physim.world.layout.shape_checks import crossings, self_crossings

SMALLEST_PLACE, LARGEST_PLACE = 1.0, 10_000.0
"""[m] extent below which a place is refused, and above which its scale is doubted"""
SPECK = 2.0 * 10.0**-DIGITS
"""[m] extent up to which a shape that became a point or a line was but a grain"""
MOST_OBSTACLES = 3_000
DENSE = 5_000
"""Points of walls and obstacles from which on those that hardly matter are left out."""


def check_sound(path: Path, drawing: Drawing) -> None:
    """Refuse a place, path, obstacle or robot of which no shape can be made.

    Walls and obstacles that vanish when they are rounded to the millimetre are left out and listed.
    Raises ImportSourceError.
    """
    if drawing.boundaries:
        check_size(path, np.ptp(np.vstack(drawing.boundaries), axis=0))
    short = [line for line in drawing.boundaries if len(line) < 2]
    drawing.changes += listed(
        short, lambda line: f"boundary at {place(line[0])}: shorter than a millimetre, left out"
    )
    drawing.boundaries = [line for line in drawing.boundaries if len(line) > 1]
    named = [(f"path of {name}", line) for name, line in drawing.paths.items()]
    for what, line in (("path", drawing.reference), *named):
        if line is not None and len(line) < 2:
            message = f"the {what} at {place(line[0])} is shorter than a millimetre; check --scale"
            raise drawing.refused_at(path, message, line[0], "path")
    for robot in drawing.robots:
        if not _has_area(robot.outline):
            message = (
                f"a robot {_at(robot.outline)}has no area; draw its outline, and check --scale"
            )
            raise drawing.refused_at(path, message, robot.outline[0], "robot")
        _check_simple(path, drawing, "robot", robot.outline)
    drawing.obstacles = _obstacles(path, drawing)


def check_size(path: Path, extent: FloatArray) -> None:
    """Refuse a place whose ``extent`` (2,) [m] in x and y is too small for robots."""
    if max(extent) < SMALLEST_PLACE:
        raise refused(
            path,
            f"the place is {extent[0]:.3g} x {extent[1]:.3g} m; --scale M says how many metres a "
            "unit of the source is",
        )


def _obstacles(path: Path, drawing: Drawing) -> list[FloatArray]:
    """Obstacles with area; grains are listed, and what has none otherwise is refused."""
    closed = sum(is_closed(line) for line in drawing.boundaries)
    for count, what in ((len(drawing.obstacles), "obstacles"), (closed, "closed walls")):
        if count > MOST_OBSTACLES:
            raise refused(
                path,
                f"{count} {what}; at most {MOST_OBSTACLES} are read; leave out small ones, or draw "
                "those that touch as one",
            )
    kept, grains = [], []
    for ring in drawing.obstacles:
        if _has_area(ring):
            _check_simple(path, drawing, "obstacle", ring)
            kept.append(ring)
        elif len(ring) and np.ptp(ring, axis=0).max() > SPECK:
            message = f"an obstacle {_at(ring)}encloses no area; draw its outline"
            raise drawing.refused_at(path, message, ring[0], "obstacle")
        else:
            grains.append(ring)
    drawing.changes += listed(
        grains, lambda ring: f"obstacle {_at(ring)}is smaller than a millimetre, left out"
    )
    return kept


def _check_simple(path: Path, drawing: Drawing, role: str, ring: FloatArray) -> None:
    """Refuse an outline that crosses or touches itself: its inside would be a guess."""
    shape = shapely.Polygon(ring)
    if not shape.is_valid:
        reason = shapely.is_valid_reason(shape)
        message = (
            f"{'an' if role == 'obstacle' else 'a'} {role} {_at(ring)}crosses or touches itself "
            f"({reason}); its corners must go once round the outline"
        )
        raise drawing.refused_at(path, message, ring[0], role)


def _at(ring: FloatArray) -> str:
    return f"at {place(ring[0])} " if len(ring) else ""


def _has_area(ring: FloatArray) -> bool:
    """Whether an outline (n, 2) [m] is more than a line."""
    return len(ring) > 2 and bool(shapely.MultiPoint(ring).convex_hull.area > 1e-9)


def thin_out(drawing: Drawing, within: float) -> bool:
    """Leave out points of walls and obstacles, where there are very many, and say so.

    Whether there are.

    They stay ``within`` [m] of where they are. Every point would be looked at in every run.
    """
    lines = [*drawing.boundaries, *drawing.obstacles]
    points = sum(map(len, lines))
    if points <= DENSE or drawing.area is not None:
        return False
    drawing.boundaries = [simplified(line, within) for line in drawing.boundaries]
    drawing.obstacles = [_thinned_ring(ring, within) for ring in drawing.obstacles]
    left = sum(map(len, (*drawing.boundaries, *drawing.obstacles)))
    if left < points:
        drawing.changes.append(
            f"{points - left} of {points} points of walls and obstacles left out, which lie within "
            f"{within:g} m of a line between others (--tolerance)"
        )
    return True


def _thinned_ring(ring: FloatArray, within: float) -> FloatArray:
    thin = simplified(np.vstack([ring, ring[:1]]), within)[:-1] if len(ring) > 3 else ring
    return thin if len(thin) > 2 else ring


HALF_WALL = 0.0005
"""[m] Half the thickness that a wall in the area is given: that of the rounding of its points."""
NEAR = 1e-6
"""[m] A line this near the area bounds it."""


def enclose(path: Path, drawing: Drawing, inside: tuple[float, float] | None) -> None:
    """Find the area of a drawing; drop and list the lines that do not bound it.

    The area is the one that `place_of` takes, without walls that stand in it: between two rooms of
    a plan, for example, a wall ends at a door. Raises ImportSourceError when nothing is enclosed,
    when neither the reference path is nor, without one, the point ``inside``, and when it is in
    doubt whether what is enclosed is a place or a wall.
    """
    face, loose = place_of(path, drawing, inside)
    lines, rings = drawing.boundaries, drawing.obstacles
    near = [face.distance(shapely.LineString(line)) <= NEAR for line in lines]
    solid = [face.intersects(shapely.Polygon(ring)) for ring in rings]
    drawing.changes += listed(list(compress(lines, map(not_, near))), _dropped_boundary)
    drawing.changes += listed(list(compress(rings, map(not_, solid))), _dropped_obstacle)
    drawing.boundaries = list(compress(lines, near))
    drawing.obstacles = list(compress(rings, solid))
    inner = inner_lines(face, loose)
    _unite(drawing, face, inner)
    solids = [shapely.Polygon(ring) for ring in drawing.obstacles]
    walls = [shapely.buffer(inner, HALF_WALL, cap_style="square")]
    free = face.difference(shapely.union_all(solids + walls))
    if free.is_empty:
        message = "the obstacles leave no place for robots; they cover the whole area"
        largest = max(drawing.obstacles, key=lambda ring: float(shapely.Polygon(ring).area))
        raise drawing.refused_at(path, message, largest[0], "obstacle")
    drawing.area = chosen_area(shapely.get_parts(free), drawing, inside)


def _unite(drawing: Drawing, face: Any, inner: Any) -> None:
    """Replace boundaries that cross by the outline of the area, and what of them stands in it.

    A world refuses them, and plans are drawn so: thick walls, one over the other at the corners.
    """
    lines = drawing.boundaries
    if not crossings(lines) and not any(map(self_crossings, lines)):
        return
    drawing.boundaries, obstacles = [], len(drawing.obstacles)
    drawing.add_outline(_largest(shapely.set_precision(face, 10.0**-DIGITS)))
    for edge in shapely.get_parts(inner):
        if len(line := rounded(shapely.get_coordinates(edge))) > 1:
            drawing.boundaries.append(line)
    points = sum(map(len, [*drawing.boundaries, *drawing.obstacles[obstacles:]]))
    drawing.changes.append(
        f"{plural(len(lines), 'boundary crosses itself', 'boundaries cross')}: the outline of the "
        f"area is taken instead, {plural(points, 'point')}"
    )


def _largest(shape: Any) -> Any:
    """The largest part of a shape."""
    return max(shapely.get_parts(shape), key=lambda one: float(one.area))


def _dropped_boundary(points: FloatArray) -> str:
    length = shapely.LineString(points).length
    return (
        f"boundary of {length:.2f} m from {place(points[0])} to {place(points[-1])}: away from the "
        "area of the robots, dropped"
    )


def _dropped_obstacle(ring: FloatArray) -> str:
    polygon = shapely.Polygon(ring)
    return (
        f"obstacle of {polygon.area:.3f} m² at {place(polygon.centroid.coords[0])}: away from the "
        "area of the robots, dropped"
    )
