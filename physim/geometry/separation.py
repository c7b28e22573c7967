"""Signed distance of polygon bodies, in kernels: value for control, value with witness for reports.

A body is a run of convex parts (`Shapes`); its signed distance to another is the smallest over the
pairs of parts. Positive: apart. Negative: the depth of the deepest pair of parts. Distances are
[m], exact to a few 1e-15 m for bodies of metres; poses are (3,) x, y [m], heading [rad].

- For control: `body_distance`, `wall_distance` give the value alone.
- For reports: `body_separation`, `wall_separation` also give the unit normal from a to b (of
  least penetration where they overlap) and the witness points: the closest points where apart,
  the deepest points of either shape within the other where they overlap. `describe_pair` makes
  a row of a report of them. The engine's own depth is wrong for aligned shapes, so nothing is
  said about a contact but by these.

The value is the same in both, bit for bit. Bounds only skip parts that cannot win.
"""

from __future__ import annotations

import math

import numpy as np

from physim.compiled import compiled
from physim.geometry.convex import Frame, part_gap
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.geometry.witness import Witness, part_witness

BOUND_MARGIN = 1e-9
"""[m] A bound must beat the best distance by this, so that rounding of the bound cannot matter."""


@compiled
def relative_frame(pose_a: FloatArray, pose_b: FloatArray) -> Frame:
    """Return (c, s, tx, ty): a point q of b's frame is at R(c, s) q + t in a's frame."""
    return frame_from(pose_a, math.cos(pose_a[2]), math.sin(pose_a[2]), pose_b)


@compiled
def frame_from(pose_a: FloatArray, ca: float, sa: float, pose_b: FloatArray) -> Frame:
    """`relative_frame` where cosine and sine of a's heading are known."""
    dx = pose_b[0] - pose_a[0]
    dy = pose_b[1] - pose_a[1]
    turn = pose_b[2] - pose_a[2]
    return math.cos(turn), math.sin(turn), ca * dx + sa * dy, ca * dy - sa * dx


@compiled
def body_gap(
    P: FloatArray,
    p_start: IntArray,
    p_first: int,
    p_last: int,
    Q: FloatArray,
    q_start: IntArray,
    q_first: int,
    q_last: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    enough: float = np.inf,
) -> float:
    """Smallest `part_gap` of parts p_first..p_last-1 and q_first..q_last-1.

    Exact where it is below ``enough``; otherwise some number from ``enough`` up to it. The arrays
    come apart from their `Shapes` because handing those on costs time in each call.
    """
    best = np.inf
    for p in range(p_first, p_last):
        for q in range(q_first, q_last):
            gap = part_gap(
                P, p_start[p], p_start[p + 1], Q, q_start[q], q_start[q + 1],
                c, s, tx, ty, 0.0, 0.0, min(best, enough),
            )  # fmt: skip
            best = min(best, gap)
    return best


@compiled
def body_distance(
    shapes_a: Shapes, i: int, pose_a: FloatArray, shapes_b: Shapes, j: int, pose_b: FloatArray
) -> float:
    """Signed distance [m] of body i of ``shapes_a`` at ``pose_a`` and body j of ``shapes_b``."""
    c, s, tx, ty = relative_frame(pose_a, pose_b)
    return body_gap(
        shapes_a.vertices, shapes_a.part_start, shapes_a.body_start[i], shapes_a.body_start[i + 1],
        shapes_b.vertices, shapes_b.part_start, shapes_b.body_start[j], shapes_b.body_start[j + 1],
        c, s, tx, ty,
    )  # fmt: skip


@compiled
def point_gap(P: FloatArray, p0: int, p1: int, x: float, y: float) -> float:
    """Lower bound of the signed distance of a point from a part, exact for a segment."""
    if p1 - p0 == 2:
        ex = P[p0 + 1, 0] - P[p0, 0]
        ey = P[p0 + 1, 1] - P[p0, 1]
        dx = x - P[p0, 0]
        dy = y - P[p0, 1]
        size = ex * ex + ey * ey
        share = 0.0
        if size > 0.0:
            share = min(1.0, max(0.0, (ex * dx + ey * dy) / size))
        dx -= share * ex
        dy -= share * ey
        return math.sqrt(dx * dx + dy * dy)
    best = -np.inf
    k = p1 - 1
    for m in range(p0, p1):
        ex = P[m, 0] - P[k, 0]
        ey = P[m, 1] - P[k, 1]
        length = math.sqrt(ex * ex + ey * ey)
        if length > 0.0:
            best = max(best, (ey * (x - P[k, 0]) - ex * (y - P[k, 1])) / length)
        k = m
    return best


@compiled
def wall_gap(
    W: FloatArray,
    w0: int,
    w1: int,
    Q: FloatArray,
    q_start: IntArray,
    q_first: int,
    q_last: int,
    radius: float,
    c: float,
    s: float,
    x: float,
    y: float,
    enough: float,
) -> float:
    """Signed distance [m] of a wall part ``W[w0:w1]`` and a body at (x, y), heading (c, s).

    Exact where it is below ``enough``; otherwise some number from ``enough`` up to it.
    """
    bound = point_gap(W, w0, w1, x, y) - radius - BOUND_MARGIN
    if bound >= enough:
        return bound
    best = np.inf
    for q in range(q_first, q_last):
        best = min(
            best,
            part_gap(
                W, w0, w1, Q, q_start[q], q_start[q + 1], c, s, x, y, 0.0, 0.0, min(best, enough)
            ),
        )
    return best


@compiled
def nearest_wall(
    shapes: Shapes, i: int, pose: FloatArray, walls: Shapes, part_ids: IntArray
) -> tuple[float, int]:
    """Signed distance [m] of robot i from the nearest of the given wall parts, and that part.

    (inf, -1) when no part is given. Of equally near parts the first given wins.
    """
    W = walls.vertices
    w_start = walls.part_start
    Q = shapes.vertices
    q_start = shapes.part_start
    q_first = shapes.body_start[i]
    q_last = shapes.body_start[i + 1]
    radius = shapes.radius[i]
    c = math.cos(pose[2])
    s = math.sin(pose[2])
    best = np.inf
    nearest = -1
    for part in part_ids:
        gap = wall_gap(
            W, w_start[part], w_start[part + 1], Q, q_start, q_first, q_last, radius,
            c, s, pose[0], pose[1], best,
        )  # fmt: skip
        if gap < best:
            best = gap
            nearest = part
    return best, nearest


@compiled
def wall_distance(
    shapes: Shapes, i: int, pose: FloatArray, walls: Shapes, part_ids: IntArray
) -> float:
    """Signed distance [m] of robot i at ``pose`` from the given wall parts; inf without any."""
    return nearest_wall(shapes, i, pose, walls, part_ids)[0]


@compiled
def nearly_nearest(radius: float, shapes: Shapes, j: int, x: float, y: float) -> float:
    """Distance [m] from (x, y), of j's frame, beyond which no segment of body j is the nearest.

    The nearest is wanted to a body of a ``radius`` about that point. inf for a single part.
    """
    if shapes.body_start[j + 1] - shapes.body_start[j] == 1:
        return np.inf
    near = np.inf
    for q in range(shapes.body_start[j], shapes.body_start[j + 1]):
        q0, q1 = shapes.part_start[q], shapes.part_start[q + 1]
        if q1 - q0 == 2:
            near = min(near, point_gap(shapes.vertices, q0, q1, x, y))
    return near + 2.0 * radius + BOUND_MARGIN


@compiled
def body_separation(
    shapes_a: Shapes, i: int, pose_a: FloatArray, shapes_b: Shapes, j: int, pose_b: FloatArray
) -> Witness:
    """`body_distance` with unit normal from a to b and a witness point on each, world frame.

    Returned as (distance, nx, ny, ax, ay, bx, by).
    """
    c, s, tx, ty = relative_frame(pose_a, pose_b)
    # Where the origin of a is for b.
    ox, oy = -(c * tx + s * ty), s * tx - c * ty
    near = nearly_nearest(shapes_a.radius[i], shapes_b, j, ox, oy)
    parts_a = shapes_a.body_start[i + 1] - shapes_a.body_start[i]
    only = parts_a == 1 and shapes_b.body_start[j + 1] - shapes_b.body_start[j] == 1
    best = np.inf
    found = (np.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        p0 = shapes_a.part_start[p]
        p1 = shapes_a.part_start[p + 1]
        for q in range(shapes_b.body_start[j], shapes_b.body_start[j + 1]):
            q0 = shapes_b.part_start[q]
            q1 = shapes_b.part_start[q + 1]
            P = shapes_a.vertices
            Q = shapes_b.vertices
            if q1 - q0 == 2 and point_gap(Q, q0, q1, ox, oy) > near:
                continue
            if only or part_gap(P, p0, p1, Q, q0, q1, c, s, tx, ty, 0.0, 0.0, best) < best:
                found = part_witness(P, p0, p1, Q, q0, q1, c, s, tx, ty, 0.0, 0.0)
                best = found[0]
    ca = math.cos(pose_a[2])
    sa = math.sin(pose_a[2])
    d, nx, ny, ax, ay, bx, by = found
    return (
        d,
        ca * nx - sa * ny,
        sa * nx + ca * ny,
        pose_a[0] + (ca * ax - sa * ay),
        pose_a[1] + (sa * ax + ca * ay),
        pose_a[0] + (ca * bx - sa * by),
        pose_a[1] + (sa * bx + ca * by),
    )


@compiled
def wall_separation(
    shapes: Shapes, i: int, pose: FloatArray, walls: Shapes, part_ids: IntArray
) -> Witness:
    """`wall_distance` with witness: normal from robot i (a) to the wall (b), world frame."""
    d, part = nearest_wall(shapes, i, pose, walls, part_ids)
    if part < 0:
        return (d, 0.0, 0.0, pose[0], pose[1], pose[0], pose[1])
    c = math.cos(pose[2])
    s = math.sin(pose[2])
    p0 = walls.part_start[part]
    p1 = walls.part_start[part + 1]
    best = np.inf
    found = (np.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for q in range(shapes.body_start[i], shapes.body_start[i + 1]):
        q0 = shapes.part_start[q]
        q1 = shapes.part_start[q + 1]
        W = walls.vertices
        Q = shapes.vertices
        gap = part_gap(W, p0, p1, Q, q0, q1, c, s, pose[0], pose[1], 0.0, 0.0, best)
        if gap < best:
            best = gap
            found = part_witness(W, p0, p1, Q, q0, q1, c, s, pose[0], pose[1], 0.0, 0.0)
    _, nx, ny, ax, ay, bx, by = found
    return d, -nx, -ny, bx, by, ax, ay


@compiled
def place(shapes: Shapes, i: int, pose: FloatArray, out: FloatArray) -> int:
    """Write the vertices of body i at ``pose``, world frame, into the first rows of ``out``.

    Returns how many; they are in the order of ``shapes.vertices``, part by part.
    """
    c = math.cos(pose[2])
    s = math.sin(pose[2])
    first = shapes.part_start[shapes.body_start[i]]
    last = shapes.part_start[shapes.body_start[i + 1]]
    for k in range(first, last):
        x = shapes.vertices[k, 0]
        y = shapes.vertices[k, 1]
        out[k - first, 0] = pose[0] + (c * x - s * y)
        out[k - first, 1] = pose[1] + (s * x + c * y)
    return int(last - first)


@compiled
def describe_pair(
    shapes_a: Shapes,
    a: int,
    pose_a: FloatArray,
    shapes_b: Shapes,
    b: int,
    pose_b: FloatArray,
    out: FloatArray,
) -> None:
    """Write x, y, nx, ny and signed distance [m] of two bodies into ``out`` (5,).

    The point [m] lies midway between the deepest points of either body within the other, or
    midway between the nearest points where they are apart; the unit normal leads from a to b.
    """
    d, nx, ny, ax, ay, bx, by = body_separation(shapes_a, a, pose_a, shapes_b, b, pose_b)
    out[0] = 0.5 * (ax + bx)
    out[1] = 0.5 * (ay + by)
    out[2] = nx
    out[3] = ny
    out[4] = d


@compiled
def describe_pairs(shapes: Shapes, pose: FloatArray, pairs: IntArray) -> FloatArray:
    """Return (M, 5) for pairs (M, 2) of bodies at ``pose`` (B, 3): rows of `describe_pair`."""
    out = np.empty((len(pairs), 5))
    for k in range(len(pairs)):
        a, b = pairs[k, 0], pairs[k, 1]
        describe_pair(shapes, a, pose[a], shapes, b, pose[b], out[k])
    return out
