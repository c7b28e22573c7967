"""Two convex parts: signed distance, by separating axes inside and vertex to edge outside, and
where they are closest or deepest.

A part's vertices run counter-clockwise; two vertices are a segment (its two normals are the normals
of going there and back), one vertex is a point. An edge is named by the index of its last vertex.

Why it is exact: where the parts overlap, the depth is the smallest overlap over the normals of
both (the faces of their Minkowski difference). Where they are apart, either the closest pair is a
vertex and the inside of an edge, and then the normal of this edge has the largest gap of all,
which is the distance; or it is a pair of vertices. Error: a few ulp of the size of the parts.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import Part
from physim.tolerances import TIE

NEARLY_TOUCHING = 1e-6
"""[m] Overlaps below this are looked at twice: the normals of two collinear segments, or of
slivers, all but miss the axis along which such parts are apart."""

OUTLINE_ROUNDING = 1e-12
"""[m] By so much the vertices must be farther apart than the overlap is deep to overrule it."""
ROUNDINGS = 16.0 * 2.0**-52
"""[-] Share of their coordinates by which they must be, where that is more: beyond 280 m."""


class Frame(NamedTuple):
    """Part Q as part P sees it: its point q is at ``R (q - r) + t``, R being the rotation (c, s).

    That form is the same from the other side (`seen_back`), and loses nothing far from the origin.
    """

    c: float
    s: float
    tx: float
    ty: float
    rx: float
    ry: float


@compiled
def frame_at(c: float, s: float, x: float, y: float) -> Frame:
    """Frame whose origin is at (x, y) [m], turned by (c, s)."""
    return Frame(c, s, x, y, 0.0, 0.0)


@compiled
def seen_back(f: Frame) -> Frame:
    """P as Q sees it."""
    return Frame(f.c, -f.s, f.rx, f.ry, f.tx, f.ty)


@compiled
def before(P: Part, m: int) -> int:
    """Vertex before m: the first of the edge that ends at m."""
    return m - 1 if m > P.first else P.end - 1


@compiled
def edge_normal(P: Part, k: int, m: int) -> tuple[float, float, float]:
    """Return (nx, ny, length [m]): outward unit normal of the edge from vertex k to m, or zeros."""
    ex = P.vertices[m, 0] - P.vertices[k, 0]
    ey = P.vertices[m, 1] - P.vertices[k, 1]
    length = math.sqrt(ex * ex + ey * ey)
    if length > 0.0:
        return ey / length, -ex / length, length
    return 0.0, 0.0, 0.0


class FaceGap(NamedTuple):
    """Largest gap over the edge normals of a part."""

    gap: float
    edge: int
    """-1 where there is none"""
    vertex: int
    """of the other part, nearest to it"""


@compiled
def face_gap(P: Part, Q: Part, f: Frame, enough: float) -> FaceGap:
    """Largest gap over the edge normals of P; a lower bound once it is ``enough``."""
    V, W = P.vertices, Q.vertices
    best, edge, vertex = -np.inf, -1, -1
    k = P.end - 1
    for m in range(P.first, P.end):
        nx, ny, length = edge_normal(P, k, m)
        if length > 0.0:
            ux = f.c * nx + f.s * ny
            uy = f.c * ny - f.s * nx
            height = nx * (f.tx - V[k, 0]) + ny * (f.ty - V[k, 1])
            low = ux * (W[Q.first, 0] - f.rx) + uy * (W[Q.first, 1] - f.ry)
            at = Q.first
            if not low + height > best:
                k = m
                continue  # the others can only be lower
            for j in range(Q.first + 1, Q.end):
                h = ux * (W[j, 0] - f.rx) + uy * (W[j, 1] - f.ry)
                if h < low:
                    low = h
                    at = j
            gap = low + height
            if gap > best:
                best, edge, vertex = gap, m, at
                if best >= enough:
                    break
        k = m
    return FaceGap(best, edge, vertex)


class VertexGap(NamedTuple):
    """Where a vertex of one part is closest to the outline of another."""

    square: float
    """[m^2] of the distance"""
    edge: int
    vertex: int
    share: float
    """place on the edge in 0..1"""


@compiled
def vertex_gap(P: Part, Q: Part, f: Frame) -> VertexGap:
    """Vertex of Q closest to the outline of P."""
    V, W = P.vertices, Q.vertices
    best, edge, vertex, place = np.inf, -1, -1, 0.0
    for j in range(Q.first, Q.end):
        qx = W[j, 0] - f.rx
        qy = W[j, 1] - f.ry
        # The vertex relative to P[k], so that nothing is lost far from the origin.
        ox = f.c * qx - f.s * qy
        oy = f.s * qx + f.c * qy
        k = P.end - 1
        for m in range(P.first, P.end):
            dx = ox + (f.tx - V[k, 0])
            dy = oy + (f.ty - V[k, 1])
            ex = V[m, 0] - V[k, 0]
            ey = V[m, 1] - V[k, 1]
            square = dx * dx + dy * dy
            along = ex * dx + ey * dy
            size = ex * ex + ey * ey
            share = 0.0
            if 0.0 < along < size:
                cross = ex * dy - ey * dx
                square = cross * cross / size
                share = along / size
            if square < best:
                best, edge, vertex, place = square, m, j, share
            k = m
    return VertexGap(best, edge, vertex, place)


@compiled
def from_vertex(P: Part, k: int, Q: Part, j: int, f: Frame) -> tuple[float, float]:
    """Return (dx, dy) [m] from vertex k of P to vertex j of Q, in P's frame."""
    qx = Q.vertices[j, 0] - f.rx
    qy = Q.vertices[j, 1] - f.ry
    dx = f.c * qx - f.s * qy + (f.tx - P.vertices[k, 0])
    return dx, f.s * qx + f.c * qy + (f.ty - P.vertices[k, 1])


@compiled
def is_over_edge(P: Part, m: int, Q: Part, j: int, f: Frame) -> bool:
    """Whether the foot of vertex j of Q lies on edge m of P, not beside it."""
    k = before(P, m)
    dx, dy = from_vertex(P, k, Q, j, f)
    ex = P.vertices[m, 0] - P.vertices[k, 0]
    ey = P.vertices[m, 1] - P.vertices[k, 1]
    along = ex * dx + ey * dy
    return bool(0.0 <= along <= ex * ex + ey * ey)


class Faces(NamedTuple):
    """Largest gap over the normals of two parts."""

    gap: float
    of_q: bool
    """whether the normal is one of Q's"""
    edge: int
    """-1 where there is none"""
    settled: bool
    """whether that is the distance; else that between the outlines decides, see `by_outline`"""


@compiled
def part_faces(P: Part, Q: Part, f: Frame, enough: float) -> Faces:
    """Largest gap over the normals of both parts; a lower bound once it is ``enough``."""
    one = face_gap(P, Q, f, enough)
    if one.gap >= enough:
        return Faces(one.gap, False, one.edge, True)
    back = seen_back(f)
    two = face_gap(Q, P, back, enough)
    if two.gap >= enough:
        return Faces(two.gap, True, two.edge, True)
    if two.gap > one.gap:
        if two.gap > 0.0 and is_over_edge(Q, two.edge, P, two.vertex, back):
            return Faces(two.gap, True, two.edge, True)
        deep = not (two.gap > -NEARLY_TOUCHING)
        return Faces(two.gap, True, two.edge, deep)
    if one.gap > 0.0 and is_over_edge(P, one.edge, Q, one.vertex, f):
        return Faces(one.gap, False, one.edge, True)
    deep = not (one.gap > -NEARLY_TOUCHING or one.gap == -np.inf)
    return Faces(one.gap, False, one.edge, deep)


@compiled
def by_outline(gap: float, distance: float, f: Frame) -> tuple[float, bool]:
    """Return `part_gap`, from the largest gap and the distance of the outlines; is it the latter?

    For parts that `part_faces` left open.
    """
    if gap > 0.0:
        # Never below the gap by rounding, so that `enough` cannot change a minimum over parts.
        return max(gap, distance), True
    away = abs(f.tx) + abs(f.ty) + abs(f.rx) + abs(f.ry)
    if gap == -np.inf or distance > max(OUTLINE_ROUNDING, ROUNDINGS * away) - gap:
        return distance, True
    return gap, False


@compiled
def part_gap(P: Part, Q: Part, f: Frame, enough: float) -> float:
    """Signed distance [m] of parts P and Q, negative = depth.

    Where it is below ``enough`` it is exact; otherwise some number from ``enough`` up to it.
    """
    faces = part_faces(P, Q, f, enough)
    if faces.settled:
        return faces.gap
    a, b = vertex_gap(P, Q, f).square, vertex_gap(Q, P, seen_back(f)).square
    return by_outline(faces.gap, math.sqrt(min(a, b)), f)[0]


@compiled
def support_gap(P: Part, Q: Part, f: Frame, nx: float, ny: float) -> float:
    """Return the gap of P and Q along a unit direction of P's frame, from P to Q."""
    V, W = P.vertices, Q.vertices
    x = V[P.first, 0]
    y = V[P.first, 1]
    top = -np.inf
    for k in range(P.first, P.end):
        top = max(top, nx * (V[k, 0] - x) + ny * (V[k, 1] - y))
    ux = f.c * nx + f.s * ny
    uy = f.c * ny - f.s * nx
    low = np.inf
    for k in range(Q.first, Q.end):
        low = min(low, ux * (W[k, 0] - f.rx) + uy * (W[k, 1] - f.ry))
    gap: float = low + (nx * (f.tx - x) + ny * (f.ty - y)) - top
    return gap


class Witness(NamedTuple):
    """Signed distance [m] with a unit normal from a to b, and a point [m] on each."""

    distance: float
    nx: float
    ny: float
    ax: float
    ay: float
    bx: float
    by: float


@compiled
def face_witness(
    P: Part, m: int, Q: Part, f: Frame, gap: float
) -> tuple[bool, float, float, float, float]:
    """Return (on the edge?, x, y, nx, ny): the middle of what faces edge m of P, and its normal.

    The vertices of Q nearest to the edge's line (two where a side is parallel) cast a shadow on
    it; the middle of what falls on the edge is the point. If nothing does, the nearest end.
    """
    V, k = P.vertices, before(P, m)
    nx, ny, length = edge_normal(P, k, m)
    ex, ey = -ny, nx
    low, high = np.inf, -np.inf
    for j in range(Q.first, Q.end):
        dx, dy = from_vertex(P, k, Q, j, f)
        if ey * dx - ex * dy <= gap + TIE:
            along = ex * dx + ey * dy
            low = min(low, along)
            high = max(high, along)
    hit: bool = low <= length and high >= 0.0
    middle = 0.5 * (min(max(low, 0.0), length) + max(min(high, length), 0.0))
    return hit, V[k, 0] + middle * ex, V[k, 1] + middle * ey, nx, ny


@compiled
def vertex_witness(P: Part, Q: Part, f: Frame) -> tuple[float, float, float, float, float]:
    """Return (squared distance, px, py, dx, dy): closest vertex of Q is at p + d, p on P."""
    V, at = P.vertices, vertex_gap(P, Q, f)
    k = before(P, at.edge)
    ex = at.share * (V[at.edge, 0] - V[k, 0])
    ey = at.share * (V[at.edge, 1] - V[k, 1])
    dx, dy = from_vertex(P, k, Q, at.vertex, f)
    return at.square, V[k, 0] + ex, V[k, 1] + ey, dx - ex, dy - ey


@compiled
def outline_witness(P: Part, Q: Part, f: Frame) -> tuple[float, float, float, float, float]:
    """Return (distance, ax, ay, dx, dy) in P's frame: closest point a on P, and b = a + d on Q."""
    square, ax, ay, dx, dy = vertex_witness(P, Q, f)
    other, bx, by, ox, oy = vertex_witness(Q, P, seen_back(f))
    if square <= other:
        return math.sqrt(square), ax, ay, dx, dy
    bx -= f.rx
    by -= f.ry
    # o leads from b to a in Q's frame.
    dx = -(f.c * ox - f.s * oy)
    dy = -(f.s * ox + f.c * oy)
    ax = f.c * bx - f.s * by + f.tx - dx
    return math.sqrt(other), ax, f.s * bx + f.c * by + f.ty - dy, dx, dy


@compiled
def part_witness(P: Part, Q: Part, f: Frame) -> Witness:
    """`part_gap` with normal and points, all in P's frame (a lies on P, b on Q)."""
    faces = part_faces(P, Q, f, np.inf)
    d, outline = faces.gap, False
    distance, ax, ay, dx, dy = 0.0, 0.0, 0.0, 0.0, 0.0
    if not faces.settled:
        distance, ax, ay, dx, dy = outline_witness(P, Q, f)
        d, outline = by_outline(faces.gap, distance, f)
    if faces.edge >= 0 and faces.gap >= d - TIE:
        if faces.of_q:
            hit, x, y, nx, ny = face_witness(Q, faces.edge, P, seen_back(f), faces.gap)
            if hit or not outline:
                x -= f.rx
                y -= f.ry
                bx = f.c * x - f.s * y + f.tx
                by = f.s * x + f.c * y + f.ty
                ox = -(f.c * nx - f.s * ny)
                oy = -(f.s * nx + f.c * ny)
                return Witness(d, ox, oy, bx - d * ox, by - d * oy, bx, by)
        else:
            hit, x, y, nx, ny = face_witness(P, faces.edge, Q, f, faces.gap)
            if hit or not outline:
                return Witness(d, nx, ny, x, y, x + d * nx, y + d * ny)
    size = math.sqrt(dx * dx + dy * dy)
    if size > 0.0:
        return Witness(d, dx / size, dy / size, ax, ay, ax + dx, ay + dy)
    return Witness(d, 1.0, 0.0, ax, ay, ax, ay)
