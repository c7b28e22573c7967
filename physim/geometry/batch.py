"""Distances and collision times of many pairs at once, on one core."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from physim.compiled import compiled
from physim.errors import PhysimError
from physim.geometry.collision import bodies_time
from physim.geometry.inputs import array_of, horizon_of
from physim.geometry.motion import Course, arc_course, straight_course
from physim.geometry.separation import body_distance
from physim.geometry.shapes import FloatArray, IntArray, Shapes


def shortest_distances(
    shapes_a: Shapes,
    index_a: ArrayLike,
    pose_a: ArrayLike,
    shapes_b: Shapes,
    index_b: ArrayLike,
    pose_b: ArrayLike,
) -> FloatArray:
    """Shortest distances (11) [m] of M pairs (M,); 0 where the two intersect.

    Pair k: body ``index_a[k]`` of ``shapes_a`` (see `pack_shapes`: convex parts, counter-clockwise,
    in the body's frame) at ``pose_a[k]``, and the same of b. Indices are (M,) whole numbers, poses
    (M, 3) x, y, heading [m, m, rad], world frame; one pose (3,) or one index serves for all pairs.

    Exact to about 1e-15 of the size of the shapes and of their distance, either way. Raises
    `PhysimError` where arrays do not fit together, an index names no body, or a pose is not finite.
    """
    count, (i, p, j, q) = _pairs(shapes_a, index_a, pose_a, shapes_b, index_b, pose_b)
    out = np.empty(count)
    fill_distances(shapes_a, i, p, shapes_b, j, q, out)
    return out


def collision_times(
    shapes_a: Shapes,
    index_a: ArrayLike,
    pose_a: ArrayLike,
    twist_a: ArrayLike,
    shapes_b: Shapes,
    index_b: ArrayLike,
    pose_b: ArrayLike,
    twist_b: ArrayLike,
    horizon: float = 10.0,
) -> FloatArray:
    """Collision times (11) [s] of M pairs (M,): each as `collision_time` gives it, inf if none.

    Bodies and poses as in `shortest_distances`. Twists are (M, 2) (v, omega) [m/s, rad/s] in the
    body frames, or (M, 3) (vx, vy, omega) in the world frame; one twist serves for all pairs.

    Never late: at every earlier instant the shapes are apart, and at the time they are within
    1e-9 m, unless the cap of advances was reached (`collision_time_certified` reports it): then it
    is a lower bound. Raises `PhysimError` as `shortest_distances` does.
    """
    until = horizon_of(horizon)
    twists = (twist_a, twist_b)
    count, (i, p, j, q) = _pairs(shapes_a, index_a, pose_a, shapes_b, index_b, pose_b, *twists)
    out = np.empty(count)
    u = _rows(twist_a, "twist_a", (2, 3), count)
    w = _rows(twist_b, "twist_b", (2, 3), count)
    fill_times(shapes_a, i, p, u, shapes_b, j, q, w, until, out)
    return out


@compiled
def fill_distances(
    shapes_a: Shapes,
    index_a: IntArray,
    pose_a: FloatArray,
    shapes_b: Shapes,
    index_b: IntArray,
    pose_b: FloatArray,
    out: FloatArray,
) -> None:
    """Write `shortest_distances` into ``out`` (M,)."""
    for k in range(len(out)):
        d = body_distance(shapes_a, index_a[k], pose_a[k], shapes_b, index_b[k], pose_b[k])
        out[k] = max(0.0, d)


@compiled
def course_at(pose: FloatArray, twist: FloatArray, k: int, radius: float) -> Course:
    """Course of row k; twists (M, 2) or (M, 3). Rows as tuples: quicker than slices of arrays."""
    start = (pose[k, 0], pose[k, 1], pose[k, 2])
    if twist.shape[1] == 2:
        return arc_course(start, twist[k, 0], twist[k, 1], radius)
    return straight_course(start, twist[k, 0], twist[k, 1], twist[k, 2], radius)


@compiled
def fill_times(
    shapes_a: Shapes,
    index_a: IntArray,
    pose_a: FloatArray,
    twist_a: FloatArray,
    shapes_b: Shapes,
    index_b: IntArray,
    pose_b: FloatArray,
    twist_b: FloatArray,
    horizon: float,
    out: FloatArray,
) -> None:
    """Write `collision_times` into ``out`` (M,)."""
    for k in range(len(out)):
        i = index_a[k]
        j = index_b[k]
        a = course_at(pose_a, twist_a, k, shapes_a.radius[i])
        b = course_at(pose_b, twist_b, k, shapes_b.radius[j])
        out[k] = bodies_time(shapes_a, i, a, shapes_b, j, b, horizon)


def _pairs(
    shapes_a: Shapes,
    index_a: ArrayLike,
    pose_a: ArrayLike,
    shapes_b: Shapes,
    index_b: ArrayLike,
    pose_b: ArrayLike,
    *more: ArrayLike,
) -> tuple[int, tuple[IntArray, FloatArray, IntArray, FloatArray]]:
    """Count of pairs, and indices (M,) and poses (M, 3) of both."""
    lengths = [np.size(index) for index in (index_a, index_b) if np.ndim(index)]
    lengths += [len(np.asarray(rows)) for rows in (pose_a, pose_b, *more) if np.ndim(rows) == 2]
    count = max(lengths, default=1)
    if 0 in lengths:
        count = 0
    return count, (
        _indices(index_a, "index_a", shapes_a, count),
        _rows(pose_a, "pose_a", (3,), count),
        _indices(index_b, "index_b", shapes_b, count),
        _rows(pose_b, "pose_b", (3,), count),
    )


def _indices(values: Any, what: str, shapes: Shapes, count: int) -> IntArray:
    index = np.asarray(values)
    bodies = len(shapes.body_start) - 1
    if index.size and not np.issubdtype(index.dtype, np.integer):
        raise PhysimError(f"{what}: {index.dtype} given; whole numbers are needed")
    if index.ndim > 1 or (index.ndim == 1 and len(index) != count):
        raise PhysimError(f"{what}: shape {index.shape} given; ({count},) or one number is needed")
    if index.size and not (index.min() >= 0 and index.max() < bodies):
        wrong = index.min() if index.min() < 0 else index.max()
        raise PhysimError(f"{what}: body {wrong} given; 0 to {bodies - 1} are there")
    return np.ascontiguousarray(np.broadcast_to(index, (count,)), dtype=np.int64)


def _rows(values: Any, what: str, widths: tuple[int, ...], count: int) -> FloatArray:
    rows = array_of(values, what, copy=None)
    if rows.ndim == 1 and len(rows) in widths:
        rows = np.broadcast_to(rows, (count, len(rows)))
    if rows.ndim != 2 or len(rows) != count or rows.shape[1] not in widths:
        allowed = " or ".join(f"({count}, {width})" for width in widths)
        raise PhysimError(f"{what}: shape {rows.shape} given; {allowed} is needed")
    if not np.isfinite(rows).all():
        raise PhysimError(f"{what}: row {int(np.argmin(np.isfinite(rows).all(axis=1)))} not finite")
    return np.ascontiguousarray(rows)
