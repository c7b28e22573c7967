"""How close two placed bodies are: signed distance, where, and along which normal.

The engine's own depth is wrong for aligned shapes, so everything that is said about a contact
rests on these kernels: separating axes where parts overlap, vertex to edge where they are apart.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, IntArray

Found = tuple[float, float, float, float, float]
"""Signed distance [m], point x, y [m], unit normal nx, ny from the first to the second."""


@compiled
def placed(vertices: FloatArray, pose: FloatArray) -> FloatArray:
    """Return vertices (n, 2) of a body frame in the world frame; ``pose`` (3,) x, y, heading."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    out = np.empty_like(vertices)
    for i in range(len(vertices)):
        x, y = vertices[i, 0], vertices[i, 1]
        out[i, 0] = pose[0] + c * x - s * y
        out[i, 1] = pose[1] + s * x + c * y
    return out


@compiled
def _widest_axis(a: FloatArray, b: FloatArray) -> Found:
    """Best separating axis among the edge normals of ``a``, with b's deepest point along it."""
    best, px, py, mx, my = -np.inf, 0.0, 0.0, 0.0, 0.0
    for i in range(len(a)):
        j = (i + 1) % len(a)
        ex, ey = a[j, 0] - a[i, 0], a[j, 1] - a[i, 1]
        length = np.hypot(ex, ey)
        nx, ny = ey / length, -ex / length
        least, count, sx, sy = np.inf, 0, 0.0, 0.0
        for k in range(len(b)):
            gap = (b[k, 0] - a[i, 0]) * nx + (b[k, 1] - a[i, 1]) * ny
            if gap < least - 1e-9:
                least, count, sx, sy = gap, 1, b[k, 0], b[k, 1]
            elif gap <= least + 1e-9:
                least, count = min(gap, least), count + 1
                sx, sy = sx + b[k, 0], sy + b[k, 1]
        if least > best:
            best, px, py, mx, my = least, sx / count, sy / count, nx, ny
    return best, px, py, mx, my


@compiled
def _vertex_to_edge(a: FloatArray, b: FloatArray) -> Found:
    """Shortest way from an edge of ``a`` to a vertex of ``b``; midpoint, direction a to b."""
    best, px, py, nx, ny = np.inf, 0.0, 0.0, 0.0, 0.0
    for i in range(len(a)):
        j = (i + 1) % len(a)
        ex, ey = a[j, 0] - a[i, 0], a[j, 1] - a[i, 1]
        square = ex * ex + ey * ey
        for k in range(len(b)):
            t = ((b[k, 0] - a[i, 0]) * ex + (b[k, 1] - a[i, 1]) * ey) / square
            t = min(1.0, max(0.0, t))
            qx, qy = a[i, 0] + t * ex, a[i, 1] + t * ey
            dx, dy = b[k, 0] - qx, b[k, 1] - qy
            length = np.hypot(dx, dy)
            if 0.0 < length < best:
                best, nx, ny = length, dx / length, dy / length
                px, py = 0.5 * (qx + b[k, 0]), 0.5 * (qy + b[k, 1])
    return best, px, py, nx, ny


@compiled
def part_closeness(a: FloatArray, b: FloatArray) -> Found:
    """Closeness of two convex parts (n, 2), world frame; the point of an overlap is the deepest."""
    of_a = _widest_axis(a, b)
    of_b = _widest_axis(b, a)
    if max(of_a[0], of_b[0]) <= 0.0:
        if of_a[0] >= of_b[0]:
            return of_a
        return of_b[0], of_b[1], of_b[2], -of_b[3], -of_b[4]
    of_a = _vertex_to_edge(a, b)
    of_b = _vertex_to_edge(b, a)
    if of_a[0] <= of_b[0]:
        return of_a
    return of_b[0], of_b[1], of_b[2], -of_b[3], -of_b[4]


@compiled
def parts_apart(a: FloatArray, pose_a: FloatArray, b: FloatArray, pose_b: FloatArray) -> float:
    """Signed distance [m] of two convex parts, each in its body's frame, at their poses (3,)."""
    return part_closeness(placed(a, pose_a), placed(b, pose_b))[0]


@compiled
def body_closeness(
    vertices: FloatArray,
    part_start: IntArray,
    body_start: IntArray,
    pose: FloatArray,
    a: int,
    b: int,
) -> Found:
    """Closeness of bodies ``a`` and ``b`` at poses (B, 3): that of their closest pair of parts."""
    best = (np.inf, 0.0, 0.0, 0.0, 0.0)
    for p in range(body_start[a], body_start[a + 1]):
        of_a = placed(vertices[part_start[p] : part_start[p + 1]], pose[a])
        for q in range(body_start[b], body_start[b + 1]):
            of_b = placed(vertices[part_start[q] : part_start[q + 1]], pose[b])
            found = part_closeness(of_a, of_b)
            if found[0] < best[0]:
                best = found
    return best
