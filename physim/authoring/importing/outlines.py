"""The outline of a drawn robot: which way it heads, and its footprint in its own frame."""

from __future__ import annotations

from math import atan2, cos, pi, sin

import numpy as np
import shapely

from physim.geometry.polygon import counter_clockwise
from physim.geometry.shapes import FloatArray

Footprint = tuple[float, float] | FloatArray
"""Length and width [m], or an outline (n, 2) [m] in the robot's frame"""
AS_SMALL = 0.01
"""[-] by which drawn rectangles differ in area that are as small: coordinates are rounded"""


def rectangle_of(outline: FloatArray, ahead: FloatArray) -> tuple[FloatArray, float]:
    """Middle (2,) [m] and heading [rad] of the rectangle about an outline that a robot takes.

    The smallest one lies on a side of the convex hull. Of all that are larger by `AS_SMALL` at
    most, and their four directions, the one nearest to the direction ``ahead``.
    """
    hull = np.array(shapely.Polygon(outline).convex_hull.exterior.coords)
    found = []
    for x, y in np.diff(hull, axis=0):
        angle = atan2(y, x)
        turn = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
        low, high = (hull @ turn).min(axis=0), (hull @ turn).max(axis=0)
        found.append((float(np.prod(high - low)), turn @ (low + high) / 2.0, angle))
    least = min(area for area, _, _ in found)
    directions = [
        (middle, angle + k * pi / 2.0)
        for area, middle, angle in found
        if area <= least * (1.0 + AS_SMALL)
        for k in range(4)
    ]
    middle, heading = max(
        directions, key=lambda one: cos(one[1]) * ahead[0] + sin(one[1]) * ahead[1]
    )
    return middle, (heading + pi) % (2.0 * pi) - pi


def footprint_of(outline: FloatArray, centre: FloatArray, heading: float) -> Footprint:
    """Outline in the robot's frame [m], counter-clockwise; a rectangle as (length, width)."""
    c, s = cos(heading), sin(heading)
    own = counter_clockwise(((outline - centre) @ np.array([[c, -s], [s, c]])).round(3))
    half = np.abs(own).max(axis=0)
    if len(own) == 4 and np.abs(np.abs(own) - half).max() <= 0.0015:
        return round(2.0 * float(half[0]), 2), round(2.0 * float(half[1]), 2)
    return own
