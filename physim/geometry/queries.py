"""Distances and collision times for use from Python: of two shapes, or of many pairs at once.

A shape is given as one of

- a simple polygon: array (n, 2) [m] of n >= 3 corners in either direction, nonconvex too;
- a segment (2, 2) or a point (1, 2);
- a sequence of these, taken together: convex parts, or a polyline as `polyline` gives it.

Shapes are closed sets: touching ones have distance 0 and collide. Anything else raises
`PhysimError`, one line that names the argument. The kernels behind these functions are in
`bodies` and `collision`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from physim.compiled import compiled
from physim.errors import PhysimError
from physim.geometry.advancement import MOST_STEPS, advancement_time
from physim.geometry.bodies import body_distance, body_separation
from physim.geometry.collision import bodies_time, never_meet, part_time, translation_times
from physim.geometry.motion import (
    Course,
    along_course,
    arc_course,
    moves_straight,
    straight_course,
    twists,
)
from physim.geometry.polygon import convex_parts, is_convex_part
from physim.geometry.shapes import FloatArray, IntArray, Part, Rows3, Shapes, locked, pack_parts
from physim.tolerances import CONTACT

ShapeLike = ArrayLike | Sequence[ArrayLike]
Point = tuple[float, float]

DEPTH = 0.01 * CONTACT
"""[m] Shapes overlap for sure where their depth is more than this: above rounding up to 10 km."""

FIRST_STRIDE = 1e-9
"""[s] First look for an overlap after a contact; strides double from there."""

ROWS = {"pose": {3: "x, y, heading"}, "twist": {2: "v, omega", 3: "vx, vy, omega"}}
"""How many numbers a row of an argument may have, and which they are"""
FRAMES = ("world", "body")
"""In which the three numbers of a twist may be"""


# Arguments


def array_of(values: Any, what: str) -> FloatArray:
    """Values as an array of floats."""
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise PhysimError(f"{what}: not an array of numbers") from None


def points_of(values: Any, what: str) -> FloatArray:
    """Finite points (n, 2), n >= 1."""
    points = array_of(values, what).copy()
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
        if len(points) < 3 or is_convex_part(points, len(points)):
            parts.append(points)
            continue
        try:
            parts += convex_parts(points)
        except PhysimError as error:
            raise PhysimError(f"{what}: {error}") from None
    return tuple(parts)


def horizon_of(horizon: float) -> float:
    """A time >= 0 [s]; inf is allowed."""
    if not float(horizon) >= 0.0:
        raise PhysimError(f"horizon: {horizon} given; a time >= 0 s is allowed")
    return float(horizon)


def rows_of(values: Any, what: str, count: int) -> FloatArray:
    """Poses (count, 3), or twists (count, 2 or 3), from as many rows or one; read-only."""
    rows = array_of(values, what)
    widths = ROWS[what.split("_")[0]]
    if rows.ndim == 1 and len(rows) in widths:
        rows = np.broadcast_to(rows, (count, len(rows)))
    if rows.ndim != 2 or len(rows) != count or rows.shape[1] not in widths:
        allowed = " or ".join(f"({count}, {width}) {names}" for width, names in widths.items())
        raise PhysimError(f"{what}: shape {rows.shape} given; {allowed} is needed")
    if not np.isfinite(rows).all():
        k = int(np.argmin(np.isfinite(rows).all(axis=1)))
        raise PhysimError(f"{what}: row {k} is {rows[k].tolist()}; finite numbers are needed")
    return cast(FloatArray, locked(np.ascontiguousarray(rows)))


def twists_of(values: Any, what: str, count: int, frame: str) -> tuple[FloatArray, bool]:
    """Twists (count, 3), and whether they are (v, omega, lateral), arcs, not (vx, vy, omega)."""
    if frame not in FRAMES:
        raise PhysimError(f"frame: {frame!r} given; allowed: {' or '.join(map(repr, FRAMES))}")
    rows = rows_of(values, what, count)
    return twists(rows), rows.shape[1] == 2 or frame == "body"


def indices_of(values: Any, what: str, shapes: Shapes, count: int) -> IntArray:
    """Indices (count,) of bodies, from as many or one; read-only."""
    index = np.asarray(values)
    bodies = len(shapes.body_start) - 1
    if index.size and not np.issubdtype(index.dtype, np.integer):
        raise PhysimError(f"{what}: {index.dtype} given; whole numbers are needed")
    if index.ndim > 1 or (index.ndim == 1 and len(index) != count):
        raise PhysimError(f"{what}: shape {index.shape} given; ({count},) or one number is needed")
    if index.size and not (index.min() >= 0 and index.max() < bodies):
        wrong = index.min() if index.min() < 0 else index.max()
        raise PhysimError(f"{what}: body {wrong} given; 0 to {bodies - 1} are there")
    return cast(IntArray, locked(np.ascontiguousarray(np.broadcast_to(index, (count,)), np.int64)))


def count_of(indices: Sequence[Any], rows: Sequence[Any]) -> int:
    """How many pairs indices and rows are about."""
    lengths = [np.size(index) for index in indices if np.ndim(index)]
    lengths += [len(np.asarray(row)) for row in rows if np.ndim(row) == 2]
    return 0 if 0 in lengths else max(lengths, default=1)


# Shapes


def pack_shapes(bodies: Sequence[ShapeLike]) -> Shapes:
    """Pack bodies [m], each a shape in its own frame; PhysimError names one that is no shape."""
    if not np.iterable(bodies):
        raise PhysimError(f"bodies: {bodies!r} given; a sequence of shapes is needed")
    return pack_parts([parts_of(body, f"bodies[{k}]") for k, body in enumerate(bodies)])


def polyline(points: ArrayLike) -> tuple[FloatArray, ...]:
    """Segments (2, 2) of a polyline (n, 2), n >= 2 [m]: a shape without an inside."""
    line = points_of(points, "polyline")
    if len(line) < 2:
        raise PhysimError(f"polyline: {len(line)} point given; at least 2 are needed")
    return tuple(line[k : k + 2] for k in range(len(line) - 1))


# Two shapes


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
    pair = pack_parts([[part - origin for part in parts] for parts in (parts_a, parts_b)])
    d, nx, ny, ax, ay, bx, by = body_separation(pair, 0, still, pair, 1, still)
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
    frame: str = "world",
) -> float:
    """Collision time (11) [s]: when two shapes first touch if both keep their twists.

    Footprints are in the body frames, poses (x, y, heading) [m, m, rad] in the world frame. A
    twist is (v, omega) [m/s, rad/s] in the body frame, an arc, or (vx, vy, omega) in the world
    frame, a straight line while turning; (0, 0) stands still. With ``frame="body"`` three numbers
    are (v, omega, lateral), the command of an omnidirectional robot: an arc, too.

    0 while they overlap or touch (within 1e-9 m); inf when they do not touch up to ``horizon``
    [s]. Never late: at every earlier instant they are apart, and at the time returned they are
    within 1e-9 m; a pass within 1e-9 m may count either way.
    """
    until = horizon_of(horizon)
    bodies = (footprint_a, pose_a, twist_a), (footprint_b, pose_b, twist_b)
    shapes, a, b = _two_bodies(*bodies, frame)
    return bodies_time(shapes, 0, a, shapes, 1, b, until)


def _two_bodies(
    a: tuple[ShapeLike, ArrayLike, ArrayLike],
    b: tuple[ShapeLike, ArrayLike, ArrayLike],
    frame: str,
) -> tuple[Shapes, Course, Course]:
    """Both bodies, each a footprint, a pose and a twist, packed, and their courses."""
    shapes = pack_parts([parts_of(a[0], "footprint_a"), parts_of(b[0], "footprint_b")])
    moving = [
        (rows_of(body[1], f"pose_{name}", 1), *twists_of(body[2], f"twist_{name}", 1, frame))
        for name, body in (("a", a), ("b", b))
    ]
    one, other = (
        course_of(pose[0], twist[0], is_arc, radius)
        for (pose, twist, is_arc), radius in zip(moving, shapes.radius, strict=True)
    )
    return shapes, one, other


@dataclass(frozen=True)
class CertifiedTime:
    """A collision time with bounds of the exact one, all in [s].

    The exact time is the first instant at which the closed shapes have a point in common, inf if
    there is none up to the horizon: lower <= exact <= upper.
    """

    time: float
    """as `collision_time` gives it; inf: none up to the horizon"""
    lower: float
    """at every earlier instant the shapes are apart; finite while ``time`` is inf where they pass
    each other within 1e-9 m"""
    upper: float
    """here they overlap for sure, by more than 1e-11 m; inf where no overlap was found: no
    contact, a graze, or shapes without an inside"""
    capped: bool
    """the advances reached their cap: ``time`` is a lower bound only"""


def collision_time_certified(
    footprint_a: ShapeLike,
    pose_a: ArrayLike,
    twist_a: ArrayLike,
    footprint_b: ShapeLike,
    pose_b: ArrayLike,
    twist_b: ArrayLike,
    horizon: float = 10.0,
    frame: str = "world",
) -> CertifiedTime:
    """Return `collision_time` with a lower and an upper bound [s], and whether the cap was hit.

    Arguments, units and errors are those of `collision_time`: footprints (n, 2) [m], or several
    together (a boundary: ``polyline(points)`` with pose (0, 0, 0) and twist (0, 0)), poses (3,),
    twists (v, omega) in the body frame or (vx, vy, omega) in the ``frame``'s. Raises `PhysimError`
    for anything else.

    ``time`` errs early by at most what it takes to close 1e-9 m, never late. Where the shapes
    close at 1e-3 m/s or more and overlap, the bounds are within 2e-6 s of each other.
    """
    until = horizon_of(horizon)
    bodies = (footprint_a, pose_a, twist_a), (footprint_b, pose_b, twist_b)
    shapes, a, b = _two_bodies(*bodies, frame)
    if never_meet(a, b, until):
        return CertifiedTime(math.inf, math.inf, math.inf, False)
    time, lower, capped = certified_start(shapes, a, b, until)
    upper = math.inf if math.isinf(time) else _overlap_after(shapes, a, b, time, until)
    return CertifiedTime(time, min(lower, time), upper, capped)


@compiled
def certified_start(
    shapes: Shapes, a: Course, b: Course, horizon: float
) -> tuple[float, float, bool]:
    """Return (collision time [s], lower bound of the exact one, was the cap of advances hit?).

    Of bodies 0 and 1. The time is that of `collision.bodies_time`, to the last bit.
    """
    V, start, first = shapes.vertices, shapes.part_start, shapes.body_start
    straight = moves_straight(a, b)
    xi, lower, capped = np.inf, np.inf, False
    for p in range(first[0], first[1]):
        P = Part(V, start[p], start[p + 1])
        for q in range(first[1], first[2]):
            Q = Part(V, start[q], start[q + 1])
            until, stopped = min(xi, horizon), False
            if straight:
                time = part_time(P, a, Q, b, until)
                near = translation_times(P, a, Q, b, until)
                if near.near_last >= 0.0 and near.near_first <= min(near.near_last, until):
                    lower = min(lower, max(0.0, near.near_first))
            else:
                time, d, steps = advancement_time(P, a, Q, b, until)
                lower = min(lower, time)
                stopped = steps >= MOST_STEPS and d > CONTACT
            if time < xi:
                xi, capped = time, stopped
    return xi, lower, capped


def _overlap_after(shapes: Shapes, a: Course, b: Course, start: float, horizon: float) -> float:
    """Return a time from ``start`` on at which two bodies overlap for sure; inf if none is found.

    As near to the start as can be found: sought in strides that double, then by bisection.
    """

    def overlaps(t: float) -> bool:
        at = (along_course(course, t) for course in (a, b))
        one, other = (np.array([x, y, math.atan2(s, c)]) for x, y, c, s, _, _ in at)
        return body_distance(shapes, 0, one, shapes, 1, other) < -DEPTH

    if overlaps(start):
        return start
    stride, low = FIRST_STRIDE, start
    while low < horizon:
        high = min(start + stride, horizon)
        if overlaps(high):
            for _ in range(60):
                t = 0.5 * (low + high)
                low, high = (low, t) if overlaps(t) else (t, high)
            return high
        low = high
        stride *= 2.0
    return math.inf


# Many pairs


def shortest_distances(
    shapes_a: Shapes,
    index_a: ArrayLike,
    pose_a: ArrayLike,
    shapes_b: Shapes,
    index_b: ArrayLike,
    pose_b: ArrayLike,
) -> FloatArray:
    """Shortest distances (11) [m] of M pairs (M,); 0 where the two intersect.

    Pair k: body ``index_a[k]`` of ``shapes_a`` (see `pack_shapes`), at ``pose_a[k]``, and the same
    of b. Indices are (M,) whole numbers, poses (M, 3) x, y, heading [m, m, rad], world frame; one
    pose (3,) or one index serves for all pairs.

    Exact to about 1e-15 of the size of the shapes and of their distance, either way. Raises
    `PhysimError` where arrays do not fit together, an index names no body, or a pose is not finite.
    """
    count = count_of((index_a, index_b), (pose_a, pose_b))
    i, p = indices_of(index_a, "index_a", shapes_a, count), rows_of(pose_a, "pose_a", count)
    j, q = indices_of(index_b, "index_b", shapes_b, count), rows_of(pose_b, "pose_b", count)
    out = np.empty(count)
    fill_distances(shapes_a, i, p, shapes_b, j, q, count, out)
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
    frame: str = "world",
) -> FloatArray:
    """Collision times (11) [s] of M pairs (M,): each as `collision_time` gives it, inf if none.

    Bodies and poses as in `shortest_distances`. Twists are (M, 2) (v, omega) [m/s, rad/s] in the
    body frames, or (M, 3) (vx, vy, omega) in the world frame; one twist serves for all pairs. With
    ``frame="body"`` three numbers are (v, omega, lateral), as in `collision_time`.

    Never late: at every earlier instant the shapes are apart, and at the time they are within
    1e-9 m, unless the cap of advances was reached (`collision_time_certified` reports it): then it
    is a lower bound. Raises `PhysimError` as `shortest_distances` does.
    """
    until = horizon_of(horizon)
    count = count_of((index_a, index_b), (pose_a, pose_b, twist_a, twist_b))
    i, p = indices_of(index_a, "index_a", shapes_a, count), rows_of(pose_a, "pose_a", count)
    j, q = indices_of(index_b, "index_b", shapes_b, count), rows_of(pose_b, "pose_b", count)
    u, w = (twists_of(*one, count, frame) for one in ((twist_a, "twist_a"), (twist_b, "twist_b")))
    out = np.empty(count)
    fill_times(shapes_a, i, p, *u, shapes_b, j, q, *w, until, count, out)
    return out


@compiled
def fill_distances(
    shapes_a: Shapes,
    index_a: IntArray,
    pose_a: Rows3,
    shapes_b: Shapes,
    index_b: IntArray,
    pose_b: Rows3,
    many: int,
    out: FloatArray,
) -> None:
    """Write `shortest_distances` into ``out`` (M,)."""
    for k in range(many):
        d = body_distance(shapes_a, index_a[k], pose_a[k], shapes_b, index_b[k], pose_b[k])
        out[k] = max(0.0, d)


@compiled
def course_of(pose: FloatArray, twist: FloatArray, is_arc: bool, radius: float) -> Course:
    """Course of a body at a pose (3,) with a twist (3,) as `twists_of` gives it."""
    x, y, heading = pose[0], pose[1], pose[2]
    if is_arc:
        return arc_course(x, y, heading, twist[0], twist[1], twist[2], radius)
    return straight_course(x, y, heading, twist[0], twist[1], twist[2], radius)


@compiled
def fill_times(
    shapes_a: Shapes,
    index_a: IntArray,
    pose_a: Rows3,
    twist_a: Rows3,
    is_arc_a: bool,
    shapes_b: Shapes,
    index_b: IntArray,
    pose_b: Rows3,
    twist_b: Rows3,
    is_arc_b: bool,
    horizon: float,
    many: int,
    out: FloatArray,
) -> None:
    """Write `collision_times` into ``out`` (M,); twists are those of `twists_of`."""
    for k in range(many):
        i = index_a[k]
        j = index_b[k]
        a = course_of(pose_a[k], twist_a[k], is_arc_a, shapes_a.radius[i])
        b = course_of(pose_b[k], twist_b[k], is_arc_b, shapes_b.radius[j])
        out[k] = bodies_time(shapes_a, i, a, shapes_b, j, b, horizon)
