"""Signed distance of two convex parts: separating axes inside, vertex to edge outside.

A part is a run ``P[p0:p1]`` of vertices, counter-clockwise; two vertices are a segment (its two
normals are the normals of going there and back), one vertex is a point. Part Q lies in a frame of
its own, and its point q is at ``R (q - r) + t`` in the frame of P, with R the rotation (c, s).
That form is the same seen from the other side (swap P with Q and r with t, and negate s), loses
nothing far from the origin, and needs no scratch memory.

Why it is exact: where the parts overlap, the depth is the smallest overlap over the normals of
both (the faces of their Minkowski difference). Where they are apart, either the closest pair is a
vertex and the inside of an edge, and then the normal of this edge has the largest gap of all,
which is the distance; or it is a pair of vertices. Error: a few ulp of the size of the parts.
"""

from __future__ import annotations

import math

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray

NEARLY_TOUCHING = 1e-6
"""[m] Overlaps below this are looked at twice: the normals of two collinear segments, or of
slivers, all but miss the axis along which such parts are apart."""

ROUNDING = 1e-12
"""[m] By so much the vertices must be farther apart than the overlap is deep to overrule it."""

Frame = tuple[float, float, float, float]


@compiled
def face_gap(
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
    enough: float,
) -> tuple[float, int, int]:
    """Return the largest gap over the edge normals of P, its edge, and the vertex of Q nearest.

    An edge is named by the index of its last vertex; -1 where there is none. The search ends
    early, with a lower bound, once the gap is ``enough``.
    """
    best = -np.inf
    edge = -1
    vertex = -1
    k = p1 - 1
    for m in range(p0, p1):
        ex = P[m, 0] - P[k, 0]
        ey = P[m, 1] - P[k, 1]
        length = math.sqrt(ex * ex + ey * ey)
        if length > 0.0:
            nx = ey / length
            ny = -ex / length
            ux = c * nx + s * ny
            uy = c * ny - s * nx
            low = np.inf
            at = q0
            for j in range(q0, q1):
                h = ux * (Q[j, 0] - rx) + uy * (Q[j, 1] - ry)
                if h < low:
                    low = h
                    at = j
            gap = low + (nx * (tx - P[k, 0]) + ny * (ty - P[k, 1]))
            if gap > best:
                best = gap
                edge = m
                vertex = at
                if best >= enough:
                    return best, edge, vertex
        k = m
    return best, edge, vertex


@compiled
def vertex_gap(
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
) -> tuple[float, int, int, float]:
    """Return the smallest squared distance of a vertex of Q from the outline of P, and where.

    That is (squared distance, edge by its last vertex, vertex of Q, place on the edge in 0..1).
    """
    best = np.inf
    edge = -1
    vertex = -1
    place = 0.0
    for j in range(q0, q1):
        qx = Q[j, 0] - rx
        qy = Q[j, 1] - ry
        # The vertex relative to P[k], so that nothing is lost far from the origin.
        ox = c * qx - s * qy
        oy = s * qx + c * qy
        k = p1 - 1
        for m in range(p0, p1):
            dx = ox + (tx - P[k, 0])
            dy = oy + (ty - P[k, 1])
            ex = P[m, 0] - P[k, 0]
            ey = P[m, 1] - P[k, 1]
            square = dx * dx + dy * dy
            along = ex * dx + ey * dy
            size = ex * ex + ey * ey
            share = 0.0
            if 0.0 < along < size:
                cross = ex * dy - ey * dx
                square = cross * cross / size
                share = along / size
            if square < best:
                best = square
                edge = m
                vertex = j
                place = share
            k = m
    return best, edge, vertex, place


@compiled
def over_edge(
    P: FloatArray,
    k: int,
    m: int,
    Q: FloatArray,
    j: int,
    c: float,
    s: float,
    tx: float,
    ty: float,
    rx: float,
    ry: float,
) -> bool:
    """Whether the foot of vertex j of Q lies on the edge from k to m of P, not beside it."""
    qx = Q[j, 0] - rx
    qy = Q[j, 1] - ry
    dx = c * qx - s * qy + (tx - P[k, 0])
    dy = s * qx + c * qy + (ty - P[k, 1])
    ex = P[m, 0] - P[k, 0]
    ey = P[m, 1] - P[k, 1]
    along = ex * dx + ey * dy
    return bool(0.0 <= along <= ex * ex + ey * ey)


@compiled
def outline_distance(
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
) -> float:
    """Smallest distance of a vertex of one part from the outline of the other."""
    a = vertex_gap(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry)[0]
    b = vertex_gap(Q, q0, q1, P, p0, p1, c, -s, rx, ry, tx, ty)[0]
    return math.sqrt(min(a, b))


@compiled
def part_gap(
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
    enough: float,
) -> float:
    """Signed distance [m] of parts P and Q (frames: see the module), negative = depth.

    Where it is below ``enough`` it is exact; otherwise some number from ``enough`` up to it.
    """
    gap, m, j = face_gap(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry, enough)
    if gap >= enough:
        return gap
    other, n, i = face_gap(Q, q0, q1, P, p0, p1, c, -s, rx, ry, tx, ty, enough)
    if other >= enough:
        return other
    if gap >= other:
        if gap > 0.0 and over_edge(P, m - 1 if m > p0 else p1 - 1, m, Q, j, c, s, tx, ty, rx, ry):
            return gap
    else:
        gap = other
        if gap > 0.0 and over_edge(Q, n - 1 if n > q0 else q1 - 1, n, P, i, c, -s, rx, ry, tx, ty):
            return gap
    if gap > 0.0:
        # Never below the gap by rounding: so `enough` cannot change a minimum over parts.
        return max(gap, outline_distance(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry))
    if gap > -NEARLY_TOUCHING or gap == -np.inf:
        distance = outline_distance(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry)
        if gap == -np.inf or distance > ROUNDING - gap:
            return distance
    return gap
