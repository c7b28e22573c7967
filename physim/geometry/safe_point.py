"""Nearest safe point: where a target that lies too near a wall is moved to.

A point is safe when it is at least L from every wall part. The border of the safe area is made of
lines parallel to wall edges at distance L and of circles of radius L about wall corners, so the
safe point nearest to a target is the nearest point of one such curve or a crossing of two. All of
them count: the answer is exact, and it needs only the walls near the target.
"""

from __future__ import annotations

from math import hypot, sqrt
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, IntArray, Part, Shapes
from physim.tolerances import CONTACT

CURVE_MARGIN = 1e-6
"""[m] Far above the rounding of a crossing's distance from its curves."""

SECTION_SAMPLES = 64
"""Samples a side of the cross-section that is searched for its greatest clearance."""


@compiled
def point_segment(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Distance [m] of a point from a segment."""
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    along = 0.0
    if square > 0.0:
        along = min(max(((x - ax) * dx + (y - ay) * dy) / square, 0.0), 1.0)
    return hypot(x - ax - along * dx, y - ay - along * dy)


@compiled
def outline_distance(P: Part, x: float, y: float) -> float:
    """Distance [m] of a point from a part; 0 inside a solid one."""
    V, first, end = P.vertices, P.first, P.end
    if end - first == 2:
        return point_segment(
            x, y, V[first, 0], V[first, 1], V[first + 1, 0], V[first + 1, 1]
        )  # fmt: skip
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
def point_part(walls: Shapes, part: int, x: float, y: float) -> float:
    """Distance [m] of a point from a wall part; 0 inside a solid one."""
    start = walls.part_start
    return outline_distance(Part(walls.vertices, start[part], start[part + 1]), x, y)


@compiled
def point_clearance(walls: Shapes, parts: IntArray, x: float, y: float) -> float:
    """Distance [m] of a point from the nearest of some wall parts; inf when there are none."""
    V, start = walls.vertices, walls.part_start
    best = np.inf
    for part in parts:
        best = min(best, outline_distance(Part(V, start[part], start[part + 1]), x, y))
    return best


@compiled
def _edges(walls: Shapes, parts: IntArray, x: float, y: float, reach: float) -> FloatArray:
    """Edges (E, 4) of the parts that come within ``reach`` of a point."""
    count = 0
    for part in parts:
        count += walls.part_start[part + 1] - walls.part_start[part]
    edges = np.empty((count, 4))
    found = 0
    for part in parts:
        first, end = walls.part_start[part], walls.part_start[part + 1]
        for k in range(first, end):
            m = k + 1 if k + 1 < end else first
            ax, ay = walls.vertices[k, 0], walls.vertices[k, 1]
            bx, by = walls.vertices[m, 0], walls.vertices[m, 1]
            if point_segment(x, y, ax, ay, bx, by) <= reach:
                edges[found, 0], edges[found, 1] = ax, ay
                edges[found, 2], edges[found, 3] = bx, by
                found += 1
            if end - first == 2:
                break
    return edges[:found]


@compiled
def _crosses(edges: FloatArray, px: float, py: float, qx: float, qy: float) -> bool:
    """Whether the straight way from p to q properly crosses an edge."""
    for e in range(len(edges)):
        ax, ay, bx, by = edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3]
        side_a = (qx - px) * (ay - py) - (qy - py) * (ax - px)
        side_b = (qx - px) * (by - py) - (qy - py) * (bx - px)
        side_p = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
        side_q = (bx - ax) * (qy - ay) - (by - ay) * (qx - ax)
        if side_a * side_b <= 0.0 and side_p * side_q < 0.0:
            return True
    return False


@compiled
def _curves(edges: FloatArray, distance: float) -> FloatArray:
    """Lines and circles that border the safe area, (C, 5): kind, then ax, ay, ux, uy or x, y."""
    curves = np.empty((4 * len(edges), 5))
    count = 0
    for e in range(len(edges)):
        ax, ay, bx, by = edges[e, 0], edges[e, 1], edges[e, 2], edges[e, 3]
        length = hypot(bx - ax, by - ay)
        if length > 0.0:
            ux, uy = (bx - ax) / length, (by - ay) / length
            _put_curve(curves[count], 0.0, ax - distance * uy, ay + distance * ux, ux, uy)
            _put_curve(curves[count + 1], 0.0, ax + distance * uy, ay - distance * ux, ux, uy)
            count += 2
        _put_curve(curves[count], 1.0, ax, ay, 0.0, 0.0)
        _put_curve(curves[count + 1], 1.0, bx, by, 0.0, 0.0)
        count += 2
    return curves[:count]


@compiled
def _put_curve(curve: FloatArray, kind: float, x: float, y: float, ux: float, uy: float) -> None:
    curve[0], curve[1], curve[2], curve[3], curve[4] = kind, x, y, ux, uy


@compiled
def _nearest_on(curve: FloatArray, distance: float, x: float, y: float) -> tuple[float, float]:
    """Point of a curve nearest to (x, y)."""
    if curve[0] == 0.0:
        along = (x - curve[1]) * curve[3] + (y - curve[2]) * curve[4]
        return curve[1] + along * curve[3], curve[2] + along * curve[4]
    dx, dy = x - curve[1], y - curve[2]
    gap = hypot(dx, dy)
    if gap == 0.0:
        return curve[1] + distance, curve[2]
    return curve[1] + distance * dx / gap, curve[2] + distance * dy / gap


@compiled
def _crossings(c: FloatArray, d: FloatArray, distance: float, out: FloatArray) -> int:
    """Points in which two curves meet, written to ``out`` (2, 2); returns how many."""
    if c[0] == 0.0 and d[0] == 0.0:
        cross = c[3] * d[4] - c[4] * d[3]
        if abs(cross) < 1e-12:
            return 0
        along = ((d[1] - c[1]) * d[4] - (d[2] - c[2]) * d[3]) / cross
        out[0, 0], out[0, 1] = c[1] + along * c[3], c[2] + along * c[4]
        return 1
    if c[0] == 1.0 and d[0] == 1.0:
        mx, my = (d[1] - c[1]) / 2.0, (d[2] - c[2]) / 2.0
        half = hypot(mx, my)
        if half == 0.0 or half > distance:
            return 0
        height = sqrt(distance * distance - half * half) / half
        out[0, 0], out[0, 1] = c[1] + mx - height * my, c[2] + my + height * mx
        out[1, 0], out[1, 1] = c[1] + mx + height * my, c[2] + my - height * mx
        return 2
    line, circle = (c, d) if c[0] == 0.0 else (d, c)
    along = (circle[1] - line[1]) * line[3] + (circle[2] - line[2]) * line[4]
    fx, fy = line[1] + along * line[3], line[2] + along * line[4]
    gap = hypot(circle[1] - fx, circle[2] - fy)
    if gap > distance:
        return 0
    half = sqrt(distance * distance - gap * gap)
    out[0, 0], out[0, 1] = fx + half * line[3], fy + half * line[4]
    out[1, 0], out[1, 1] = fx - half * line[3], fy - half * line[4]
    return 2


@compiled
def nearest_safe_point(
    walls: Shapes,
    parts: IntArray,
    target: tuple[float, float],
    ahead: tuple[float, float],
    eye: tuple[float, float],
    safe_distance: float,
    reach: float,
    back: float,
) -> tuple[bool, float, float]:
    """Safe point nearest to a target: found or not, x, y.

    Only points within ``reach`` of the target count, at most ``back`` behind it along the unit
    vector ``ahead``, and joined to the point ``eye`` by a straight way that crosses no wall. A
    returned point is at least ``safe_distance - 1e-9`` m from every one of ``parts``.
    """
    tx, ty = target
    edges = _edges(walls, parts, tx, ty, reach + 2.0 * safe_distance)
    between = _edges(walls, parts, tx, ty, max(reach, hypot(eye[0] - tx, eye[1] - ty)))
    place = _Place(walls, parts, between, target, ahead, eye, safe_distance, back)
    curves = _curves(edges, safe_distance)
    curves, limit = _near_curves(curves, place, reach)
    points = np.empty((2, 2))
    best, bx, by = reach, tx, ty
    found = False
    for c in range(len(curves)):
        for d in range(c, len(curves)):
            if c == d:
                points[0, 0], points[0, 1] = _nearest_on(curves[c], safe_distance, tx, ty)
                count = 1
            else:
                count = _crossings(curves[c], curves[d], safe_distance, points)
            for k in range(count):
                x, y = points[k, 0], points[k, 1]
                gap = hypot(x - tx, y - ty)
                if gap < best and gap <= limit and _serves(place, x, y):
                    best, bx, by, found = gap, x, y, True
    return found, bx, by


class _Place(NamedTuple):
    """What decides whether a point may take the place of a target."""

    walls: Shapes
    parts: IntArray
    between: FloatArray
    """edges that may hide a point from the eye"""
    target: tuple[float, float]
    ahead: tuple[float, float]
    eye: tuple[float, float]
    safe_distance: float
    back: float


@compiled
def _serves(place: _Place, x: float, y: float) -> bool:
    """Whether a point is safe, in sight of the eye and not too far behind the target."""
    (tx, ty), (ux, uy) = place.target, place.ahead
    if (x - tx) * ux + (y - ty) * uy < -place.back:
        return False
    if point_clearance(place.walls, place.parts, x, y) < place.safe_distance - CONTACT:
        return False
    return not _crosses(place.between, place.eye[0], place.eye[1], x, y)


@compiled
def _near_curves(curves: FloatArray, place: _Place, reach: float) -> tuple[FloatArray, float]:
    """The curves, in their order, on which the answer may lie, and how far it is at most.

    The nearest points of single curves, nearest first, until one serves: nothing farther from the
    target is the answer. A crossing lies on both its curves, so it is no nearer than either.
    """
    (tx, ty) = place.target
    gaps, tried = np.empty(len(curves)), np.zeros(len(curves), dtype=np.bool_)
    for c in range(len(curves)):
        x, y = _nearest_on(curves[c], place.safe_distance, tx, ty)
        gaps[c] = hypot(x - tx, y - ty)
    limit = np.inf
    while limit == np.inf:
        nearest = -1
        for c in range(len(curves)):
            if not tried[c] and gaps[c] < (reach if nearest < 0 else gaps[nearest]):
                nearest = c
        if nearest < 0:
            break
        tried[nearest] = True
        x, y = _nearest_on(curves[nearest], place.safe_distance, tx, ty)
        if _serves(place, x, y):
            limit = gaps[nearest]
    near = np.empty((len(curves), 5))
    count = 0
    for c in range(len(curves)):
        if gaps[c] <= min(limit, reach) + CURVE_MARGIN:
            for k in range(near.shape[1]):  # to assign a row would take long to compile
                near[count, k] = curves[c, k]
            count += 1
    return near[:count], limit


@compiled
def roomiest_point(
    walls: Shapes,
    parts: IntArray,
    target: tuple[float, float],
    ahead: tuple[float, float],
    eye: tuple[float, float],
    reach: float,
) -> tuple[float, float]:
    """Point of greatest clearance on the cross-section through a target, seen from ``eye``.

    The cross-section is the line square to ``ahead``, ``reach`` to both sides, searched at
    2 x 64 + 1 points and then refined: within reach/64 of the best one for a smooth clearance, and
    at most that much beyond ``reach``. The target itself where none of it is seen.
    """
    away = hypot(eye[0] - target[0], eye[1] - target[1])
    edges = _edges(walls, parts, target[0], target[1], max(reach + reach / SECTION_SAMPLES, away))
    step = reach / SECTION_SAMPLES
    best, offset = -1.0, 0.0
    for k in range(-SECTION_SAMPLES, SECTION_SAMPLES + 1):
        x, y = target[0] - k * step * ahead[1], target[1] + k * step * ahead[0]
        clearance = point_clearance(walls, parts, x, y)
        if clearance > best + CONTACT and not _crosses(edges, eye[0], eye[1], x, y):
            best, offset = clearance, k * step
    while step > CONTACT:
        step /= 2.0
        for side in (-1.0, 1.0):
            shift = offset + side * step
            x, y = target[0] - shift * ahead[1], target[1] + shift * ahead[0]
            clearance = point_clearance(walls, parts, x, y)
            if clearance > best and not _crosses(edges, eye[0], eye[1], x, y):
                best, offset = clearance, shift
                break
    return target[0] - offset * ahead[1], target[1] + offset * ahead[0]
