"""Bounds on the work of an import, checked before the work: points, crossings, density, extent.

What is beyond them would take minutes or gigabytes, and is hardly a place for robots.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.drawing import refused
from physim.geometry.shapes import FloatArray
from physim.geometry.tangles import meet_more_often, segments_of

MOST_POINTS = 50_000
"""Points of all lines together."""
MOST_MEETINGS = 100_000
"""Pairs of segments whose boxes overlap."""
MOST_ACROSS = 2_000
"""Lines that a straight line across the place meets, on average: the work of telling inside from
outside."""
FARTHEST = 50_000.0
"""[m] extent of a place"""
MANY = 2_000
"""Points from which on an outline is taken coarsely, where that is enough."""
GRAIN = 1e-3
"""[m] Worlds are written to the millimetre."""


def check_work(path: Path, lines: Sequence[FloatArray]) -> None:
    """Refuse lines (n, 2) [m] that are too many, too tangled or too far apart to work on.

    Raises ImportSourceError.
    """
    points = sum(map(len, lines))
    if points > MOST_POINTS:
        raise refused(
            path,
            f"{points} points; at most {MOST_POINTS} are read; simplify the lines first",
        )
    if not points:
        return
    every = np.concatenate(lines)
    if not np.isfinite(every).all():
        raise refused(path, "a coordinate is beyond the largest number; check viewBox and --scale")
    extent = np.ptp(every, axis=0)
    if not extent.max() <= FARTHEST:
        raise refused(
            path,
            f"the place is {extent[0]:.3g} x {extent[1]:.3g} m, more than {FARTHEST:g} m; check "
            "--scale",
        )
    segments = segments_of(lines)
    if meet_more_often(segments, MOST_MEETINGS, by_boxes=True):
        raise refused(
            path,
            f"the lines lie over each other in more than {MOST_MEETINGS} places; draw each once",
        )
    if _dense(segments, extent):
        raise refused(
            path,
            f"the lines go to and fro across the place more than {MOST_ACROSS} times; leave out "
            "what is no wall",
        )


def coarse(area: Any, within: float) -> Any:
    """A shapely area whose outline is ``within`` [m] of that given; the same where it is simple.

    Distances to an outline are looked up by the ten thousand, and each look-up may cost a time in
    proportion to the points of it.
    """
    if shapely.get_num_coordinates(area) <= MANY:
        return area
    simple = shapely.simplify(area, within)
    return simple if simple.is_valid and simple.area > 0.0 else area


def lines_of(shape: Any) -> list[FloatArray]:
    """Every line (n, 2) of a single shapely geometry."""
    rings = [shape.exterior, *shape.interiors] if shape.geom_type == "Polygon" else [shape]
    return [shapely.get_coordinates(ring) for ring in rings]


def depth_of(text: str) -> int:
    """Brackets within brackets."""
    return max(accumulate((c == "(") - (c == ")") for c in text), default=0)


def _dense(segments: FloatArray, extent: FloatArray) -> bool:
    """Whether lines across the place meet more segments (n, 2, 2) than allowed."""
    covered = np.abs(segments[:, 1] - segments[:, 0]).sum(axis=0)
    return bool((covered > MOST_ACROSS * np.maximum(extent, 1e-9)).any())
