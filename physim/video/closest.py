"""The two robots that are closest to each other, and where."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray
from physim.scene_model import placed


class Pair(NamedTuple):
    """Two robots, their distance [m] (0 when they touch or overlap) and the points (2, 2) [m]."""

    a: int
    b: int
    distance: float
    points: FloatArray


def closest_pair(
    footprints: Sequence[Sequence[FloatArray]], pose: FloatArray, reach: FloatArray
) -> Pair | None:
    """Find the closest pair of robots; of equal ones the first. None for one robot.

    ``footprints``: convex parts of the N robots, in their frames; ``pose`` (N, 3); ``reach`` (N,)
    [m]: radius of a disc around the reference point that holds the robot.

    Pairs are taken in the order of a lower bound, the distance of their enclosing discs, so far
    fewer than all are worked out.
    """
    count = len(pose)
    if count < 2:
        return None
    a, b = np.triu_indices(count, 1)
    gap = np.hypot(*(pose[a, :2] - pose[b, :2]).T)
    order = np.argsort(gap - reach[a] - reach[b], kind="stable")
    bound = (gap - reach[a] - reach[b])[order]
    best, found = np.inf, (0, 1)
    shapes: dict[int, shapely.Geometry] = {}
    for index, least in zip(order, bound, strict=True):
        if least > best:
            break
        i, j = int(a[index]), int(b[index])
        for k in (i, j):
            if k not in shapes:
                parts = [shapely.Polygon(placed(part, pose[k])) for part in footprints[k]]
                shapes[k] = shapely.GeometryCollection(parts)
        distance = float(shapely.distance(shapes[i], shapes[j]))
        if distance < best:
            best, found = distance, (i, j)
    i, j = found
    line = shapely.shortest_line(shapes[i], shapes[j])
    return Pair(i, j, best, shapely.get_coordinates(line))
