"""Which obstacles stand right across the way, so that none can pass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import shapely

from physim.errors import Fault, place_text
from physim.geometry.area import accessible_area
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH


def cut_faults(
    boundaries: Sequence[FloatArray], obstacles: dict[int, FloatArray], reference: FloatArray
) -> list[Fault]:
    """A fault for each obstacle, by number, that cuts the way along the reference path in two.

    Where none does so alone, those that the reference path leads through do it together. None
    where there is a way around them.
    """
    line = shapely.LineString(reference)
    solids = {k: shapely.Polygon(ring) for k, ring in obstacles.items()}
    met = {k: solid for k, solid in solids.items() if _through(line, solid).length > LENGTH}
    if not met:
        return []
    face = accessible_area(boundaries, [], reference).polygon
    if not _are_apart(face, [*solids.values()], line):
        return []
    alone = [k for k, solid in met.items() if _are_apart(face, [solid], line)]
    faults = []
    for k in alone or met:
        within = shapely.points(shapely.get_coordinates(_through(line, met[k])))
        station = float(shapely.line_locate_point(line, within).min())
        x, y = shapely.get_coordinates(line.interpolate(station))[0]
        others = ", ".join(f"obstacles[{other}]" for other in met if other != k and not alone)
        together = f", with {others}," if others else ""
        message = (
            f"stands{together} right across the way at {place_text(x, y)}, {station:.2f} m along"
            " the reference path, so that no robot can pass; make it smaller, move or remove it"
        )
        faults.append(Fault(("obstacles", k), message))
    return faults


def _through(line: Any, solid: Any) -> Any:
    """The part of a line within a solid."""
    return shapely.intersection(line, solid)


def _are_apart(face: shapely.Polygon, solids: Sequence[Any], line: Any) -> bool:
    """Whether a line runs through more than one part of what solids leave of a face."""
    parts = shapely.get_parts(face.difference(shapely.union_all(solids)))
    return int((shapely.length(shapely.intersection(parts, line)) > LENGTH).sum()) > 1
