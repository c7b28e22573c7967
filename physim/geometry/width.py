"""Width of the free space along a path: shortest distances to its left and right (Fig. 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray

BLOCK = 200_000
"""Pairs of point and segment looked at in one go: bounds the memory."""
APART = -0.5
"""Cosine of the angle [120 degrees] by which the two sides of a path are apart at least."""


def width_feet(
    points: FloatArray, directions: FloatArray, segments: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Nearest boundary points (K, 2) [m] on the left and on the right of a path (Fig. 4).

    ``points``, ``directions`` (K, 2) along the path, ``segments`` (S, 4) boundary segments
    ax, ay, bx, by. *Left* is what lies in the half-plane left of the path's direction, so a
    boundary on both sides of the path counts on each. Not finite where a side is open.
    """
    left, right = np.full((len(points), 2), np.inf), np.full((len(points), 2), np.inf)
    if not len(segments):
        return left, right
    block = max(1, BLOCK // len(segments))
    for first in range(0, len(points), block):
        part = slice(first, first + block)
        _feet(points[part], directions[part], segments, left[part], right[part])
    return left, right


def nearest_feet(points: FloatArray, segments: FloatArray) -> FloatArray:
    """Nearest points (K, 2) [m] of segments (S, 4) to points (K, 2); not finite without any."""
    feet = np.full((len(points), 2), np.inf)
    block = max(1, BLOCK // max(1, len(segments)))
    for first in range(0, len(points) if len(segments) else 0, block):
        part = points[first : first + block]
        ax, ay = segments[:, 0] - part[:, :1], segments[:, 1] - part[:, 1:]
        dx, dy = segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]
        square = dx * dx + dy * dy
        along = -(ax * dx + ay * dy) / np.where(square > 0.0, square, 1.0)
        at = np.minimum(np.maximum(along, 0.0), 1.0)
        x, y = ax + at * dx, ay + at * dy
        best = (x * x + y * y).argmin(axis=1)
        row = np.arange(len(part))
        feet[first : first + block] = part + np.stack([x[row, best], y[row, best]], axis=1)
    return feet


def side_feet(
    points: FloatArray,
    directions: FloatArray,
    segments: FloatArray,
    walls: tuple[FloatArray, FloatArray] | None = None,
) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Nearest points (K, 2) [m] on the left and on the right, and whether a width is between them.

    ``segments`` (S, 4) lie on the side of the path on which they are found, as in `width_feet`;
    ``walls`` are those of a corridor, of which it is known which is left and which is right: their
    points need only be 90 degrees or more apart, all others must be `opposite`.
    """
    left, right = width_feet(points, directions, segments)
    if walls is None:
        return left, right, opposite(points, directions, left, right)
    left = _nearer(points, left, nearest_feet(points, walls[0]))
    right = _nearer(points, right, nearest_feet(points, walls[1]))
    return left, right, _apart(points, left, right, 0.0)


def opposite(
    points: FloatArray, directions: FloatArray, left: FloatArray, right: FloatArray
) -> NDArray[np.bool_]:
    """Whether two nearest points (K, 2) lie on the two sides of a path, so that a width is between.

    ``points``, ``directions`` (K, 2) along the path. The two must be 120 degrees or more apart as
    seen from the path, and the line through them nearer to square than to along the path: near an
    end of a corridor one or both may lie on the wall that closes it, before or behind the path,
    and then the distances add up to no width that a robot must fit through. A wall square across
    the path never counts. False where a point is not finite.
    """
    across = np.where(np.isfinite(left) & np.isfinite(right), left - right, 0.0)
    ahead = np.abs((across * directions).sum(axis=1))
    aside = np.abs(across[:, 0] * directions[:, 1] - across[:, 1] * directions[:, 0])
    return np.asarray(_apart(points, left, right, APART) & (ahead <= aside))


def _apart(
    points: FloatArray, left: FloatArray, right: FloatArray, most: float
) -> NDArray[np.bool_]:
    """Whether the cosine between two points as seen from ``points`` is ``most`` or less."""
    known = np.isfinite(np.concatenate((left, right), axis=1)).all(axis=1)
    one, other = (np.where(np.isfinite(foot), foot - points, 0.0) for foot in (left, right))
    bound = most * np.hypot(*one.T) * np.hypot(*other.T)
    return np.asarray(known & ((one * other).sum(axis=1) <= bound))


def _nearer(points: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    gaps = [np.hypot(*(feet - points).T) for feet in (first, second)]
    return np.where((gaps[0] < gaps[1])[:, None], first, second)


def _feet(
    points: FloatArray,
    directions: FloatArray,
    segments: FloatArray,
    left: FloatArray,
    right: FloatArray,
) -> None:
    """Write the nearest points of some points, in place."""
    ax, ay = segments[:, 0] - points[:, :1], segments[:, 1] - points[:, 1:]  # (K, S)
    dx, dy = segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]  # (S,)
    tx, ty = directions[:, :1], directions[:, 1:]
    side, span = tx * ay - ty * ax, tx * dy - ty * dx  # of a; from a to b
    square = dx * dx + dy * dy
    foot = -(ax * dx + ay * dy) / np.where(square > 0.0, square, 1.0)
    crossing = np.divide(-side, span, out=np.zeros_like(span), where=span != 0.0)
    for sign, out in ((1.0, left), (-1.0, right)):
        starts, ends = sign * side >= 0.0, sign * (side + span) >= 0.0
        low, high = np.where(starts, 0.0, crossing), np.where(ends, 1.0, crossing)
        at = np.minimum(np.maximum(foot, low), high)
        x, y = ax + at * dx, ay + at * dy
        gap = np.where(starts | ends, x * x + y * y, np.inf)
        best = gap.argmin(axis=1)
        row = np.arange(len(points))
        found = np.isfinite(gap[row, best])
        nearest = points + np.stack([x[row, best], y[row, best]], axis=1)
        out[found] = nearest[found]
