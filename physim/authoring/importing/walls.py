"""Walls that a source of polygons draws with their thickness: solid, and one where they meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import shapely

from physim.authoring.importing.drawing import DIGITS, Drawing
from physim.authoring.importing.work import lines_of
from physim.errors import plural


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

    On the millimetre grid: rounded each by itself, walls that meet at an angle would part. A single
    one without holes is the outline of a place, and not solid.
    """
    united = polygons_of(shapely.union_all([made_valid(one) for one in walls], 10.0**-DIGITS))
    drawing.boundaries += [line for one in united for line in lines_of(one)]
    if len(walls) > 1 or any(len(one.interiors) for one in walls):
        drawing.solids = united
    if len(united) < len(walls):
        met = plural(len(walls), "wall")
        drawing.changes.append(
            f"{met} that meet or cross: united, {plural(len(united), 'outline')}"
        )
