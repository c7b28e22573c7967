"""Paths in the area: what lies outside at their ends is left out, between them it is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing, place
from physim.authoring.importing.lines import length_of, points_at, stretch
from physim.geometry.shapes import FloatArray

MOST_TRIMMED = 0.3
"""[-] share of a path that may be left out at either end, outside the area or near a wall"""
SLIVER = 1e-6
"""[m] of a path outside the area that are rounding"""
TOLD = 0.01
"""[m] of a path left out from which on it is told"""


def check_inside(path: Path, drawing: Drawing, line: FloatArray, doubt: str, what: str) -> None:
    """Refuse a path that leaves the area, where it does so first."""
    whole = shapely.LineString(line)
    beyond = whole.difference(drawing.area)
    if beyond.length > whole.length - SLIVER:
        message = f"all of the {what} lies outside the area of the reference path, beyond walls"
        raise drawing.refused_at(path, f"{message}; lead it there", line[0], "path")
    if beyond.length > SLIVER:
        parts = shapely.get_parts(beyond)
        ends = shapely.get_coordinates(parts[int(np.argmax(shapely.length(parts) > 0.0))])
        where = ends[-1] if (ends[0] == line[0]).all() else ends[0]
        wall = drawing.named(where, "boundary", "obstacle")
        message = (
            f"the {what} leaves the area{wall} at {place(where)}, or leads through a wall there"
        )
        raise drawing.refused_at(path, f"{message}; lead it around{doubt}", where, "path")


def inside(drawing: Drawing, reference: FloatArray, path: str) -> FloatArray:
    """The path without what lies outside the area at either end, which is listed.

    It stays as it is where more than ``MOST_TRIMMED`` of it would go.
    """
    line, length = shapely.LineString(reference), length_of(reference)
    parts = shapely.get_parts(line.intersection(drawing.area))
    pieces = [
        shapely.get_coordinates(one)[[0, -1]] for one in parts[shapely.length(parts) > SLIVER]
    ]
    if not pieces:
        return reference
    within = shapely.points(np.vstack(pieces))
    first = shapely.line_locate_point(line, within).min()
    last = length - shapely.line_locate_point(line.reverse(), within).min()
    ends_inside = shapely.covers(drawing.area, shapely.points(reference[[0, -1]]))
    begin = 0.0 if ends_inside[0] else float(first)
    end = length if ends_inside[1] else float(last)
    if max(begin, length - end) > MOST_TRIMMED * length or length - (end - begin) < SLIVER:
        return reference
    for what, station, left_out, side in (
        ("enters", begin, begin, "before"),
        ("leaves", end, length - end, "after"),
    ):
        if left_out > TOLD:
            where = place(points_at(reference, station))
            drawing.changes.append(
                f"{path} {what} the area at {where}: the {left_out:.2f} m {side} that left out"
            )
    return stretch(reference, begin, end)
