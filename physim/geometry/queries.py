"""Distances and collision times of two shapes, for use from Python.

A shape is given as one of

- a simple polygon: array (n, 2) [m] of n >= 3 corners in either direction, nonconvex too;
- a segment (2, 2) or a point (1, 2);
- a sequence of these, taken together: convex parts, or a polyline as `polyline` gives it.

Shapes are closed sets: touching ones have distance 0 and collide. Anything else raises
`PhysimError`. The kernels behind these functions are in `separation` and `collision`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from physim.errors import PhysimError
from physim.geometry.collision import bodies_time
from physim.geometry.inputs import (
    ShapeLike,
    bodies_of,
    horizon_of,
    pack_at,
    parts_of,
    points_of,
)
from physim.geometry.separation import body_separation
from physim.geometry.shapes import FloatArray

Point = tuple[float, float]


@dataclass(frozen=True)
class Separation:
    """How two shapes lie to each other, all in [m]."""

    distance: float
    """signed: 0 where they touch, negative = depth of the deepest pair of convex parts"""
    normal: Point
    """unit vector from a to b; where they overlap, the direction of least penetration"""
    point_a: Point
    """on a: nearest to b, or deepest inside b"""
    point_b: Point
    """on b: nearest to a, or deepest inside a"""


def polyline(points: ArrayLike) -> tuple[FloatArray, ...]:
    """Segments (2, 2) of a polyline (n, 2), n >= 2 [m]: a shape without an inside."""
    line = points_of(points, "polyline")
    if len(line) < 2:
        raise PhysimError(f"polyline: {len(line)} point given; at least 2 are needed")
    return tuple(line[k : k + 2] for k in range(len(line) - 1))


def shortest_distance(a: ShapeLike, b: ShapeLike) -> float:
    """Shortest distance (11) [m] of two shapes in one frame; 0 where they intersect.

    Exact to about 1e-15 of their size and of their distance, either way.
    """
    return max(0.0, closest_points(a, b).distance)


def signed_distance(a: ShapeLike, b: ShapeLike) -> float:
    """Signed distance [m]: `shortest_distance`, and minus the depth where the shapes overlap.

    The depth is the least by which one must move to be clear of the other; for nonconvex shapes,
    that of the deepest pair of convex parts, which may be less than their whole would need.
    """
    return closest_points(a, b).distance


def closest_points(a: ShapeLike, b: ShapeLike) -> Separation:
    """Signed distance of two shapes in one frame, with normal and witness points.

    Where the closest or deepest pair of points is not unique, the middle of facing sides is taken.
    """
    parts_a = parts_of(a, "first shape")
    parts_b = parts_of(b, "second shape")
    # Far from the origin nothing is lost when both are seen from one of their own corners.
    origin = parts_a[0][0]
    still = np.zeros(3)
    d, nx, ny, ax, ay, bx, by = body_separation(
        pack_at(parts_a, origin), 0, still, pack_at(parts_b, origin), 0, still
    )
    x, y = (float(value) for value in origin)
    return Separation(d, (nx, ny), (x + ax, y + ay), (x + bx, y + by))


def collision_time(
    footprint_a: ShapeLike,
    pose_a: ArrayLike,
    twist_a: ArrayLike,
    footprint_b: ShapeLike,
    pose_b: ArrayLike,
    twist_b: ArrayLike,
    horizon: float = 10.0,
) -> float:
    """Collision time (11) [s]: when two shapes first touch if both keep their twists.

    Footprints are in the body frames, poses (x, y, heading) [m, m, rad] in the world frame. A
    twist is (v, omega) [m/s, rad/s] in the body frame, an arc, or (vx, vy, omega) in the world
    frame, a straight line while turning; (0, 0) stands still.

    0 while they overlap or touch (within 1e-9 m); inf when they do not touch up to ``horizon``
    [s]. Never late: at every earlier instant they are apart, and at the time returned they are
    within 1e-9 m; a pass within 1e-9 m may count either way.
    """
    until = horizon_of(horizon)
    a, course_a, b, course_b = bodies_of(footprint_a, pose_a, twist_a, footprint_b, pose_b, twist_b)
    return bodies_time(a, 0, course_a, b, 0, course_b, until)
