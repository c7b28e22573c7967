"""The ground of a world: boundaries as drawn, obstacles, and the area between them.

Boundaries may touch, and a polyline may close; where they cross each other or themselves a wall
cuts through the road, unless it merely ends beyond a corner.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from physim.checking.bends import runs_into_itself, tell_folds
from physim.checking.crossings import crossings, self_crossings
from physim.checking.sketch import Sketch
from physim.checking.telling import Told
from physim.errors import Location
from physim.geometry.area import Area, accessible_area
from physim.geometry.corridor import corridor_boundaries
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world_file.geometry_check import outline_fault

MOST_GAPS = 3
"""Gaps between boundaries that one message names."""
MOST_SEARCHED = 300
"""Boundaries among which gaps are looked for."""


@dataclass(frozen=True)
class Ground:
    """Walls and the area that they leave."""

    walls: tuple[tuple[str, Any], ...]
    """name and shapely line of every sound boundary"""
    solids: tuple[tuple[str, Any], ...]
    """name and shapely polygon of every sound obstacle"""
    area: Area | None
    """None where it is unknown: a boundary or the reference path is missing, or encloses none"""
    is_whole: bool
    """whether every boundary and obstacle is among them"""


def ground_of(sketch: Sketch, told: Told) -> Ground:
    """Check boundaries and obstacles, and make the area between them."""
    solids, lost = [], 0
    for k, ring in enumerate(sketch.obstacles):
        message = "" if ring is None else outline_fault(ring)
        if message:
            told.error(("obstacles", k), message)
        if ring is None or message:
            lost += 1
        else:
            solids.append((f"obstacles[{k}]", ring))
    lines = _corridor(sketch, told) if sketch.boundaries is None else _drawn(sketch, told)
    area = None
    if lines is not None and sketch.reference is not None:
        area = _area(sketch, sketch.reference, lines, [ring for _, ring in solids], told)
    line = sketch.centreline if sketch.boundaries is None else None
    if lines is not None and line is not None and (area is not None or sketch.reference is None):
        tell_folds(line, [wall for _, wall in lines[:2]], told)
    known = lines if lines is not None else _readable(sketch)
    return Ground(
        walls=tuple((name, shapely.LineString(line)) for name, line in known),
        solids=tuple((name, shapely.Polygon(ring)) for name, ring in solids),
        area=area,
        is_whole=lines is not None and not lost,
    )


def _corridor(sketch: Sketch, told: Told) -> list[tuple[str, FloatArray]] | None:
    """Walls of a corridor; None where it cannot be drawn."""
    line, width, margin = sketch.centreline, sketch.width, sketch.end_margin
    if line is None:
        return None
    where: Location = ("corridor", "centreline")
    for x, y in self_crossings(line)[:MOST_GAPS]:
        told.error(
            where,
            f"the centreline crosses itself at ({x:.6g}, {y:.6g}); walls would cut through the "
            "road there; lead it round, or draw boundaries instead",
        )
    if width is None or margin is None:
        return None
    try:
        walls = corridor_boundaries(line, width, margin)
    except ValueError as error:
        told.error(where, f"the centreline {error}")
        return None
    return [("the edge of the corridor", wall) for wall in walls.values()]


def _readable(sketch: Sketch) -> list[tuple[str, FloatArray]]:
    return [
        (f"boundaries[{k}]", line)
        for k, line in enumerate(sketch.boundaries or ())
        if line is not None
    ]


def _drawn(sketch: Sketch, told: Told) -> list[tuple[str, FloatArray]] | None:
    """Boundaries as drawn; None where one of them cannot be read."""
    lines = _readable(sketch)
    ends = _overshoots([line for _, line in lines])
    numbers = [k for k, line in enumerate(sketch.boundaries or ()) if line is not None]
    for k, (_, line) in zip(numbers, lines, strict=True):
        for x, y in self_crossings(line)[:MOST_GAPS]:
            _tell_crossing(("boundaries", k), "itself", x, y, ends, told)
    for a, b, (x, y) in crossings([line for _, line in lines]):
        where: Location = ("boundaries", numbers[max(a, b)])
        _tell_crossing(where, lines[min(a, b)][0], x, y, ends, told)
    return lines if len(lines) == len(sketch.boundaries or ()) else None


def _tell_crossing(
    where: Location, other: str, x: float, y: float, ends: FloatArray, told: Told
) -> None:
    place = f"crosses {other} at ({x:.6g}, {y:.6g})"
    if len(ends) and np.hypot(*(ends - (x, y)).T).min() <= LENGTH:
        told.warn(where, f"{place} and ends beyond it; let it end there")
    else:
        told.error(where, f"{place}; boundaries may touch and close, but not cross")


def _overshoots(lines: list[FloatArray]) -> FloatArray:
    """(n, 2) ends of the pieces of boundaries that border no face: loose ends beyond a corner."""
    if not lines:
        return np.zeros((0, 2))
    noded = shapely.unary_union([shapely.LineString(line) for line in lines])
    _, _, dangles, _ = shapely.polygonize_full(shapely.get_parts(noded))
    return np.asarray(shapely.get_coordinates(dangles))


def _area(
    sketch: Sketch,
    reference: FloatArray,
    lines: list[tuple[str, FloatArray]],
    rings: list[FloatArray],
    told: Told,
) -> Area | None:
    """The accessible area; where there is none, the gaps between the boundaries are told."""
    drawn = [line for _, line in lines]
    where: Location = ("boundaries",) if sketch.boundaries is not None else ("corridor",)
    try:
        area = accessible_area(drawn, rings, reference)
    except ValueError as error:
        told.error(where, f"{error}; {_gaps(lines)}")
        return None
    outside = area.outside_stretches(reference)
    if len(outside):
        line = sketch.centreline if sketch.boundaries is None else None
        if line is not None and runs_into_itself(line, drawn, told):
            return None  # what the rest would say follows from that
        first, last = outside[0]
        told.error(
            sketch.reference_key,
            f"the reference path leaves the accessible area from {first:.2f} m to {last:.2f} m "
            "along it; it must lie between the boundaries and beside the obstacles",
        )
    return area


def _gaps(lines: list[tuple[str, FloatArray]]) -> str:
    """Loose ends of boundaries, nearest to another wall first, with the size of the gap."""
    lines = lines[:MOST_SEARCHED]
    shapes = [shapely.LineString(line) for _, line in lines]
    gaps: list[tuple[float, str, Any, str]] = []
    for k, (name, line) in enumerate(lines):
        for end in (0, -1):
            point = shapely.Point(line[end])
            others = [(point.distance(s), lines[m][0]) for m, s in enumerate(shapes) if m != k]
            others.append((float(np.hypot(*(line[0] - line[-1]))), "its own other end"))
            size, other = min(others)
            is_told = any(size == gap[0] and {name, other} == {gap[1], gap[3]} for gap in gaps)
            if size > 0.0 and not is_told:
                gaps.append((size, name, point, other))
    if not gaps:
        return "boundaries must close a face around the reference path"
    gaps.sort(key=lambda gap: gap[0])
    told = [
        f"{name} ends at ({point.x:.6g}, {point.y:.6g}), {size:.4g} m from {other}"
        for size, name, point, other in gaps[:MOST_GAPS]
    ]
    return "join the ends: " + ", ".join(told)
