"""Where the robots of a group come to stand, and how far apart: in a bend they may be too near."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.importing.line import directions_at, points_at, stations

WAITING = 0.8
"""[m] at size 1: robots that stop nearer than this keep each other in danger mode"""
CLEAR = 0.9
"""[m] at size 1: the gap between robots at their stops that a group is given where it can be"""

Pose = tuple[float, float, float]


def stop_stations(
    reference: FloatArray, lines: Sequence[FloatArray], poses: Sequence[Pose]
) -> FloatArray:
    """(N,) [m] station on its own path at which each robot stops, as a run has it.

    The robot that starts furthest along the reference path stops at its path's end, the others as
    far before theirs as they start behind it.
    """
    at = shapely.points([pose[:2] for pose in poses])
    lead = shapely.line_locate_point(shapely.LineString(reference), at)
    ends = np.array([stations(line)[-1] for line in lines])
    return np.asarray(np.maximum(ends - (lead.max() - lead), 0.0))


def least_stop_gap(
    reference: FloatArray,
    lines: Sequence[FloatArray],
    poses: Sequence[Pose],
    outlines: Sequence[FloatArray],
    window: float,
) -> tuple[float, int, int]:
    """Least distance [m] between two robots at their stops, and which two; infinite for one.

    ``outlines`` (n, 2) [m] in the robots' frames; each heads along the chord of its path over
    ``window`` [m] about its stop.
    """
    shapes = []
    for station, line, outline in zip(
        stop_stations(reference, lines, poses), lines, outlines, strict=True
    ):
        at = np.array([station])
        heading = atan2(*directions_at(line, at, window)[0][::-1])
        c, s = np.cos(heading), np.sin(heading)
        shapes.append(shapely.Polygon(outline @ np.array([[c, s], [-s, c]]) + points_at(line, at)))
    pairs = [(i, j) for i in range(len(shapes)) for j in range(i + 1, len(shapes))]
    gaps = [float(shapes[i].distance(shapes[j])) for i, j in pairs]
    if not gaps:
        return float("inf"), 0, 0
    k = int(np.argmin(gaps))
    return gaps[k], *pairs[k]


def corners_of(footprint: tuple[float, float] | FloatArray) -> FloatArray:
    """Outline (n, 2) [m] of a footprint, a (length, width) or an outline already."""
    if not isinstance(footprint, tuple):
        return footprint
    a, b = 0.5 * footprint[0], 0.5 * footprint[1]
    return np.array([(-a, -b), (a, -b), (a, b), (-a, b)])
