"""Bounds on the work of an import, checked before the work: points, crossings, density, extent.

What is beyond them would take minutes or gigabytes, and is hardly a place for robots.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from physim.authoring.importing.drawing import refused
from physim.geometry.shapes import FloatArray
from physim.world.ground.lines import meet_more_often, segments_of

MOST_POINTS = 50_000
"""Points of all lines together."""
MOST_MEETINGS = 100_000
"""Pairs of segments whose boxes overlap."""
MOST_ACROSS = 2_000
"""Lines that a straight line across the place meets, on average: the work of telling inside from
outside."""
FARTHEST = 50_000.0
"""[m] extent of a place"""


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
    covered = np.abs(segments[:, 1] - segments[:, 0]).sum(axis=0)
    if (covered > MOST_ACROSS * np.maximum(extent, 1e-9)).any():
        raise refused(
            path,
            f"the lines go to and fro across the place more than {MOST_ACROSS} times; leave out "
            "what is no wall",
        )
