"""Which obstacles stand right across the way, so that none can pass."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from physim.errors import Fault, place_text
from physim.geometry.area import accessible_area, united
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH

MOST_TRIED = 20
"""Obstacles of a group that are left out one by one, to find those that it needs"""


def cut_faults(
    boundaries: Sequence[FloatArray], obstacles: dict[int, FloatArray], reference: FloatArray
) -> list[Fault]:
    """A fault for each obstacle, by number, that cuts the way along the reference path in two.

    Obstacles that touch one another may do it together. None where there is a way around them.
    """
    line = shapely.LineString(reference)
    solids = {k: shapely.Polygon(ring) for k, ring in obstacles.items()}
    groups = [
        group for group in _touching(solids) if any(solids[k].intersects(line) for k in group)
    ]
    if not groups:
        return []
    face = accessible_area(boundaries, [], reference).polygon
    faults = []
    for group in groups:
        if not _cut(face, [solids[k] for k in group], line):
            continue
        group = _needed(face, {k: solids[k] for k in group}, line)
        within = shapely.points(shapely.get_coordinates(
            united([solids[k] for k in group]).intersection(line)
        ))  # fmt: skip
        station = float(shapely.line_locate_point(line, within).min())
        x, y = shapely.get_coordinates(line.interpolate(station))[0]
        for k in group:
            others = ", ".join(f"obstacles[{other}]" for other in group if other != k)
            together = f", with {others}," if others else ""
            message = (
                f"stands{together} right across the way at {place_text(x, y)}, {station:.2f} m "
                "along the reference path, so that no robot can pass; make it smaller, move or "
                "remove it"
            )
            faults.append(Fault(("obstacles", k), message))
    return faults


def _touching(solids: dict[int, Any]) -> list[list[int]]:
    """Numbers of the solids in groups of those that touch one another."""
    keys, shapes = list(solids), np.array([*solids.values()], dtype=object)
    pairs = shapely.STRtree(shapes).query(shapes, predicate="intersects").T if keys else []
    group = {key: [key] for key in keys}
    for i, j in pairs:
        one, other = group[keys[i]], group[keys[j]]
        if one is not other:
            one += other
            group.update(dict.fromkeys(other, one))
    return [sorted(one) for key, one in group.items() if one[0] == key]


def _needed(face: Any, group: dict[int, Any], line: Any) -> list[int]:
    """Of a group that cuts the way those that do so alone, or else all without which it does not.

    Of very many all.
    """
    alone = [k for k, solid in group.items() if _cut(face, [solid], line)]
    if alone or len(group) > MOST_TRIED:
        return alone or list(group)
    kept = dict(group)
    for k in group:
        rest = {key: solid for key, solid in kept.items() if key != k}
        if _cut(face, list(rest.values()), line):
            kept = rest
    return list(kept)


def _cut(face: shapely.Polygon, solids: Sequence[Any], line: Any) -> bool:
    """Whether solids leave the first and the last of a line within a face in different parts."""
    parts = shapely.get_parts(face.difference(united(solids)))
    free = [(part, part.intersection(line)) for part in parts]
    stations = [
        [float(shapely.line_locate_point(line, point)) for point in shapely.points(
            shapely.get_coordinates(within))]
        for _, within in free if within.length > LENGTH
    ]  # fmt: skip
    if len(stations) < 2:
        return False
    return int(np.argmin([min(one) for one in stations])) != int(
        np.argmax([max(one) for one in stations])
    )
