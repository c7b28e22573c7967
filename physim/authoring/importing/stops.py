"""Where robots stop: at which stations, and how far from each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from physim.authoring.importing.drawing import Drawing
from physim.authoring.importing.lines import Pose, length_of, points_at, pose_at
from physim.authoring.importing.placed import Placed, shape_at
from physim.geometry.shapes import FloatArray

WAITING = 0.8
"""[m] at size 1: robots that stop nearer than this keep each other in danger mode"""
LAG = 2.0
"""Windows, the look-ahead of the controller, over which one turns behind a corner"""


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
    reference: FloatArray, robots: Sequence[Placed], window: float, is_formation: bool = True
) -> tuple[float, int, int]:
    """Least distance [m] between two robots at their stops, and which two; infinite for one.

    Each heads along the chord of its path over ``window`` [m] about its stop, or, behind a corner,
    still as it came, `LAG` windows before; without a formation its stop is the end of its path.
    """
    lines, poses = [one.path for one in robots], [one.pose for one in robots]
    ends = np.array([length_of(line) for line in lines])
    stops = stop_stations(reference, lines, poses) if is_formation else ends
    shapes = [
        shape_at(one.footprint, pose_at(one.path, station, window)).union(
            shape_at(one.footprint, _as_it_came(one.path, station, LAG * window))
        )
        for one, station in zip(robots, stops, strict=True)
    ]
    if len(shapes) < 2:
        return float("inf"), 0, 0
    tree, within, near = shapely.STRtree(shapes), window, np.empty((2, 0), np.int64)
    while not near.size:
        near = tree.query(shapes, predicate="dwithin", distance=within)
        near, within = near[:, near[0] < near[1]], 2.0 * within
    gaps = (float(shapes[i].distance(shapes[j])) for i, j in near.T)
    return min((gap, int(i), int(j)) for gap, (i, j) in zip(gaps, near.T, strict=True))


def _as_it_came(line: FloatArray, station: float, before: float) -> Pose:
    """Pose on a path, heading along the chord from a place ``before`` [m] behind."""
    behind, here = points_at(line, np.array([max(station - before, 0.0), station]))
    if np.array_equal(behind, here):
        return pose_at(line, station, before)
    return (float(here[0]), float(here[1]), float(np.arctan2(*(here - behind)[::-1])))


def stop_warnings(
    drawing: Drawing, reference: FloatArray, robots: Sequence[Placed], size: float, are_drawn: bool
) -> list[str]:
    """Say which two robots stop so near each other that they may wait for ever; else nothing."""
    gap, i, j = least_stop_gap(reference, robots, size, drawing.has_formation)
    if gap >= WAITING * size:
        return []
    mend = "draw them farther apart" if are_drawn else "fewer --robots or --lanes 1"
    return [
        f"note: {robots[i].name} and {robots[j].name} stop {gap:.2f} m from each other at the end "
        f"of the path, and may wait for each other and never arrive; another end of the path "
        f"(--to), or {mend}"
    ]
