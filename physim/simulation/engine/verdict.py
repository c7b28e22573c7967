"""Is a contact that the engine reports true, and how is this pair of parts to act on it?

A robot that slides along a wall of several segments meets the end of the next one, and that end
would hold it although the wall goes straight on. The engine's own remedy, naming to segments their
neighbours, also loses true contacts (a nose in a corner touches neither wall, by its rule). So that
remedy is not used, and the rule is here: a contact at the end of a segment that pushes the robot
towards the segment's neighbour is left to the neighbour, unless that leans back on the segment:
then both push along their own normals. (A neighbour that leans on the one after it does not.)
There is no way out past the end, either, where the robot would then be in the neighbour, as a sharp
tip that is beyond a straight wall next to a joint: there, too, the segment pushes along its own
normal.

In a corner that closes round the robot each segment holds it along its own normal, whatever the
way out that is the shortest from the segment alone: left to the neighbour, or pushed past the
segment's end into the neighbour, the robot would get through the wall.

Segments here are those of solids (`physim.world.ground.solids`), of which walls that join are one.

How far a part is beyond a segment, measured along the segment's own normal.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.bodies import relative_frame
from physim.geometry.convex import part_gap, part_witness
from physim.geometry.shapes import FloatArray, IntArray, Part, Shapes
from physim.tolerances import CONTACT

APART = 0
"""the parts are apart: a false contact"""
ACTS = 1
"""a true contact"""
LEFT = 2
"""a true contact that is left to the neighbouring segment"""
SIDE = 3
"""a true contact of a segment, to be taken along the segment's own normal"""

SIDE_ANGLE = 1e-6
"""[rad] A normal within this of a segment's own is a contact with its side, not with an end."""


class Links(NamedTuple):
    """What meets each part at its first and second end; only segments have ends."""

    part: IntArray
    """(P, 2) the segment that goes on there, the straightest of several; or -1"""
    end: IntArray
    """(P, 2) which end of that segment"""


def segment_links(shapes: Shapes) -> Links:
    """Find which segments meet: where an end of one is exactly an end of the other."""
    count = len(shapes.part_start) - 1
    links = Links(
        np.full((count, 2), -1, dtype=np.int64),
        np.zeros((count, 2), dtype=np.int64),
    )
    segments = np.flatnonzero(np.diff(shapes.part_start) == 2).tolist()
    meeting: dict[tuple[float, float], list[tuple[int, int]]] = {}
    for p in segments:
        for end in (0, 1):
            x, y = shapes.vertices[shapes.part_start[p] + end].tolist()
            meeting.setdefault((x, y), []).append((p, end))
    for some in meeting.values():
        for p, end in some:
            others = [one for one in some if one[0] != p]
            if others:
                onto = -_leaving(shapes, p, end)
                ahead = [float(_leaving(shapes, *one) @ onto) for one in others]
                links.part[p, end], links.end[p, end] = others[int(np.argmax(ahead))]
    return links


def _leaving(shapes: Shapes, segment: int, end: int) -> FloatArray:
    """Unit vector (2,) along a segment, away from one of its ends."""
    v, k = shapes.vertices, shapes.part_start[segment]
    way = v[k + 1 - end] - v[k + end]
    return np.asarray(way / np.hypot(*way))


@compiled
def touch(
    shapes: Shapes, p: int, pose_p: FloatArray, q: int, pose_q: FloatArray
) -> tuple[float, float, float]:
    """Signed distance [m] of parts p and q at the poses (3,) of their bodies, and its normal.

    The distance is that of `body_distance` to the last bit; the unit normal (world frame) leads
    from q to p.
    """
    v, start = shapes.vertices, shapes.part_start
    P, Q = Part(v, start[p], start[p + 1]), Part(v, start[q], start[q + 1])
    found = part_witness(P, Q, relative_frame(pose_p, pose_q))
    cp, sp = np.cos(pose_p[2]), np.sin(pose_p[2])
    return found[0], -(cp * found[1] - sp * found[2]), -(sp * found[1] + cp * found[2])


@compiled
def leans_on(shapes: Shapes, links: Links, segment: int, nx: float, ny: float) -> tuple[int, int]:
    """Neighbour towards which a push (nx, ny) from a segment (world frame) leads, and at which end.

    (-1, 0) where it leads to none. The push comes from the end that lies farthest along it. It
    leads on to the neighbour if that lies still farther along.
    """
    v, k = shapes.vertices, shapes.part_start[segment]
    ex, ey = v[k + 1, 0] - v[k, 0], v[k + 1, 1] - v[k, 1]
    along = nx * ex + ny * ey
    if abs(along) <= SIDE_ANGLE * np.hypot(ex, ey):
        return -1, 0
    end = 1 if along > 0.0 else 0
    if links.part[segment, end] < 0:
        return -1, 0
    ox, oy = onward(shapes, links, segment, end)
    return (links.part[segment, end], end) if nx * ox + ny * oy > 0.0 else (-1, 0)


@compiled
def onward(shapes: Shapes, links: Links, segment: int, end: int) -> tuple[float, float]:
    """Vector [m] along a segment's neighbour, from where the two meet to its far end."""
    v, k = shapes.vertices, shapes.part_start[segment] + end
    far = shapes.part_start[links.part[segment, end]] + 1 - links.end[segment, end]
    return v[far, 0] - v[k, 0], v[far, 1] - v[k, 1]


@compiled
def side(shapes: Shapes, segment: int, p: int, pose_p: FloatArray) -> tuple[float, float]:
    """Unit normal of a segment (world frame) towards the side where the middle of part p is."""
    v, k = shapes.vertices, shapes.part_start[segment]
    ex, ey = v[k + 1, 0] - v[k, 0], v[k + 1, 1] - v[k, 1]
    first, last = shapes.part_start[p], shapes.part_start[p + 1]
    x, y = 0.0, 0.0
    for m in range(first, last):
        x += v[m, 0] / (last - first)
        y += v[m, 1] / (last - first)
    c, s = np.cos(pose_p[2]), np.sin(pose_p[2])
    dx = pose_p[0] + c * x - s * y - v[k, 0]
    dy = pose_p[1] + s * x + c * y - v[k, 1]
    size = np.copysign(np.hypot(ex, ey), ex * dy - ey * dx)
    return -ey / size, ex / size


@compiled
def _leads(shapes: Shapes, segment: int, end: int, nx: float, ny: float) -> bool:
    """Whether a segment leads from one of its ends to the side to which (nx, ny) points."""
    v, k = shapes.vertices, shapes.part_start[segment]
    ex, ey = v[k + 1 - end, 0] - v[k + end, 0], v[k + 1 - end, 1] - v[k + end, 1]
    return bool(nx * ex + ny * ey > SIDE_ANGLE * np.hypot(ex, ey))


@compiled
def classify(
    shapes: Shapes, links: Links, p: int, pose_p: FloatArray, q: int, pose_q: FloatArray
) -> tuple[int, float, float]:
    """Classify the contact of parts p < q (robots first) at the poses (3,) of their bodies.

    Returns APART, ACTS, LEFT or SIDE and, for SIDE, the unit normal to take from q to p.
    """
    v, start = shapes.vertices, shapes.part_start
    if start[q + 1] - start[q] != 2:
        P, Q = Part(v, start[p], start[p + 1]), Part(v, start[q], start[q + 1])
        distance = part_gap(P, Q, relative_frame(pose_p, pose_q), np.inf)
        return (APART if distance > CONTACT else ACTS), 0.0, 0.0
    distance, nx, ny = touch(shapes, p, pose_p, q, pose_q)
    if distance > CONTACT:
        return APART, nx, ny
    other, end = leans_on(shapes, links, q, nx, ny)
    if other < 0:
        return ACTS, nx, ny
    mx, my = side(shapes, q, p, pose_p)
    kx, ky = side(shapes, other, p, pose_p)
    inward = _leads(shapes, other, links.end[q, end], mx, my)
    if inward and _leads(shapes, q, end, kx, ky):
        return SIDE, mx, my
    apart, ox, oy = touch(shapes, p, pose_p, other, pose_q)
    if apart > CONTACT:
        moved = pose_p.copy()
        moved[0] -= distance * nx
        moved[1] -= distance * ny
        is_out = touch(shapes, p, moved, other, pose_q)[0] >= -CONTACT
        return (ACTS, nx, ny) if is_out else (SIDE, mx, my)
    third = leans_on(shapes, links, other, ox, oy)[0]
    # One round which the part has come, to lie on the neighbour alone, does not close.
    if third < 0 or (third != q and inward):
        return LEFT, nx, ny
    return SIDE, mx, my


@compiled
def deepest_point(
    shapes: Shapes, links: Links, p: int, pose_p: FloatArray, segment: int, nx: float, ny: float
) -> tuple[bool, float, float, float, float]:
    """Point of part p farthest beyond a segment: (is there one?, x, y, x, y of its foot).

    The unit normal (nx, ny) leads from the segment to the side on which the part belongs, and the
    foot is on the segment's line. The part is cut off at the ends of the segment, beyond which
    other walls may stand otherwise; but not at an end where the next segment bends to the part's
    side: what is beyond one line there is beyond the corner. The nearest point where none is
    beyond.
    """
    v, k = shapes.vertices, shapes.part_start[segment]
    length = np.hypot(v[k + 1, 0] - v[k, 0], v[k + 1, 1] - v[k, 1])
    ex, ey = (v[k + 1, 0] - v[k, 0]) / length, (v[k + 1, 1] - v[k, 1]) / length
    c, s = np.cos(pose_p[2]), np.sin(pose_p[2])
    first, last = shapes.part_start[p], shapes.part_start[p + 1]
    count = last - first
    part, rest = np.empty((count + 4, 2)), np.empty((count + 4, 2))
    for m in range(count):
        px, py = v[first + m, 0], v[first + m, 1]
        x = pose_p[0] - v[k, 0] + c * px - s * py
        y = pose_p[1] - v[k, 1] + s * px + c * py
        part[m, 0], part[m, 1] = ex * x + ey * y, nx * x + ny * y
    for end in range(2):
        if links.part[segment, end] >= 0:
            ox, oy = onward(shapes, links, segment, end)
            if nx * ox + ny * oy > 0.0:
                continue
        count = cut_off(part, count, 0.0 if end == 0 else length, 1.0 - 2.0 * end, rest)
        part, rest = rest, part
    if count == 0:
        return False, 0.0, 0.0, 0.0, 0.0
    at = 0
    for m in range(1, count):
        if part[m, 1] < part[at, 1]:
            at = m
    fx, fy = v[k, 0] + part[at, 0] * ex, v[k, 1] + part[at, 0] * ey
    return True, fx + part[at, 1] * nx, fy + part[at, 1] * ny, fx, fy


@compiled
def cut_off(part: FloatArray, count: int, at: float, sign: float, out: FloatArray) -> int:
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
