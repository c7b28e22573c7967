"""Where two convex parts are closest or deepest: unit normal and a point on each.

Frames and the distance itself are those of `physim.geometry.convex`.
"""

from __future__ import annotations

import math

import numpy as np

from physim.compiled import compiled
from physim.geometry.convex import part_feature, vertex_gap
from physim.geometry.shapes import FloatArray
from physim.tolerances import TIE

Witness = tuple[float, float, float, float, float, float, float]
"""signed distance, nx, ny, ax, ay, bx, by [m]: unit normal from a to b, point on a, point on b"""


@compiled
def face_witness(
    P: FloatArray,
    k: int,
    m: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    rx: float,
    ry: float,
    gap: float,
) -> tuple[bool, float, float, float, float]:
    """Return (on the edge?, x, y, nx, ny): the middle of what faces edge k-m of P, and its normal.

    The vertices of Q nearest to the edge's line (two where a side is parallel) cast a shadow on
    it; the middle of what falls on the edge is the point. If nothing does, the nearest end.
    """
    ex = P[m, 0] - P[k, 0]
    ey = P[m, 1] - P[k, 1]
    length = math.sqrt(ex * ex + ey * ey)
    ex /= length
    ey /= length
    low = np.inf
    high = -np.inf
    for j in range(q0, q1):
        qx = Q[j, 0] - rx
        qy = Q[j, 1] - ry
        dx = c * qx - s * qy + (tx - P[k, 0])
        dy = s * qx + c * qy + (ty - P[k, 1])
        if ey * dx - ex * dy <= gap + TIE:
            along = ex * dx + ey * dy
            low = min(low, along)
            high = max(high, along)
    hit = low <= length and high >= 0.0
    middle = 0.5 * (min(max(low, 0.0), length) + max(min(high, length), 0.0))
    return hit, P[k, 0] + middle * ex, P[k, 1] + middle * ey, ey, -ex


@compiled
def vertex_witness(
    P: FloatArray,
    p0: int,
    p1: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    rx: float,
    ry: float,
) -> tuple[float, float, float, float, float]:
    """Return (squared distance, px, py, dx, dy): closest vertex of Q is at p + d, p on P."""
    square, m, j, share = vertex_gap(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry)
    k = m - 1 if m > p0 else p1 - 1
    ex = share * (P[m, 0] - P[k, 0])
    ey = share * (P[m, 1] - P[k, 1])
    qx = Q[j, 0] - rx
    qy = Q[j, 1] - ry
    dx = c * qx - s * qy + (tx - P[k, 0]) - ex
    dy = s * qx + c * qy + (ty - P[k, 1]) - ey
    return square, P[k, 0] + ex, P[k, 1] + ey, dx, dy


@compiled
def outline_witness(
    P: FloatArray,
    p0: int,
    p1: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    rx: float,
    ry: float,
) -> tuple[float, float, float, float, float]:
    """Return (distance, ax, ay, dx, dy) in P's frame: closest point a on P, and b = a + d on Q.

    The distance is `outline_distance`.
    """
    square, ax, ay, dx, dy = vertex_witness(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry)
    other, bx, by, ox, oy = vertex_witness(Q, q0, q1, P, p0, p1, c, -s, rx, ry, tx, ty)
    if square <= other:
        return math.sqrt(square), ax, ay, dx, dy
    bx -= rx
    by -= ry
    # o leads from b to a in Q's frame.
    dx = -(c * ox - s * oy)
    dy = -(s * ox + c * oy)
    return math.sqrt(other), c * bx - s * by + tx - dx, s * bx + c * by + ty - dy, dx, dy


@compiled
def part_witness(
    P: FloatArray,
    p0: int,
    p1: int,
    Q: FloatArray,
    q0: int,
    q1: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    rx: float,
    ry: float,
) -> Witness:
    """`part_gap` with normal and points, all in P's frame (a lies on P, b on Q)."""
    d, outline, of_q, edge, gap = part_feature(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry, np.inf)
    if edge >= 0 and gap >= d - TIE:
        if of_q:
            k = edge - 1 if edge > q0 else q1 - 1
            hit, x, y, nx, ny = face_witness(Q, k, edge, P, p0, p1, c, -s, rx, ry, tx, ty, gap)
            if hit or not outline:
                x -= rx
                y -= ry
                bx = c * x - s * y + tx
                by = s * x + c * y + ty
                ox = -(c * nx - s * ny)
                oy = -(s * nx + c * ny)
                return d, ox, oy, bx - d * ox, by - d * oy, bx, by
        else:
            k = edge - 1 if edge > p0 else p1 - 1
            hit, x, y, nx, ny = face_witness(P, k, edge, Q, q0, q1, c, s, tx, ty, rx, ry, gap)
            if hit or not outline:
                return d, nx, ny, x, y, x + d * nx, y + d * ny
    _, ax, ay, dx, dy = outline_witness(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry)
    size = math.sqrt(dx * dx + dy * dy)
    if size > 0.0:
        return d, dx / size, dy / size, ax, ay, ax + dx, ay + dy
    return d, 1.0, 0.0, ax, ay, ax, ay
