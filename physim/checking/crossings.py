"""Where polylines cross each other or themselves; touching ends are no crossings."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from physim.checking.telling import MOST_ALIKE
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH


def crossings(lines: list[FloatArray]) -> list[tuple[int, int, tuple[float, float]]]:
    """Pairs of polylines that meet elsewhere than at an end of one of them, and where first."""
    shapes = [shapely.LineString(line) for line in lines]
    if len(shapes) < 2:
        return []
    tree = shapely.STRtree(shapes)
    found = []
    for a, b in np.transpose(tree.query(shapes, predicate="intersects")):
        if a >= b:
            continue
        meeting = shapely.get_coordinates(shapes[a].intersection(shapes[b]))
        ends = np.array([lines[a][0], lines[a][-1], lines[b][0], lines[b][-1]])
        inner = [p for p in meeting if np.hypot(*(ends - p).T).min() > LENGTH]
        if inner and not _only_runs_along(shapes[a], shapes[b]):
            found.append((int(a), int(b), (float(inner[0][0]), float(inner[0][1]))))
        if len(found) >= 10 * MOST_ALIKE:
            break
    return found


def _only_runs_along(a: Any, b: Any) -> bool:
    """Whether two polylines share stretches only: a wall drawn twice does no harm."""
    common = a.intersection(b)
    points = [p for p in shapely.get_parts(common) if p.geom_type == "Point"]
    return common.length > 0.0 and not points


def self_crossings(line: FloatArray) -> list[tuple[float, float]]:
    """Points where a polyline crosses or touches itself, its own ends left out."""
    if len(line) < 3 or shapely.LineString(line).is_simple:
        return []
    segments = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    tree = shapely.STRtree(segments)
    first, second = tree.query(segments, predicate="intersects")
    apart = second > first
    first, second = first[apart], second[apart]
    places = shapely.intersection(segments[first], segments[second])
    found: dict[tuple[float, float], None] = {}
    for a, b, place in zip(first, second, places, strict=True):
        for point in shapely.get_coordinates(place):
            is_joint = b == a + 1 and place.length == 0.0
            at_end = np.hypot(*(line[[0, -1]] - point).T).min() <= LENGTH
            if not is_joint and not at_end:
                found[float(point[0]), float(point[1])] = None
        if len(found) > MOST_ALIKE:
            break
    return list(found)
