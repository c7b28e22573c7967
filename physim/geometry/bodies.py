"""Signed distance of polygon bodies, in kernels: value for control, value with witness for reports.

A body is a run of convex parts (`Shapes`); its signed distance to another is the smallest over the
pairs of parts. Positive: apart. Negative: the depth of the deepest pair of parts. Distances are
[m], exact to a few 1e-15 m for bodies of metres; poses are (3,) x, y [m], heading [rad].

`body_distance` gives the value alone. `body_separation` also gives the unit normal from a to b (of
least penetration where they overlap) and the witness points: the closest points where apart, the
deepest points of either shape within the other where they overlap. The engine's own depth is wrong
for aligned shapes, so nothing is said about a contact but by these (`describe_pair`).

The value is the same in both, bit for bit. Bounds only skip parts that cannot win.
"""

from __future__ import annotations

import math

import numpy as np

from physim.compiled import compiled
from physim.geometry.convex import Frame, Witness, frame_at, part_gap, part_witness
from physim.geometry.shapes import FloatArray, IntRows2, Part, Rows3, Rows5, Shapes

BOUND_MARGIN = 1e-9
"""[m] A bound must beat the best distance by this, so that rounding of the bound cannot matter."""


@compiled
def relative_frame(pose_a: FloatArray, pose_b: FloatArray) -> Frame:
    """Frame of a body at ``pose_b`` as one at ``pose_a`` sees it."""
    return frame_from(pose_a, math.cos(pose_a[2]), math.sin(pose_a[2]), pose_b)


@compiled
def frame_from(pose_a: FloatArray, ca: float, sa: float, pose_b: FloatArray) -> Frame:
    """`relative_frame` where cosine and sine of a's heading are known."""
    dx = pose_b[0] - pose_a[0]
    dy = pose_b[1] - pose_a[1]
    turn = pose_b[2] - pose_a[2]
    return frame_at(math.cos(turn), math.sin(turn), ca * dx + sa * dy, ca * dy - sa * dx)


@compiled
def point_gap(P: Part, x: float, y: float) -> float:
    """Lower bound of the signed distance of a point from a part, exact for a segment."""
    V, best = P.vertices, -np.inf
    if P.end - P.first == 2:
        k = P.first
        ex = V[k + 1, 0] - V[k, 0]
        ey = V[k + 1, 1] - V[k, 1]
        dx = x - V[k, 0]
        dy = y - V[k, 1]
        size = ex * ex + ey * ey
        share = 0.0
        if size > 0.0:
            share = min(1.0, max(0.0, (ex * dx + ey * dy) / size))
        dx -= share * ex
        dy -= share * ey
        return math.sqrt(dx * dx + dy * dy)
    k = P.end - 1
    for m in range(P.first, P.end):
        ex = V[m, 0] - V[k, 0]
        ey = V[m, 1] - V[k, 1]
        length = math.sqrt(ex * ex + ey * ey)
        if length > 0.0:
            best = max(best, float(ey * (x - V[k, 0]) - ex * (y - V[k, 1])) / length)
        k = m
    return best


@compiled
def point_segment(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Distance [m] of a point from a segment."""
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    along = 0.0
    if square > 0.0:
        along = min(max(((x - ax) * dx + (y - ay) * dy) / square, 0.0), 1.0)
    distance: float = np.hypot(x - ax - along * dx, y - ay - along * dy)
    return distance


@compiled
def outline_distance(P: Part, x: float, y: float) -> float:
    """Distance [m] of a point from a part; 0 inside a solid one."""
    V, first, end = P.vertices, P.first, P.end
    if end - first == 2:
        m = first + 1
        return point_segment(x, y, V[first, 0], V[first, 1], V[m, 0], V[m, 1])
    best = np.inf
    inside = end - first > 2
    for k in range(first, end):
        m = k + 1 if k + 1 < end else first
        ax, ay = V[k, 0], V[k, 1]
        bx, by = V[m, 0], V[m, 1]
        best = min(best, point_segment(x, y, ax, ay, bx, by))
        inside = inside and (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0.0
    return 0.0 if inside else best


@compiled
def wall_gap(P: Part, shapes: Shapes, j: int, f: Frame, enough: float) -> float:
    """Signed distance [m] of one part and body j of ``shapes``, whose frame for the part is f.

    Exact where it is below ``enough``; otherwise some number from ``enough`` up to it.
    """
    if P.end - P.first == 2 and enough < np.inf:
        bound: float = point_gap(P, f.tx, f.ty) - shapes.radius[j] - BOUND_MARGIN
        if bound >= enough:
            return bound
    V, start = shapes.vertices, shapes.part_start
    best = np.inf
    for q in range(shapes.body_start[j], shapes.body_start[j + 1]):
        Q = Part(V, start[q], start[q + 1])
        best = min(best, part_gap(P, Q, f, min(best, enough)))
    return best


@compiled
def body_gap(
    shapes_a: Shapes, i: int, shapes_b: Shapes, j: int, f: Frame, enough: float = np.inf
) -> float:
    """Signed distance [m] of body i of ``shapes_a`` and body j of ``shapes_b``, in frame f.

    Exact where it is below ``enough``; otherwise some number from ``enough`` up to it. What has
    many parts comes first: it costs less so.
    """
    best = np.inf
    V, start = shapes_a.vertices, shapes_a.part_start
    W, w_start = shapes_b.vertices, shapes_b.part_start
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        P, limit = Part(V, start[p], start[p + 1]), min(best, enough)
        if P.end - P.first == 2 and limit < np.inf:
            bound = point_gap(P, f.tx, f.ty) - shapes_b.radius[j] - BOUND_MARGIN
            if bound >= limit:
                best = min(best, bound)
                continue
        # The loop of `wall_gap`, which clearances would take 4 % longer to call.
        for q in range(shapes_b.body_start[j], shapes_b.body_start[j + 1]):
            Q = Part(W, w_start[q], w_start[q + 1])
            best = min(best, part_gap(P, Q, f, min(best, enough)))
    return best


@compiled
def body_distance(
    shapes_a: Shapes, i: int, pose_a: FloatArray, shapes_b: Shapes, j: int, pose_b: FloatArray
) -> float:
    """Signed distance [m] of body i of ``shapes_a`` at ``pose_a`` and body j of ``shapes_b``."""
    return body_gap(shapes_a, i, shapes_b, j, relative_frame(pose_a, pose_b))


@compiled
def nearly_nearest(radius: float, shapes: Shapes, j: int, x: float, y: float) -> float:
    """Distance [m] from (x, y), of j's frame, beyond which no segment of body j is the nearest.

    The nearest is wanted to a body of a ``radius`` about that point. inf for a single part.
    """
    if shapes.body_start[j + 1] - shapes.body_start[j] == 1:
        return np.inf
    V, start = shapes.vertices, shapes.part_start
    near = np.inf
    for q in range(shapes.body_start[j], shapes.body_start[j + 1]):
        if start[q + 1] - start[q] == 2:
            near = min(near, point_gap(Part(V, start[q], start[q + 1]), x, y))
    return near + 2.0 * radius + BOUND_MARGIN


@compiled
def body_separation(
    shapes_a: Shapes, i: int, pose_a: FloatArray, shapes_b: Shapes, j: int, pose_b: FloatArray
) -> Witness:
    """`body_distance` with unit normal from a to b and a witness point on each, world frame."""
    f = relative_frame(pose_a, pose_b)
    # Where the origin of a is for b.
    ox, oy = -(f.c * f.tx + f.s * f.ty), f.s * f.tx - f.c * f.ty
    near = nearly_nearest(shapes_a.radius[i], shapes_b, j, ox, oy)
    parts_a = shapes_a.body_start[i + 1] - shapes_a.body_start[i]
    only: bool = parts_a == 1 and shapes_b.body_start[j + 1] - shapes_b.body_start[j] == 1
    V, start = shapes_a.vertices, shapes_a.part_start
    W, w_start = shapes_b.vertices, shapes_b.part_start
    found = Witness(np.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for p in range(shapes_a.body_start[i], shapes_a.body_start[i + 1]):
        P = Part(V, start[p], start[p + 1])
        for q in range(shapes_b.body_start[j], shapes_b.body_start[j + 1]):
            Q = Part(W, w_start[q], w_start[q + 1])
            if Q.end - Q.first == 2 and point_gap(Q, ox, oy) > near:
                continue
            if only or part_gap(P, Q, f, found.distance) < found.distance:
                found = part_witness(P, Q, f)
    d, nx, ny = found.distance, found.nx, found.ny
    ax, ay, bx, by = found.ax, found.ay, found.bx, found.by
    x, y, ca, sa = pose_a[0], pose_a[1], math.cos(pose_a[2]), math.sin(pose_a[2])
    return Witness(
        d,
        ca * nx - sa * ny,
        sa * nx + ca * ny,
        x + (ca * ax - sa * ay),
        y + (sa * ax + ca * ay),
        x + (ca * bx - sa * by),
        y + (sa * bx + ca * by),
    )


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
    found = body_separation(shapes_a, a, pose_a, shapes_b, b, pose_b)
    out[0] = 0.5 * (found.ax + found.bx)
    out[1] = 0.5 * (found.ay + found.by)
    out[2], out[3], out[4] = found.nx, found.ny, found.distance


@compiled
def describe_pairs(shapes: Shapes, pose: Rows3, pairs: IntRows2, many: int, out: Rows5) -> None:
    """Write rows of `describe_pair` of pairs (M, 2) of bodies at ``pose`` (B, 3) into ``out``."""
    for k in range(many):
        a, b = pairs[k, 0], pairs[k, 1]
        describe_pair(shapes, a, pose[a], shapes, b, pose[b], out[k])


@compiled
def describe_contact(
    shapes: Shapes,
    faces: Shapes,
    a: int,
    pose_a: FloatArray,
    b: int,
    pose_b: FloatArray,
    w: int,
    out: FloatArray,
) -> None:
    """`describe_pair` for a contact, whose normal is across the faces that wall w, body b, is part
    of; w < 0: b is no wall.

    ``shapes`` are those of robots and walls; ``faces`` has for each wall what of the solid that it
    is part of goes along it, nothing for a wall on its own.
    """
    describe_pair(shapes, a, pose_a, shapes, b, pose_b, out)
    if w >= 0 and faces.body_start[w + 1] > faces.body_start[w]:
        own = np.empty(5)
        describe_pair(shapes, a, pose_a, faces, w, pose_b, own)
        out[2], out[3] = own[2], own[3]


@compiled
def describe_contacts(
    shapes: Shapes, faces: Shapes, robots: int, pose: Rows3, pairs: IntRows2, many: int, out: Rows5
) -> None:
    """Write rows of `describe_contact` of pairs (M, 2) of bodies at ``pose`` (B, 3) into ``out``.

    Bodies from ``robots`` on are walls.
    """
    for k in range(many):
        a, b = pairs[k, 0], pairs[k, 1]
        describe_contact(shapes, faces, a, pose[a], b, pose[b], b - robots, out[k])
