"""What the public functions of the geometry take, checked: shapes, poses, twists, horizons.

All raise `PhysimError`, one line that names the argument.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from physim.errors import PhysimError
from physim.geometry.motion import Course, arc_course, straight_course
from physim.geometry.polygon import convex_parts
from physim.geometry.shapes import FloatArray, Shapes, pack_shapes

ShapeLike = ArrayLike | Sequence[ArrayLike]


def course_of(pose: ArrayLike, twist: ArrayLike, radius: float, which: str) -> Course:
    """Course of a body from its pose (3,) and twist (2,) or (3,)."""
    at = numbers(pose, f"pose_{which}", (3,), "x, y, heading")
    speeds = numbers(twist, f"twist_{which}", (2, 3), "v, omega or vx, vy, omega")
    if len(speeds) == 2:
        return arc_course(at, float(speeds[0]), float(speeds[1]), radius)
    return straight_course(at, float(speeds[0]), float(speeds[1]), float(speeds[2]), radius)


def bodies_of(
    footprint_a: ShapeLike,
    pose_a: ArrayLike,
    twist_a: ArrayLike,
    footprint_b: ShapeLike,
    pose_b: ArrayLike,
    twist_b: ArrayLike,
) -> tuple[Shapes, Course, Shapes, Course]:
    """Both bodies with their courses: shapes and course of a, then of b."""
    a = pack_shapes([parts_of(footprint_a, "footprint_a")])
    b = pack_shapes([parts_of(footprint_b, "footprint_b")])
    course_a = course_of(pose_a, twist_a, float(a.radius[0]), "a")
    course_b = course_of(pose_b, twist_b, float(b.radius[0]), "b")
    return a, course_a, b, course_b


def numbers(values: ArrayLike, what: str, lengths: tuple[int, ...], names: str) -> FloatArray:
    """Finite numbers, as many as one of ``lengths``."""
    array = array_of(values, what)
    if array.ndim != 1 or len(array) not in lengths or not np.isfinite(array).all():
        raise PhysimError(f"{what}: {values!r} given; finite numbers {names} are needed")
    return array


def array_of(values: Any, what: str, copy: bool | None = True) -> FloatArray:
    """Values as an array of floats; a copy, unless ``copy`` is None (only where needed)."""
    try:
        return np.array(values, dtype=np.float64, copy=copy)
    except (TypeError, ValueError):
        raise PhysimError(f"{what}: not an array of numbers") from None


def points_of(values: Any, what: str) -> FloatArray:
    """Finite points (n, 2), n >= 1."""
    points = array_of(values, what)
    if points.ndim != 2 or points.shape[1] != 2 or not len(points):
        raise PhysimError(f"{what}: array of shape {points.shape} given; (n, 2) is needed")
    if not np.isfinite(points).all():
        raise PhysimError(f"{what}: a coordinate is not finite")
    return points


def parts_of(shape: Any, what: str) -> tuple[FloatArray, ...]:
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
        points = points_of(item, what)
        if len(points) < 3:
            parts.append(points)
            continue
        try:
            parts += convex_parts(points)
        except PhysimError as error:
            raise PhysimError(f"{what}: {error}") from None
    return tuple(parts)


def pack_at(parts: Sequence[FloatArray], origin: FloatArray) -> Shapes:
    """One body, seen from ``origin``."""
    return pack_shapes([[part - origin for part in parts]])


def horizon_of(horizon: float) -> float:
    """A time >= 0 [s]; inf is allowed."""
    if not float(horizon) >= 0.0:
        raise PhysimError(f"horizon: {horizon} given; a time >= 0 s is allowed")
    return float(horizon)
