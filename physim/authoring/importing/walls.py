"""Walls that are drawn with their thickness: solid, and one where they meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import DIGITS, Drawing, rounded
from physim.authoring.importing.joining import faces_of, knit
from physim.authoring.importing.work import lines_of
from physim.errors import plural
from physim.geometry.shapes import FloatArray


def polygons_of(shape: Any) -> list[Any]:
    """Polygons with area among the parts of a shape."""
    return [one for one in shapely.get_parts(shape) if one.geom_type == "Polygon" and one.area > 0]


def made_valid(shape: Any) -> Any:
    """A polygon as one or more that do not cross themselves.

    Holes are taken out of what is within the outline, also where they touch or cross it.
    """
    return shapely.make_valid(shape, method="structure", keep_collapsed=False)


def is_thick(wall: Any) -> bool:
    """Whether a wall has area on the millimetre grid; of another its lines are walls."""
    return bool(polygons_of(shapely.set_precision(made_valid(wall), 10.0**-DIGITS)))


def take_walls(drawing: Drawing, walls: Sequence[Any]) -> None:
    """Take the outlines of walls with area, of those that meet or cross as one.

    On the millimetre grid, and with the corners of each in the sides of others that they lie on:
    rounded each by itself, walls that meet at an angle would part.
    """
    lines = [rounded(line) for wall in walls for line in lines_of(wall)]
    knit(lines, [k for k, wall in enumerate(walls) for _ in lines_of(wall)])
    rings, knitted = iter(lines), []
    for wall in walls:
        shell, *holes = (next(rings) for _ in lines_of(wall))
        knitted.append(shapely.Polygon(shell, [hole for hole in holes if len(hole) > 3]))
    united = polygons_of(
        shapely.union_all([made_valid(one) for one in knitted], grid_size=10.0**-DIGITS)
    )
    drawing.boundaries += [line for one in united for line in lines_of(one)]
    drawing.solids = united
    if len(united) < len(walls):
        met = plural(len(walls), "wall")
        drawing.changes.append(
            f"{met} that meet or cross: united, {plural(len(united), 'outline')}"
        )


def painted(rings: Sequence[FloatArray], is_even_odd: bool) -> list[Any]:
    """Shapely polygons of what closed lines (n, 2) [m] of one painted shape fill, by its fill-rule.

    A line within another is a hole if it is drawn the other way round, or in any case (even-odd).
    """
    rings = [ring for ring in rings if len(ring) > 3]
    if not (faces := faces_of(list(rings))):
        return []
    inside = [face.representative_point() for face in faces]
    boxes = shapely.STRtree([shapely.LineString(ring) for ring in rings])
    turns = np.zeros(len(faces), int)
    for k, ring in boxes.query(inside).T:  # those whose box has the point in it
        turns[k] += _turns_about(rings[ring], inside[k])
    filled = turns % 2 if is_even_odd else turns
    return [face for face, is_filled in zip(faces, filled, strict=True) if is_filled]


def _turns_about(ring: FloatArray, point: Any) -> int:
    """How often a closed line goes round a shapely point, by where it crosses a ray from it."""
    (x0, y0), (x1, y1) = ring[:-1].T, ring[1:].T
    is_level = (y0 > point.y) != (y1 > point.y)
    along = (point.y - y0[is_level]) / (y1 - y0)[is_level]
    is_right = x0[is_level] + along * (x1 - x0)[is_level] > point.x
    return int(np.sign(y1 - y0)[is_level][is_right].sum())
