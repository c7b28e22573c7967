"""Faults of shapes and of places: with shapely, independent of the compiled kernels.

An outline is looked at before areas or convex parts are worked out; then what a robot stands in at
the start.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike

from physim.errors import Fault, place_text
from physim.geometry.polygon import corners, is_simple, least_width
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT, LENGTH
from physim.units import figure
from physim.world.faults import describe
from physim.world.ground.lines import placed_outline
from physim.world.scene import Layout
from physim.world.walls import stretch_text

MOST_REPORTED = 3
"""Bodies that one robot overlaps which are reported one by one."""
MOST_PAIRS = 200
"""Pairs of robots which are reported one by one."""


def corners_of_line(line: ArrayLike) -> FloatArray:
    """Points (n, 2) of a polyline without neighbours closer than ``LENGTH``."""
    points = np.asarray(line, dtype=np.float64).reshape(-1, 2)
    steps = np.hypot(*np.diff(points, axis=0).T)
    keep = np.concatenate((np.ones(min(len(points), 1), dtype=bool), steps > LENGTH))
    return np.asarray(points[keep], dtype=np.float64)


def outline_fault(outline: ArrayLike) -> str:
    """What is wrong with an outline; empty when it is simple and encloses an area."""
    points = corners(outline)
    if len(points) < 3:
        return "has fewer than three distinct corners; a polygon with area is needed"
    if least_width(points) <= LENGTH:
        return "encloses no area; a polygon with area is needed"
    if is_simple(points):
        return ""
    reason = shapely.is_valid_reason(shapely.Polygon(points))
    place = reason[reason.find("[") + 1 : -1].split() if "[" in reason else []
    near = f" at {place_text(float(place[0]), float(place[1]))}" if len(place) == 2 else ""
    return f"crosses or touches itself{near}; the corners must go once round the outline"


def standing_faults(laid: Layout) -> list[Fault]:
    """Robots that stand in or against a wall, an obstacle or another, or outside of the area."""
    bodies, area = [*laid.walls, *laid.solids], laid.area.polygon
    names = [describe(name) for name in laid.names]
    shapes = [placed_outline(*one) for one in zip(laid.footprints, laid.start, strict=True)]
    shapely.prepare(area)
    near: list[list[int]] = [[] for _ in shapes]
    for i, k in _pairs(shapes, [body for _, body in bodies]):
        near[i].append(k)
    faults = []
    for i, (name, shape) in enumerate(zip(names, shapes, strict=True)):
        where = (*laid.entry_key(i), "pose")
        for k in near[i][:MOST_REPORTED]:
            label, body = bodies[k]
            said, depth = ("overlaps {} by at least {}", _depth(shape, body))
            if k < len(laid.walls):
                said, depth = ("reaches {1} over {0}", _reach(shape, body, area))
            said = said if depth > CONTACT else "touches {}"
            place = stretch_text(laid.world.boundaries, label, _meeting(shape, body))
            remedy = "move it away" + (", or make it smaller" if len(near[i]) > 1 else "")
            said = said.format(label, f"{figure(depth)} m")
            faults.append(Fault(where, f"{name} {said} {place} at the start; {remedy}"))
        if not near[i] and not area.covers(shape):
            far = area.distance(shape)
            away = f", {figure(far)} m from it" if far > 0.0 else ""
            message = f"{name} starts outside the accessible area{away}; move it inside"
            faults.append(Fault(where, message))
    for i, j in [pair for pair in _pairs(shapes, shapes) if pair[0] < pair[1]][:MOST_PAIRS]:
        depth = _depth(shapes[i], shapes[j])
        said = f"overlaps {names[i]} by at least {figure(depth)} m"
        said = said if depth > CONTACT else f"touches {names[i]}"
        message = f"{names[j]} {said} at the start; move them apart"
        faults.append(Fault((*laid.entry_key(j), "pose"), message))
    return faults


def _pairs(some: Sequence[Any], others: Sequence[Any]) -> list[tuple[int, int]]:
    """Numbers of shapes that touch or overlap, in order."""
    pairs = shapely.STRtree(others).query(some, predicate="dwithin", distance=CONTACT)
    return sorted((int(i), int(k)) for i, k in pairs.T)


def _reach(shape: Any, wall: Any, area: Any) -> float:
    """How far [m] a robot that meets a wall reaches beyond it, out of the area."""
    beyond = shape.difference(area)
    if beyond.is_empty or not shape.intersects(wall):
        return 0.0
    parts = shapely.get_parts(beyond)
    points = shapely.points(shapely.get_coordinates(parts[shapely.dwithin(parts, wall, CONTACT)]))
    return float(shapely.distance(points, area).max(initial=0.0))


def _depth(shape: Any, body: Any) -> float:
    """The least width [m] of what two have in common: one deep in another has to go farther."""
    common = shape.intersection(body)
    return least_width(shapely.get_coordinates(common)) if common.area > 0.0 else 0.0


def _meeting(shape: Any, body: Any) -> FloatArray:
    """A point (2,) [m] of a boundary or obstacle: in the middle of what a robot has most of it."""
    common = shape.intersection(body)
    if common.is_empty:  # it only touches
        common = shapely.shortest_line(body, shape)
    most = max(shapely.get_parts(common), key=lambda part: (part.area, part.length))
    is_line = most.geom_type == "LineString"
    at = most.interpolate(0.5, normalized=True) if is_line else most.representative_point()
    return np.asarray(shapely.get_coordinates(at)[0], dtype=np.float64)


MOST_GAPS = 3
"""Gaps between boundaries that one message names."""
MOST_SEARCHED = 300
"""Boundaries among which gaps are looked for."""


def gaps(labels: list[str], lines: list[FloatArray]) -> str:
    """Loose ends of boundaries, nearest to another wall first, with the size of the gap.

    ``labels`` are what to call them.
    """
    shapes = [shapely.LineString(line) for line in lines[:MOST_SEARCHED]]
    found: dict[tuple[float, frozenset[str]], str] = {}
    for k, line in enumerate(lines[:MOST_SEARCHED]):
        for end in line[[0, -1]]:
            others = [(shapely.Point(end).distance(s), labels[m]) for m, s in enumerate(shapes)]
            others[k] = float(np.hypot(*(line[0] - line[-1]))), "its own other end"
            size, other = min(others)
            said = f"{labels[k]} ends at {place_text(*end)}, {figure(size)} m from {other}"
            if size > 0.0:
                found.setdefault((size, frozenset((labels[k], other))), said)
    if not found:
        return "boundaries must enclose an area around the reference path"
    nearest = sorted(found, key=lambda gap: gap[0])[:MOST_GAPS]
    return "join the ends: " + ", ".join(found[gap] for gap in nearest)
