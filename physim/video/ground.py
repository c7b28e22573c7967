"""What does not move: areas, walls, obstacles and paths, cut into simple things to draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray, Polylines
from physim.video import theme
from physim.video.theme import Colour

if TYPE_CHECKING:
    from physim.record import Record


@dataclass(frozen=True)
class Stroke:
    """Straight pieces (M, 2, 2) [m] of one colour; dashed over dash and gap [px] when given."""

    pieces: FloatArray
    colour: Colour
    width: int
    dash: tuple[float, float] | None = None


@dataclass(frozen=True)
class Ground:
    """Static content of a world, in the order of drawing; world frame [m]."""

    accessible: list[FloatArray]
    """rings (n, 2), filled by the even-odd rule"""
    safe: list[FloatArray]
    """rings likewise; none where the run knew no safe and danger areas"""
    solids: list[FloatArray]
    """convex parts of obstacles"""
    strokes: list[Stroke]
    extent: tuple[FloatArray, FloatArray]
    """lowest and highest x, y [m] of all of it, and of every place a robot went"""


def ground(record: Record) -> Ground:
    """Collect the static content of a record."""
    accessible = [np.asarray(ring, dtype=np.float64) for ring in record.accessible]
    rings = record.safe if record.safe_distance > 0.0 else ()
    safe = [np.asarray(ring, dtype=np.float64) for ring in rings]
    segments, solids = _walls(record)
    strokes = _paths(record, region(safe) if safe else None)
    outlines = [np.stack((part, np.roll(part, -1, axis=0)), axis=1) for part in solids]
    if outlines:
        strokes.append(Stroke(np.concatenate(outlines), theme.WALL, 1))
    strokes.append(Stroke(segments, theme.WALL, 3))
    return Ground(accessible, safe, solids, strokes, _extent(record, accessible))


def region(rings: Sequence[FloatArray]) -> shapely.Geometry:
    """Return the area within rings by the even-odd rule."""
    area: shapely.Geometry = shapely.Polygon()
    for ring in rings:
        if len(ring) >= 3:
            area = area.symmetric_difference(shapely.make_valid(shapely.Polygon(ring)))
    return area


def _walls(record: Record) -> tuple[FloatArray, list[FloatArray]]:
    """Return the boundaries' segments (M, 2, 2) and the obstacles' convex parts."""
    walls, segments, solids = record.walls, [], []
    for start, end in zip(walls.part_start[:-1], walls.part_start[1:], strict=True):
        part = np.asarray(walls.vertices[start:end], dtype=np.float64)
        if len(part) == 2:
            segments.append(part)
        else:
            solids.append(part)
    return (np.stack(segments) if segments else np.zeros((0, 2, 2))), _merged(solids)


def _merged(parts: list[FloatArray]) -> list[FloatArray]:
    """Return outlines of the union of parts, so that an obstacle shows no inner seams."""
    if not parts:
        return []
    union = shapely.union_all([shapely.make_valid(shapely.Polygon(part)) for part in parts])
    pieces = [p for p in shapely.get_parts(union) if p.geom_type == "Polygon"]
    if any(len(piece.interiors) for piece in pieces):
        return parts
    return [shapely.get_coordinates(piece.exterior)[:-1] for piece in pieces]


def _paths(record: Record, safe: shapely.Geometry | None) -> list[Stroke]:
    """The reference path, and over it the robots' own, dashed outside of ``safe``."""
    strokes = [Stroke(_steps(line), theme.REFERENCE, 2) for line in _lines(record.reference)]
    if safe is not None:
        shapely.prepare(safe)
    for index, line in enumerate(_lines(record.paths)):
        colour = theme.mix(theme.robot_colour(index), theme.WHITE, 0.42)
        if safe is None:
            strokes.append(Stroke(_steps(line), colour, 1))
            continue
        for inside, dash in ((True, None), (False, (5.0, 5.0))):
            path = shapely.LineString(line)
            share = path.intersection(safe) if inside else path.difference(safe)
            pieces = _pieces(share)
            if len(pieces):
                strokes.append(Stroke(pieces, colour, 1, dash))
    return strokes


def _lines(lines: Polylines) -> list[FloatArray]:
    bounds = zip(lines.start[:-1], lines.start[1:], strict=True)
    parts = [np.asarray(lines.points[a:b], dtype=np.float64) for a, b in bounds]
    return [part for part in parts if len(part) > 1]


def _steps(line: FloatArray) -> FloatArray:
    return np.stack((line[:-1], line[1:]), axis=1)


def _pieces(geometry: shapely.Geometry) -> FloatArray:
    """Return the straight pieces (M, 2, 2) of all lines of a geometry."""
    lines = [part for part in shapely.get_parts(geometry) if part.geom_type == "LineString"]
    pieces = [_steps(shapely.get_coordinates(line)) for line in lines]
    return np.concatenate(pieces) if pieces else np.zeros((0, 2, 2))


def _extent(record: Record, accessible: list[FloatArray]) -> tuple[FloatArray, FloatArray]:
    reach = max(float(np.hypot(*part.T).max()) for body in record.footprints for part in body)
    places = np.asarray(record.pose[:, :, :2], dtype=np.float64).reshape(-1, 2)
    corners = [places.min(axis=0) - reach, places.max(axis=0) + reach]
    points = [*accessible, np.asarray(record.walls.vertices).reshape(-1, 2), np.array(corners)]
    cloud = np.concatenate([p for p in points if len(p)])
    return cloud.min(axis=0), cloud.max(axis=0)
