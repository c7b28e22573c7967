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
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.bodies import relative_frame
from physim.geometry.convex import part_gap, part_witness
from physim.geometry.shapes import FloatArray, IntRows2, Part, Shapes
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

    part: IntRows2
    """(P, 2) the segment that goes on there, the straightest of several; or -1"""
    end: IntRows2
    """(P, 2) which end of that segment"""


class Meeting(NamedTuple):
    """Two parts, p < q, which the engine reports to touch: robots come first."""

    shapes: Shapes
    links: Links
    p: int
    pose_p: FloatArray
    """(3,) of the body of p"""
    q: int
    pose_q: FloatArray


def segment_links(shapes: Shapes) -> Links:
    """Find which segments meet: where an end of one is exactly an end of the other."""
    v, start, count = shapes.vertices, shapes.part_start, len(shapes.part_start) - 1
    links = Links(np.full((count, 2), -1, np.int64), np.zeros((count, 2), np.int64))
    meeting: dict[tuple[float, ...], list[tuple[int, int]]] = {}
    for p in np.flatnonzero(np.diff(start) == 2).tolist():
        for end in (0, 1):
            meeting.setdefault(tuple(v[start[p] + end].tolist()), []).append((p, end))

    def leaving(p: int, end: int) -> FloatArray:
        way = v[start[p] + 1 - end] - v[start[p] + end]
        return np.asarray(way / np.hypot(*way))

    for some in meeting.values():
        for p, end in some:
            others = [one for one in some if one[0] != p]
            if others:
                onto = -leaving(p, end)
                ahead = [float(leaving(*one) @ onto) for one in others]
                links.part[p, end], links.end[p, end] = others[int(np.argmax(ahead))]
    return links


@compiled
def touch(m: Meeting) -> tuple[float, float, float]:
    """Signed distance [m] of the parts, and its unit normal from q to p (world frame).

    The distance is that of `body_distance` to the last bit.
    """
    v, start = m.shapes.vertices, m.shapes.part_start
    P, Q = Part(v, start[m.p], start[m.p + 1]), Part(v, start[m.q], start[m.q + 1])
    found = part_witness(P, Q, relative_frame(m.pose_p, m.pose_q))
    cp, sp = np.cos(m.pose_p[2]), np.sin(m.pose_p[2])
    nx, ny = found.nx, found.ny
    return found.distance, -(cp * nx - sp * ny), -(sp * nx + cp * ny)


@compiled
def leans_on(m: Meeting, nx: float, ny: float) -> tuple[int, int]:
    """Neighbour towards which a push (nx, ny) from segment q leads, and at which end of q.

    (-1, 0) where it leads to none. The push comes from the end that lies farthest along it. It
    leads on to the neighbour if that lies still farther along.
    """
    v, k = m.shapes.vertices, m.shapes.part_start[m.q]
    ex, ey = v[k + 1, 0] - v[k, 0], v[k + 1, 1] - v[k, 1]
    along = nx * ex + ny * ey
    if abs(along) <= SIDE_ANGLE * np.hypot(ex, ey):
        return -1, 0
    end = 1 if along > 0.0 else 0
    if m.links.part[m.q, end] < 0:
        return -1, 0
    ox, oy = onward(m, end)
    if not nx * ox + ny * oy > 0.0:
        return -1, 0
    return m.links.part[m.q, end], end


@compiled
def onward(m: Meeting, end: int) -> tuple[float, float]:
    """Vector [m] along the neighbour at an end of segment q, from there to its far end."""
    v, k = m.shapes.vertices, m.shapes.part_start[m.q] + end
    far = m.shapes.part_start[m.links.part[m.q, end]] + 1 - m.links.end[m.q, end]
    return v[far, 0] - v[k, 0], v[far, 1] - v[k, 1]


@compiled
def side(m: Meeting) -> tuple[float, float]:
    """Unit normal of segment q (world frame) towards the side where the middle of part p is."""
    v, k = m.shapes.vertices, m.shapes.part_start[m.q]
    ex, ey = v[k + 1, 0] - v[k, 0], v[k + 1, 1] - v[k, 1]
    first, last = m.shapes.part_start[m.p], m.shapes.part_start[m.p + 1]
    x, y = 0.0, 0.0
    for j in range(first, last):
        x += v[j, 0] / (last - first)
        y += v[j, 1] / (last - first)
    c, s = np.cos(m.pose_p[2]), np.sin(m.pose_p[2])
    dx = m.pose_p[0] + c * x - s * y - v[k, 0]
    dy = m.pose_p[1] + s * x + c * y - v[k, 1]
    size = np.copysign(np.hypot(ex, ey), ex * dy - ey * dx)
    return -ey / size, ex / size


@compiled
def leads(m: Meeting, end: int, nx: float, ny: float) -> bool:
    """Whether segment q leads from one of its ends to the side to which (nx, ny) points."""
    v, k = m.shapes.vertices, m.shapes.part_start[m.q]
    ex, ey = v[k + 1 - end, 0] - v[k + end, 0], v[k + 1 - end, 1] - v[k + end, 1]
    return bool(nx * ex + ny * ey > SIDE_ANGLE * np.hypot(ex, ey))


@compiled
def classify(m: Meeting) -> tuple[int, float, float]:
    """APART, ACTS, LEFT or SIDE; and, for SIDE, the unit normal to take from q to p."""
    v, start = m.shapes.vertices, m.shapes.part_start
    if start[m.q + 1] - start[m.q] != 2:
        P, Q = Part(v, start[m.p], start[m.p + 1]), Part(v, start[m.q], start[m.q + 1])
        distance = part_gap(P, Q, relative_frame(m.pose_p, m.pose_q), np.inf)
        return (APART if distance > CONTACT else ACTS), 0.0, 0.0
    distance, nx, ny = touch(m)
    if distance > CONTACT:
        return APART, nx, ny
    other, end = leans_on(m, nx, ny)
    if other < 0:
        return ACTS, nx, ny
    near = Meeting(m.shapes, m.links, m.p, m.pose_p, other, m.pose_q)
    mx, my = side(m)
    kx, ky = side(near)
    inward = leads(near, m.links.end[m.q, end], mx, my)
    if inward and leads(m, end, kx, ky):
        return SIDE, mx, my
    apart, ox, oy = touch(near)
    if apart > CONTACT:
        out = np.empty(3)
        out[0], out[1] = m.pose_p[0] - distance * nx, m.pose_p[1] - distance * ny
        out[2] = m.pose_p[2]
        is_out = touch(Meeting(m.shapes, m.links, m.p, out, other, m.pose_q))[0] >= -CONTACT
        return (ACTS, nx, ny) if is_out else (SIDE, mx, my)
    third = leans_on(near, ox, oy)[0]
    # One round which the part has come, to lie on the neighbour alone, does not close.
    if third < 0 or (third != m.q and inward):
        return LEFT, nx, ny
    return SIDE, mx, my
