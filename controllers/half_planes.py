"""The point of some half-planes nearest to a wish: the program of ORCA and of CBF-QP.

A half-plane is a line, a point p and a unit direction d, and permits what lies to the left of it:
``det(d, p - u) <= 0``. All of it lies in a disc about the origin; a box is the disc about it and
four half-planes (`put_box`).

Two-dimensional linear programming line by line, and where nothing is permitted a three-dimensional
one that makes the largest violation of the soft half-planes smallest and keeps the hard ones, by
van den Berg, Guy, Lin and Manocha: Reciprocal n-body collision avoidance (ISRR 2009), as in RVO2.
Hard half-planes come first. Where even these permit nothing, the best of those that could be kept
is taken: whoever uses it looks at ``violation``.
"""

from __future__ import annotations

from math import hypot, sqrt
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, Rows4

PARALLEL = 1e-5
"""[-] Sine of the angle below which two lines are taken for parallel, as in RVO2"""
ROUNDING = 1e-10
"""Half-planes violated by less are kept, lines at a smaller angle are parallel: some are twins"""


class Nearest(NamedTuple):
    """What was found."""

    x: float
    y: float
    violation: float
    """by how much the half-plane that is violated most is, 0 where all are kept"""


@compiled
def violation_by(line: FloatArray, x: float, y: float) -> float:
    """By how much a half-plane (4,) p, d is violated at (x, y); negative inside."""
    return float(line[2] * (line[1] - y) - line[3] * (line[0] - x))


@compiled
def put_box(lines: Rows4, low_x: float, low_y: float, high_x: float, high_y: float) -> float:
    """Write the four half-planes of a box into the first rows; return the radius about it."""
    for k in range(4):
        lines[k, 0] = low_x if k % 2 == 0 else high_x
        lines[k, 1] = low_y if k % 2 == 0 else high_y
        lines[k, 2], lines[k, 3] = 0.0, 0.0
    lines[0, 3], lines[1, 3] = -1.0, 1.0
    lines[2, 2], lines[3, 2] = 1.0, -1.0
    return hypot(max(abs(low_x), abs(high_x)), max(abs(low_y), abs(high_y)))


@compiled
def on_line(
    lines: Rows4, k: int, radius: float, x: float, y: float, is_direction: bool
) -> tuple[bool, float, float]:
    """Point of line k, in the disc and the half-planes before it, nearest to (x, y).

    The farthest one along (x, y) where it is a direction. First whether there is any.
    """
    px, py, dx, dy = lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3]
    along = px * dx + py * dy
    square = along * along + radius * radius - (px * px + py * py)
    if square < 0.0:
        return False, x, y
    low, high = -along - sqrt(square), -along + sqrt(square)
    for i in range(k):
        across = dx * lines[i, 3] - dy * lines[i, 2]
        room = -violation_by(lines[i], px, py)
        if abs(across) <= ROUNDING:
            if room < -ROUNDING:
                return False, x, y
            continue
        t = room / across
        if across > 0.0:
            high = min(high, t)
        else:
            low = max(low, t)
        if low > high:
            return False, x, y
    t = dx * x + dy * y
    if is_direction:
        t = high if t > 0.0 else low
    else:
        t = min(max(t - along, low), high)
    return True, px + t * dx, py + t * dy


@compiled
def nearest_permitted(
    lines: Rows4, many: int, radius: float, x: float, y: float, is_direction: bool
) -> tuple[int, float, float]:
    """Point of the disc and of ``many`` half-planes nearest to (x, y).

    The farthest one along (x, y), of length 1, where it is a direction. First how many half-planes
    are kept: where that is not all of them, the point is that of those before.
    """
    size = hypot(x, y)
    found_x, found_y = x, y
    if is_direction or size > radius:
        found_x, found_y = radius * x / size, radius * y / size
    for k in range(many):
        if violation_by(lines[k], found_x, found_y) > ROUNDING:
            is_any, at_x, at_y = on_line(lines, k, radius, x, y, is_direction)
            if not is_any:
                return k, found_x, found_y
            found_x, found_y = at_x, at_y
    return many, found_x, found_y


@compiled
def nearest_in(lines: Rows4, many: int, hard: int, radius: float, x: float, y: float) -> Nearest:
    """Point of the disc and of ``many`` half-planes (4,) p, d nearest to (x, y).

    Where there is none, the point of the ``hard`` first ones that violates the others least.
    """
    kept, x, y = nearest_permitted(lines, many, radius, x, y, False)
    if kept == many:
        return Nearest(x, y, 0.0)
    soft, worst = np.empty((many, 4)), 0.0
    for i in range(kept, many):
        if violation_by(lines[i], x, y) <= worst:
            continue
        count = 0
        for j in range(hard):
            for m in range(4):
                soft[count, m] = lines[j, m]
            count += 1
        for j in range(hard, i):  # where both are violated alike
            ax, ay, bx, by = lines[i, 2], lines[i, 3], lines[j, 2], lines[j, 3]
            across = ax * by - ay * bx
            if abs(across) <= PARALLEL:
                if ax * bx + ay * by > 0.0:
                    continue
                soft[count, 0] = 0.5 * (lines[i, 0] + lines[j, 0])
                soft[count, 1] = 0.5 * (lines[i, 1] + lines[j, 1])
            else:
                t = -violation_by(lines[j], lines[i, 0], lines[i, 1]) / across
                soft[count, 0], soft[count, 1] = lines[i, 0] + t * ax, lines[i, 1] + t * ay
            size = hypot(bx - ax, by - ay)
            soft[count, 2], soft[count, 3] = (bx - ax) / size, (by - ay) / size
            count += 1
        done, at_x, at_y = nearest_permitted(soft, count, radius, -lines[i, 3], lines[i, 2], True)
        if done == count:
            x, y = at_x, at_y
        worst = violation_by(lines[i], x, y)
    for i in range(many):
        worst = max(worst, violation_by(lines[i], x, y))
    return Nearest(x, y, worst)
