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

OUTLINE_ROUNDING = 1e-12
"""[m] By so much the vertices must be farther apart than the overlap is deep to overrule it."""
ROUNDINGS = 16.0 * 2.0**-52
"""[-] Share of their coordinates by which they must be, where that is more: beyond 280 m."""

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
            height = nx * (tx - P[k, 0]) + ny * (ty - P[k, 1])
            low = ux * (Q[q0, 0] - rx) + uy * (Q[q0, 1] - ry)
            at = q0
            if not low + height > best:
                k = m
                continue  # the others can only be lower
            for j in range(q0 + 1, q1):
                h = ux * (Q[j, 0] - rx) + uy * (Q[j, 1] - ry)
                if h < low:
                    low = h
                    at = j
            gap = low + height
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
def part_faces(
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
) -> tuple[float, bool, int, bool]:
    """Return the largest gap over the normals of both, and what it rests on.

    That is (gap, is the normal one of Q's?, its edge, is this `part_gap`?). Where it is not, the
    distance between the outlines decides, see `by_outline`.
    """
    gap, edge, vertex = face_gap(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry, enough)
    if gap >= enough:
        return gap, False, edge, True
    other, n, i = face_gap(Q, q0, q1, P, p0, p1, c, -s, rx, ry, tx, ty, enough)
    if other >= enough:
        return other, True, n, True
    of_q = other > gap
    if of_q:
        gap = other
        edge = n
        k = n - 1 if n > q0 else q1 - 1
        if gap > 0.0 and over_edge(Q, k, n, P, i, c, -s, rx, ry, tx, ty):
            return gap, of_q, edge, True
    elif gap > 0.0:
        k = edge - 1 if edge > p0 else p1 - 1
        if over_edge(P, k, edge, Q, vertex, c, s, tx, ty, rx, ry):
            return gap, of_q, edge, True
    return gap, of_q, edge, not (gap > -NEARLY_TOUCHING or gap == -np.inf)


@compiled
def by_outline(gap: float, distance: float, away: float) -> tuple[float, bool]:
    """Return `part_gap`, from the largest gap and the distance of the outlines; is it the latter?

    For parts that `part_faces` left open, and that lie ``away`` [m] from an origin of theirs.
    """
    if gap > 0.0:
        # Never below the gap by rounding, so that `enough` cannot change a minimum over parts.
        return max(gap, distance), True
    if gap == -np.inf or distance > max(OUTLINE_ROUNDING, ROUNDINGS * away) - gap:
        return distance, True
    return gap, False


@compiled
def part_feature(
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
) -> tuple[float, bool, bool, int, float]:
    """Return `part_gap`, and what it rests on.

    That is (signed distance, is it between outlines rather than along a normal?, is the best
    normal one of Q's?, the edge of the best normal, the gap along it).
    """
    gap, of_q, edge, settled = part_faces(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry, enough)
    if settled:
        return gap, False, of_q, edge, gap
    distance = outline_distance(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry)
    d, outline = by_outline(gap, distance, abs(tx) + abs(ty) + abs(rx) + abs(ry))
    return d, outline, of_q, edge, gap


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
    return part_feature(P, p0, p1, Q, q0, q1, c, s, tx, ty, rx, ry, enough)[0]


@compiled
def support_gap(
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
    nx: float,
    ny: float,
) -> float:
    """Return the gap of P and Q along a unit direction of P's frame, from P to Q."""
    x = P[p0, 0]
    y = P[p0, 1]
    top = -np.inf
    for k in range(p0, p1):
        top = max(top, nx * (P[k, 0] - x) + ny * (P[k, 1] - y))
    ux = c * nx + s * ny
    uy = c * ny - s * nx
    low = np.inf
    for k in range(q0, q1):
        low = min(low, ux * (Q[k, 0] - rx) + uy * (Q[k, 1] - ry))
    gap: float = low + (nx * (tx - x) + ny * (ty - y)) - top
    return gap
