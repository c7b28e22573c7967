"""Width of the free space along a path: shortest distances to its left and right (Fig. 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray

BLOCK = 200_000
"""Pairs of point and segment looked at in one go: bounds the memory."""


def width_profile(
    points: FloatArray, directions: FloatArray, segments: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Shortest distance [m] to the left and to the right boundary at points of a path (Fig. 4).

    ``points``, ``directions`` (K, 2) along the path, ``segments`` (S, 4) boundary segments
    ax, ay, bx, by. *Left* is what lies in the half-plane left of the path's direction, so a
    boundary on both sides of the path counts on each. The width is the sum; inf where a side is
    open.
    """
    left, right = width_feet(points, directions, segments)
    return np.hypot(*(left - points).T), np.hypot(*(right - points).T)


def width_feet(
    points: FloatArray, directions: FloatArray, segments: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Nearest boundary points (K, 2) [m] on the left and on the right, as in `width_profile`.

    Not finite where a side is open.
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


def opposite(points: FloatArray, left: FloatArray, right: FloatArray) -> NDArray[np.bool_]:
    """Whether two nearest points (K, 2) lie on opposite sides of points (K, 2), 90 degrees apart.

    Near an end of a corridor both may lie on the wall that closes it, before or behind the path:
    then the two distances add up to no width that a robot must fit through. False where one is
    not finite.
    """
    known = np.isfinite(np.concatenate((left, right), axis=1)).all(axis=1)
    one, other = (np.where(np.isfinite(foot), foot - points, 0.0) for foot in (left, right))
    return np.asarray(known & ((one * other).sum(axis=1) <= 0.0))


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
