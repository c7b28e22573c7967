"""How is a contact to act where the engine has its point or normal wrong?

Where an edge lies on one line with another, to 1e-16 m, pymunk takes it for overlap all along the
edge, and pushes the parts apart sideways, or takes a normal askew: boxes that one pushed straight
on with its whole face were 1 m deep in each other, and sprang 19 mm and 3 degrees in a step. Or it
finds a point at one end of the faces alone, where they part by a nanometre at the other, and turns
the boxes about it for a whole step, one in a row of four by 12 mrad. Such a contact is put in the
middle of what the two faces have in common, along their own normal.

A contact that is to be taken along the normal of a segment is put where the part is deepest beyond
that: the engine's points are those of its own normal, and turned to the segment's they would show
an overlap of millimetres where the part is half a metre beyond.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, Rows2, Shapes
from physim.simulation.engine.verdict import ACTS, SIDE, Meeting, classify, onward, touch

MISLED = 1e-3
"""[m] The engine takes parts to be this much deeper in each other than they are: what it eases is
of that order (`space.SLOP`), what it is misled by are lengths of edges"""
SKINS = 1e-6
"""[m] Up to here parts are in each other by little more than their skins (`space.RADIUS`)"""
ASKEW = 1e-6
"""[rad] of the engine's normal to that of the parts, about"""
FACE = 1e-6
"""[m] Corners of a part that lie this near to the farthest one belong to the same face"""


class Spot(NamedTuple):
    """Where two parts meet: a point [m] of p and one of q, world frame."""

    px: float
    py: float
    qx: float
    qy: float


class Ruling(NamedTuple):
    """What is to become of a contact."""

    verdict: int
    is_put: bool
    """whether the engine is to take this normal and spot in place of its own"""
    nx: float
    ny: float
    """unit normal from q to p"""
    spot: Spot


@compiled
def ruling(m: Meeting, points: int, spot: Spot) -> Ruling:
    """Judge a contact that the engine reports at some ``points``, the first of them at a spot."""
    verdict, nx, ny = classify(m)
    if verdict == SIDE:
        is_beyond, deepest = deepest_point(m, nx, ny)
        return Ruling(verdict, True, nx, ny, deepest if is_beyond else spot)
    if verdict == ACTS and is_misled(m, points, spot):
        _, nx, ny = touch(m)
        along, _, height_p, height_q = in_common(m, nx, ny)
        px, py = -along * ny - height_p * nx, along * nx - height_p * ny
        qx, qy = -along * ny + height_q * nx, along * nx + height_q * ny
        return Ruling(verdict, True, nx, ny, Spot(px, py, qx, qy))
    return Ruling(verdict, False, nx, ny, spot)


@compiled
def is_misled(m: Meeting, points: int, spot: Spot) -> bool:
    """Whether the engine is wrong about parts that touch."""
    dx, dy = spot.qx - spot.px, spot.qy - spot.py
    reported = np.hypot(dx, dy)
    if SKINS < reported <= MISLED:
        return False
    distance, nx, ny = touch(m)
    if reported > MISLED:
        return bool(reported > MISLED - distance)
    if distance <= -SKINS:
        return False
    if abs(dx * ny - dy * nx) > ASKEW * reported:
        return True
    return points == 1 and in_common(m, nx, ny)[1] > 0.0


@compiled
def in_common(m: Meeting, nx: float, ny: float) -> tuple[float, float, float, float]:
    """Middle and length [m] of what the faces of two parts have in common, along the tangent of
    q's (left of the normal); and how far each lies along its own normal."""
    low_p, high_p, height_p = face(m.shapes, m.p, m.pose_p, -nx, -ny)
    low_q, high_q, height_q = face(m.shapes, m.q, m.pose_q, nx, ny)
    first, last = max(-high_p, low_q), min(-low_p, high_q)  # p's tangent goes against q's
    return 0.5 * (first + last), last - first, height_p, height_q


@compiled
def face(
    shapes: Shapes, part: int, pose: FloatArray, nx: float, ny: float
) -> tuple[float, float, float]:
    """Ends of the face of a part that lies farthest in a direction, along its tangent (left of
    it), and how far it lies [m]; of a corner both ends are the corner."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    first, count = shapes.part_start[part], shapes.part_start[part + 1] - shapes.part_start[part]
    ahead, left, height = np.empty(count), np.empty(count), -np.inf
    for k in range(count):
        vx, vy = shapes.vertices[first + k, 0], shapes.vertices[first + k, 1]
        x, y = pose[0] + c * vx - s * vy, pose[1] + s * vx + c * vy
        ahead[k], left[k] = nx * x + ny * y, nx * y - ny * x
        height = max(height, ahead[k])
    low, high = np.inf, -np.inf
    for k in range(count):
        if ahead[k] >= height - FACE:
            low, high = min(low, left[k]), max(high, left[k])
    return low, high, height


@compiled
def deepest_point(m: Meeting, nx: float, ny: float) -> tuple[bool, Spot]:
    """Whether some of part p is beyond segment q; the farthest point of it there, and its foot.

    The unit normal (nx, ny) leads from the segment to the side on which the part belongs, and the
    foot is on the segment's line. The part is cut off at the ends of the segment, beyond which
    other walls may stand otherwise; but not at an end where the next segment bends to the part's
    side: what is beyond one line there is beyond the corner. The nearest point where none is
    beyond.
    """
    v, k = m.shapes.vertices, m.shapes.part_start[m.q]
    length = np.hypot(v[k + 1, 0] - v[k, 0], v[k + 1, 1] - v[k, 1])
    ex, ey = (v[k + 1, 0] - v[k, 0]) / length, (v[k + 1, 1] - v[k, 1]) / length
    c, s = np.cos(m.pose_p[2]), np.sin(m.pose_p[2])
    first = m.shapes.part_start[m.p]
    count = m.shapes.part_start[m.p + 1] - first
    part, rest = np.empty((count + 4, 2)), np.empty((count + 4, 2))
    for j in range(count):
        px, py = v[first + j, 0], v[first + j, 1]
        x = m.pose_p[0] - v[k, 0] + c * px - s * py
        y = m.pose_p[1] - v[k, 1] + s * px + c * py
        part[j, 0], part[j, 1] = ex * x + ey * y, nx * x + ny * y
    for end in range(2):
        if m.links.part[m.q, end] >= 0:
            ox, oy = onward(m, end)
            if nx * ox + ny * oy > 0.0:
                continue
        count = cut_off(part, count, 0.0 if end == 0 else length, 1.0 - 2.0 * end, rest)
        part, rest = rest, part
    if count == 0:
        return False, Spot(0.0, 0.0, 0.0, 0.0)
    at = 0
    for j in range(1, count):
        if part[j, 1] < part[at, 1]:
            at = j
    fx, fy = v[k, 0] + part[at, 0] * ex, v[k, 1] + part[at, 0] * ey
    return True, Spot(fx + part[at, 1] * nx, fy + part[at, 1] * ny, fx, fy)


@compiled
def cut_off(part: Rows2, count: int, at: float, sign: float, out: Rows2) -> int:
    """Write a polygon, the first ``count`` rows, without what lies where sign * x < sign * at.

    Returns how many rows of ``out`` that takes.
    """
    kept = 0
    for k in range(count):
        before = k - 1 if k > 0 else count - 1
        inside = sign * (part[k, 0] - at) >= 0.0
        if inside != (sign * (part[before, 0] - at) >= 0.0):
            share = (at - part[before, 0]) / (part[k, 0] - part[before, 0])
            out[kept, 0] = at
            out[kept, 1] = part[before, 1] + share * (part[k, 1] - part[before, 1])
            kept += 1
        if inside:
            out[kept, 0], out[kept, 1] = part[k, 0], part[k, 1]
            kept += 1
    return kept
