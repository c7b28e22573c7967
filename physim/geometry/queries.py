"""Distances and collision times of two shapes, for use from Python.

A shape is given as one of

- a simple polygon: array (n, 2) [m] of n >= 3 corners in either direction, nonconvex too;
- a segment (2, 2) or a point (1, 2);
- a sequence of these, taken together: convex parts, or a polyline as `polyline` gives it.

Shapes are closed sets: touching ones have distance 0 and collide. Anything else raises
`PhysimError`. The kernels behind these functions are in `separation` and `collision`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from physim.errors import PhysimError
from physim.geometry.collision import bodies_time
from physim.geometry.motion import Course, arc_course, straight_course
from physim.geometry.polygon import convex_parts
from physim.geometry.separation import body_separation
from physim.geometry.shapes import FloatArray, Shapes, pack_shapes

ShapeLike = ArrayLike | Sequence[ArrayLike]
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
    line = _points(points, "polyline")
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
    parts_a = _parts(a, "first shape")
    parts_b = _parts(b, "second shape")
    # Far from the origin nothing is lost when both are seen from one of their own corners.
    origin = parts_a[0][0]
    still = np.zeros(3)
    d, nx, ny, ax, ay, bx, by = body_separation(
        _pack(parts_a, origin), 0, still, _pack(parts_b, origin), 0, still
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
    if not float(horizon) >= 0.0:
        raise PhysimError(f"horizon: {horizon} given; a time >= 0 s is allowed")
    a = pack_shapes([_parts(footprint_a, "footprint_a")])
    b = pack_shapes([_parts(footprint_b, "footprint_b")])
    course_a = _course(pose_a, twist_a, float(a.radius[0]), "a")
    course_b = _course(pose_b, twist_b, float(b.radius[0]), "b")
    return bodies_time(a, 0, course_a, b, 0, course_b, float(horizon))


def _course(pose: ArrayLike, twist: ArrayLike, radius: float, which: str) -> Course:
    at = _numbers(pose, f"pose_{which}", (3,), "x, y, heading")
    speeds = _numbers(twist, f"twist_{which}", (2, 3), "v, omega or vx, vy, omega")
    if len(speeds) == 2:
        return arc_course(at, float(speeds[0]), float(speeds[1]), radius)
    return straight_course(at, float(speeds[0]), float(speeds[1]), float(speeds[2]), radius)


def _numbers(values: ArrayLike, what: str, lengths: tuple[int, ...], names: str) -> FloatArray:
    array = _array(values, what)
    if array.ndim != 1 or len(array) not in lengths or not np.isfinite(array).all():
        raise PhysimError(f"{what}: {values!r} given; finite numbers {names} are needed")
    return array


def _array(values: Any, what: str) -> FloatArray:
    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise PhysimError(f"{what}: not an array of numbers") from None


def _points(values: Any, what: str) -> FloatArray:
    points = _array(values, what)
    if points.ndim != 2 or points.shape[1] != 2 or not len(points):
        raise PhysimError(f"{what}: array of shape {points.shape} given; (n, 2) is needed")
    if not np.isfinite(points).all():
        raise PhysimError(f"{what}: a coordinate is not finite")
    return points


def _parts(shape: Any, what: str) -> tuple[FloatArray, ...]:
    """Convex parts of a shape, counter-clockwise."""
    if not np.iterable(shape):
        raise PhysimError(f"{what}: {shape!r} given; an array (n, 2) or several are needed")
    items = list(shape)
    if items and all(np.ndim(item) == 1 for item in items):
        items = [items]
    if not items:
        raise PhysimError(f"{what}: no points given")
    parts: list[FloatArray] = []
    for item in items:
        points = _points(item, what)
        if len(points) < 3:
            parts.append(points)
            continue
        try:
            parts += convex_parts(points)
        except PhysimError as error:
            raise PhysimError(f"{what}: {error}") from None
    return tuple(parts)


def _pack(parts: Sequence[FloatArray], origin: FloatArray) -> Shapes:
    return pack_shapes([[part - origin for part in parts]])
