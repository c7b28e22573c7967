"""Where polylines cross each other or themselves, and where they leave gaps.

Touching ends are no crossings.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH

MOST_FOUND = 50
"""Crossings of boundaries, and a tenth of it of one with itself, after which no more are sought"""
MOST_GAPS = 3
"""Gaps between boundaries that one message names."""
MOST_SEARCHED = 300
"""Boundaries among which gaps are looked for."""


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
        if len(found) >= MOST_FOUND:
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
        if len(found) > MOST_FOUND // 10:
            break
    return list(found)


def self_overlap(centreline: FloatArray, walls: list[FloatArray]) -> str:
    """How two legs of a corridor run into each other, walls of one in the other; empty if not.

    ``walls`` left, right and the caps. To be called where the centreline leaves the area between.
    """
    found = crossings(walls)
    if not found:
        return ""
    place = shapely.Point(found[0][2])
    legs = shapely.linestrings(np.stack([centreline[:-1], centreline[1:]], axis=1))
    away = shapely.distance(legs, place)
    one = int(np.argmin(away))
    apart = np.abs(np.arange(len(legs)) - one) > 1
    if not apart.any():
        return ""
    other = int(np.argmin(np.where(apart, away, np.inf)))
    first, second = sorted((one, other))
    return (
        f"the corridor runs into itself at ({place.x:.6g}, {place.y:.6g}): the leg from [{first}] "
        f"to [{first + 1}] and the leg from [{second}] to [{second + 1}] have less than the width "
        "between them; part them, or draw boundaries instead, which may close on themselves"
    )


def gaps(labels: list[str], lines: list[FloatArray]) -> str:
    """Loose ends of boundaries, nearest to another wall first, with the size of the gap.

    ``labels`` are what to call them.
    """
    shapes = [shapely.LineString(line) for line in lines[:MOST_SEARCHED]]
    found: list[tuple[float, str, Any, str]] = []
    for k, (name, line) in enumerate(zip(labels, lines[:MOST_SEARCHED], strict=False)):
        for end in (0, -1):
            point = shapely.Point(line[end])
            others = [(point.distance(s), labels[m]) for m, s in enumerate(shapes) if m != k]
            others.append((float(np.hypot(*(line[0] - line[-1]))), "its own other end"))
            size, other = min(others)
            is_known = any(size == gap[0] and {name, other} == {gap[1], gap[3]} for gap in found)
            if size > 0.0 and not is_known:
                found.append((size, name, point, other))
    if not found:
        return "boundaries must close a face around the reference path"
    found.sort(key=lambda gap: gap[0])
    ends = [
        f"{name} ends at ({point.x:.6g}, {point.y:.6g}), {size:.4g} m from {other}"
        for size, name, point, other in found[:MOST_GAPS]
    ]
    return "join the ends: " + ", ".join(ends)
