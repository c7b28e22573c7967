"""Faults of shapes and of places: with shapely, independent of the compiled kernels.

An outline is looked at before areas or convex parts are worked out; then what a robot stands in at
the start. Polylines may touch at their ends: these are no
crossings.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import ArrayLike

from physim.errors import Fault, Location, place_text
from physim.geometry.polygon import (
    corners,
    is_simple,
    least_width,
)
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT, LENGTH
from physim.world.faults import describe
from physim.world.scene import Layout
from physim.world.walls import stretch_text

MOST_REPORTED = 3
"""Bodies that one robot overlaps which are reported one by one."""
MOST_PAIRS = 200
"""Pairs of robots which are reported one by one."""


class Placed(NamedTuple):
    """A robot where it starts."""

    where: Location
    """its pose, as written"""
    name: str
    shape: Any
    """its outline as a shapely polygon in the world frame"""


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
    if is_simple(points):
        thin = least_width(points)
        return "" if thin > LENGTH else f"is only {thin:.2g} m wide; a polygon with area is needed"
    ring = shapely.Polygon(points)
    if least_width(points) <= LENGTH:
        return "encloses no area; a polygon with area is needed"
    reason = shapely.is_valid_reason(ring)
    place = reason[reason.find("[") + 1 : -1].split() if "[" in reason else []
    near = f" at {place_text(float(place[0]), float(place[1]))}" if len(place) == 2 else ""
    return f"crosses or touches itself{near}; the corners must go once round the outline"


def wall_faults(laid: Layout, robots: Sequence[Placed]) -> list[Fault]:
    """Robots in or against a boundary or obstacle, or outside the accessible area."""
    walls, solids = laid.walls, laid.solids
    accessible, boundaries = laid.area.polygon, laid.world.boundaries
    shapes = [robot.shape for robot in robots]
    tree = shapely.STRtree([shape for _, shape in (*walls, *solids)])
    near: list[list[int]] = [[] for _ in robots]
    for i, k in np.transpose(tree.query(shapes, predicate="dwithin", distance=CONTACT)):
        near[i].append(int(k))
    shapely.prepare(accessible)
    faults = []
    for i, (where, given, shape) in enumerate(robots):
        name = describe(given)
        for k in sorted(near[i])[:MOST_REPORTED]:
            label, body = (*walls, *solids)[k]
            if k < len(walls):
                contact = _boundary_message(shape, label, body, accessible)
            else:
                contact = _overlap(shape, body, label)
            place = stretch_text(boundaries, label, _meeting(shape, body))
            remedy = "move it away" + (", or make it smaller" if len(near[i]) > 1 else "")
            faults.append(Fault(where, f"{name} {contact} {place} at the start; {remedy}"))
        if not near[i] and not accessible.covers(shape):
            far = accessible.distance(shape)
            away = f", {far:.4g} m from it" if far > 0.0 else ""
            message = f"{name} starts outside the accessible area{away}; move it inside"
            faults.append(Fault(where, message))
    return faults


def _boundary_message(shape: Any, label: str, wall: Any, accessible: Any) -> str:
    beyond = shape.difference(accessible)
    if beyond.is_empty or not shape.intersects(wall):
        return f"touches {label}"
    parts = shapely.get_parts(beyond)  # those over this wall
    points = shapely.points(shapely.get_coordinates(parts[shapely.dwithin(parts, wall, CONTACT)]))
    reach = float(shapely.distance(points, accessible).max(initial=0.0))
    return f"touches {label}" if reach <= CONTACT else f"reaches {reach:.4g} m over {label}"


def _meeting(shape: Any, body: Any) -> FloatArray:
    """A point (2,) [m] of a boundary or obstacle: in the middle of what a robot has most of it."""
    common = shape.intersection(body)
    if common.is_empty:  # it only touches
        common = shapely.shortest_line(body, shape)
    most = max(shapely.get_parts(common), key=lambda part: (part.area, part.length))
    is_line = most.geom_type == "LineString"
    at = most.interpolate(0.5, normalized=True) if is_line else most.representative_point()
    return np.asarray(shapely.get_coordinates(at)[0], dtype=np.float64)


def _overlap(a: Any, b: Any, label: str) -> str:
    """``overlaps LABEL by at least D m``: the least width of the common area; one robot deep in
    another has to be moved farther."""
    common = a.intersection(b)
    depth = least_width(shapely.get_coordinates(common)) if common.area > 0.0 else 0.0
    return f"overlaps {label} by at least {depth:.4g} m" if depth > CONTACT else f"touches {label}"


def robot_faults(robots: Sequence[Placed]) -> list[Fault]:
    """Pairs of robots that overlap or touch, reported at the later one."""
    shapes = [robot.shape for robot in robots]
    tree = shapely.STRtree(shapes)
    pairs = np.transpose(tree.query(shapes, predicate="dwithin", distance=CONTACT))
    faults = []
    for i, j in sorted((int(i), int(j)) for i, j in pairs if i < j)[:MOST_PAIRS]:
        first, second = robots[i], robots[j]
        contact = _overlap(second.shape, first.shape, describe(first.name))
        message = f"{describe(second.name)} {contact} at the start; move them apart"
        faults.append(Fault(second.where, message))
    return faults


MOST_FOUND = 50
"""Crossings of boundaries after which no more are sought"""
MOST_GAPS = 3
"""Gaps between boundaries that one message names."""
MOST_SEARCHED = 300
"""Boundaries among which gaps are looked for."""


def crossings(lines: list[FloatArray]) -> list[tuple[int, int, tuple[float, float]]]:
    """Pairs of polylines that meet elsewhere than at an end of one of them, and where first.

    Two that share stretches only, as of a wall drawn twice, do no harm.
    """
    shapes = np.array([shapely.LineString(line) for line in lines])
    found = []
    for a, b in shapely.STRtree(shapes).query(shapes, predicate="intersects").T.tolist():
        if a >= b:
            continue
        common = shapes[a].intersection(shapes[b])
        ends = np.vstack([lines[k][[0, -1]] for k in (a, b)])
        inner = [p for p in shapely.get_coordinates(common) if _away(ends, p) > LENGTH]
        kinds = {part.geom_type for part in shapely.get_parts(common)}
        if inner and "Point" in kinds:
            found.append((a, b, (float(inner[0][0]), float(inner[0][1]))))
        if len(found) >= MOST_FOUND:
            break
    return found


def self_crossings(line: FloatArray) -> list[tuple[float, float]]:
    """Points where a polyline crosses or touches itself, its own ends left out."""
    if len(line) < 3 or shapely.LineString(line).is_simple:
        return []
    segments = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    first, second = shapely.STRtree(segments).query(segments, predicate="intersects")
    first, second = first[second > first], second[second > first]
    common = shapely.intersection(segments[first], segments[second])
    apart = common[(second > first + 1) | (shapely.length(common) > 0.0)]  # no mere joints
    met = shapely.get_coordinates(apart)
    places = dict.fromkeys((float(x), float(y)) for x, y in met)
    return [at for at in places if _away(line[[0, -1]], np.array(at)) > LENGTH]


def _away(points: FloatArray, place: FloatArray) -> float:
    return float(np.hypot(*(points - place).T).min())


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
        return "boundaries must enclose an area around the reference path"
    found.sort(key=lambda gap: gap[0])
    ends = [
        f"{name} ends at {place_text(point.x, point.y)}, {size:.4g} m from {other}"
        for size, name, point, other in found[:MOST_GAPS]
    ]
    return "join the ends: " + ", ".join(ends)
