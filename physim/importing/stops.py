"""Where the robots of a group come to stand, and how far apart: in a bend they may be too near."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.importing.line import Pose, length_of, pose_at

WAITING = 0.8
"""[m] at size 1: robots that stop nearer than this keep each other in danger mode"""
CLEAR = 0.9
"""[m] at size 1: the gap between robots at their stops that a group is given where it can be"""

Footprint = tuple[float, float] | FloatArray
"""Length and width [m], or an outline (n, 2) [m] in the robot's frame"""


@dataclass(frozen=True)
class Placed:
    """One robot of the world, and the path (n, 2) [m] that it follows."""

    name: str
    footprint: Footprint
    pose: Pose
    path: FloatArray
    offset: float | None
    """[m] of its path from the reference path, left positive; None where points are needed"""


def shape_at(footprint: Footprint, pose: Pose) -> Any:
    """Outline of a robot as a shapely polygon, world frame."""
    x, y, heading = pose
    outline = footprint
    if isinstance(outline, tuple):
        a, b = 0.5 * outline[0], 0.5 * outline[1]
        outline = np.array([(-a, -b), (a, -b), (a, b), (-a, b)])
    c, s = np.cos(heading), np.sin(heading)
    return shapely.Polygon(outline @ np.array([[c, s], [-s, c]]) + (x, y))


def stop_stations(
    reference: FloatArray, lines: Sequence[FloatArray], poses: Sequence[Pose]
) -> FloatArray:
    """(N,) [m] station on its own path at which each robot stops, as a run has it.

    The robot that starts furthest along the reference path stops at its path's end, the others as
    far before theirs as they start behind it.
    """
    at = shapely.points([pose[:2] for pose in poses])
    lead = shapely.line_locate_point(shapely.LineString(reference), at)
    ends = np.array([length_of(line) for line in lines])
    return np.asarray(np.maximum(ends - (lead.max() - lead), 0.0))


def least_stop_gap(
    reference: FloatArray, robots: Sequence[Placed], window: float
) -> tuple[float, int, int]:
    """Least distance [m] between two robots at their stops, and which two; infinite for one.

    Each heads along the chord of its path over ``window`` [m] about its stop.
    """
    lines, poses = [one.path for one in robots], [one.pose for one in robots]
    stops = stop_stations(reference, lines, poses)
    shapes = [
        shape_at(one.footprint, pose_at(one.path, station, window))
        for one, station in zip(robots, stops, strict=True)
    ]
    pairs = combinations(range(len(shapes)), 2)
    gaps = ((float(shapes[i].distance(shapes[j])), i, j) for i, j in pairs)
    return min(gaps, default=(float("inf"), 0, 0))


def stop_warnings(reference: FloatArray, robots: Sequence[Placed], size: float) -> list[str]:
    """Say which two robots stop so near each other that they may wait for ever; else nothing."""
    gap, i, j = least_stop_gap(reference, robots, size)
    if gap >= WAITING * size:
        return []
    return [
        f"mind: {robots[i].name} and {robots[j].name} stop {gap:.2f} m from each other at the end "
        "of the path, and may wait for each other and never arrive; another end of the path "
        "(--to), fewer --robots or --lanes 1"
    ]
