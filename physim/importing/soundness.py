"""What is too small or too crooked to become a world, found before any shape is made of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.importing.drawing import DIGITS, Drawing, listed, place, refused

SMALLEST_PLACE, LARGEST_PLACE = 1.0, 10_000.0
"""[m] extent below which a place is refused, and above which its scale is doubted"""
GRAIN = 2.0 * 10.0**-DIGITS
"""[m] extent up to which a shape that became a point or a line was but a grain"""


def check_sound(path: Path, drawing: Drawing) -> None:
    """Refuse a place, path, obstacle or robot of which no shape can be made.

    Walls and obstacles that vanish when they are rounded to the millimetre are left out and listed.
    Raises ImportSourceError.
    """
    if drawing.boundaries:
        check_size(path, np.ptp(np.vstack(drawing.boundaries), axis=0))
    short = [line for line in drawing.boundaries if len(line) < 2]
    drawing.changes += listed(
        short, lambda line: f"boundary at {place(line[0])}: shorter than a millimetre, left out"
    )
    drawing.boundaries = [line for line in drawing.boundaries if len(line) > 1]
    named = [(f"path of {name}", line) for name, line in drawing.paths.items()]
    for what, line in (("path", drawing.reference), *named):
        if line is not None and len(line) < 2:
            raise refused(
                path,
                f"the {what} at {place(line[0])} is shorter than a millimetre; check --scale",
            )
    for robot in drawing.robots:
        if not _has_area(robot.outline):
            raise refused(
                path,
                f"a robot {_at(robot.outline)}has no area; draw its outline, and check --scale",
            )
        _check_simple(path, "a robot", robot.outline)
    drawing.obstacles = _obstacles(path, drawing)


def check_size(path: Path, extent: FloatArray) -> None:
    """Refuse a place whose ``extent`` (2,) [m] in x and y is too small for robots."""
    if max(extent) < SMALLEST_PLACE:
        raise refused(
            path,
            f"the place is {extent[0]:.3g} x {extent[1]:.3g} m; --scale M says how many metres a "
            "unit of the source is",
        )


def _obstacles(path: Path, drawing: Drawing) -> list[FloatArray]:
    """Obstacles with area; grains are listed, and what has none otherwise is refused."""
    kept, grains = [], []
    for ring in drawing.obstacles:
        if _has_area(ring):
            _check_simple(path, "an obstacle", ring)
            kept.append(ring)
        elif len(ring) and np.ptp(ring, axis=0).max() > GRAIN:
            raise refused(path, f"an obstacle {_at(ring)}encloses no area; draw its outline")
        else:
            grains.append(ring)
    drawing.changes += listed(
        grains, lambda ring: f"obstacle {_at(ring)}is smaller than a millimetre, left out"
    )
    return kept


def _check_simple(path: Path, what: str, ring: FloatArray) -> None:
    """Refuse an outline that crosses or touches itself: its inside would be a guess."""
    shape = shapely.Polygon(ring)
    if not shape.is_valid:
        reason = shapely.is_valid_reason(shape)
        raise refused(
            path,
            f"{what} {_at(ring)}crosses or touches itself ({reason}); its corners must go once "
            "round the outline",
        )


def _at(ring: FloatArray) -> str:
    return f"at {place(ring[0])} " if len(ring) else ""


def _has_area(ring: FloatArray) -> bool:
    """Whether an outline (n, 2) [m] is more than a line."""
    return len(ring) > 2 and bool(shapely.MultiPoint(ring).convex_hull.area > 1e-9)
