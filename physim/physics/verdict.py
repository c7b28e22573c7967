"""Is a contact that the engine reports true, and how is this pair of parts to act on it?

A robot that slides along a wall of several segments meets the end of the next one, and that end
would hold it although the wall goes straight on. The engine's own remedy, telling segments their
neighbours, also loses true contacts (a nose in a corner touches neither wall, by its rule). So the
engine is not told, and the rule is here: a contact at the end of a segment that pushes the robot
towards the segment's neighbour is left to the neighbour, if that pushes it in a direction of its
own; where each leans on the other, both push along their own normals.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.separation import relative_frame
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.geometry.witness import part_witness
from physim.tolerances import CONTACT

APART = 0
"""the parts are apart: a false contact"""
ACTS = 1
"""a true contact"""
LEFT = 2
"""a true contact that is left to the neighbouring segment"""
SIDE = 3
"""a true contact of a segment, to be taken along the segment's own normal"""

FLAT = 1e-6
"""[rad] A normal within this of a segment's own is a contact with its side, not with an end."""


def segment_links(shapes: Shapes) -> IntArray:
    """Return (P, 2): which part of the same body meets each segment at its first and second end.

    -1 where there is none, and for parts that are not segments. Segments meet where one ends
    exactly where another starts.
    """
    links = np.full((len(shapes.part_start) - 1, 2), -1, dtype=np.int64)
    for first, last in zip(shapes.body_start[:-1], shapes.body_start[1:], strict=True):
        segments = [p for p in range(first, last) if np.diff(shapes.part_start)[p] == 2]
        starts = {tuple(shapes.vertices[shapes.part_start[p]]): p for p in segments}
        for p in segments:
            after = starts.get(tuple(shapes.vertices[shapes.part_start[p] + 1]), -1)
            if after >= 0:
                links[p, 1] = after
                links[after, 0] = p
    return links


@compiled
def touch(
    shapes: Shapes, p: int, pose_p: FloatArray, q: int, pose_q: FloatArray
) -> tuple[float, float, float]:
    """Signed distance [m] of parts p and q at the poses (3,) of their bodies, and its normal.

    The distance is that of `body_distance` to the last bit; the unit normal (world frame) leads
    from q to p.
    """
    c, s, tx, ty = relative_frame(pose_p, pose_q)
    v, start = shapes.vertices, shapes.part_start
    found = part_witness(
        v, start[p], start[p + 1], v, start[q], start[q + 1], c, s, tx, ty, 0.0, 0.0
    )
    cp, sp = np.cos(pose_p[2]), np.sin(pose_p[2])
    return found[0], -(cp * found[1] - sp * found[2]), -(sp * found[1] + cp * found[2])


@compiled
def leans_on(shapes: Shapes, links: IntArray, segment: int, nx: float, ny: float) -> int:
    """Neighbour towards which a push (nx, ny) from a segment (world frame) leads, or -1.

    The push comes from the end that lies farthest along it. It leads on to the neighbour if that
    lies still farther along.
    """
    v, k = shapes.vertices, shapes.part_start[segment]
    ex, ey = v[k + 1, 0] - v[k, 0], v[k + 1, 1] - v[k, 1]
    along = nx * ex + ny * ey
    if abs(along) <= FLAT * np.hypot(ex, ey):
        return -1
    end = 1 if along > 0.0 else 0
    other = links[segment, end]
    if other < 0:
        return -1
    # The neighbour's far end: it goes on from our second end, or comes to our first.
    far = shapes.part_start[other] + end
    return other if nx * (v[far, 0] - v[k + end, 0]) + ny * (v[far, 1] - v[k + end, 1]) > 0 else -1


@compiled
def judge(
    shapes: Shapes, links: IntArray, p: int, pose_p: FloatArray, q: int, pose_q: FloatArray
) -> tuple[int, float, float]:
    """Judge parts p < q (robots first) at the poses (3,) of their bodies.

    Returns APART, ACTS, LEFT or SIDE and, for SIDE, the unit normal to take from q to p.
    """
    distance, nx, ny = touch(shapes, p, pose_p, q, pose_q)
    if distance > CONTACT:
        return APART, nx, ny
    if shapes.part_start[q + 1] - shapes.part_start[q] != 2:
        return ACTS, nx, ny
    other = leans_on(shapes, links, q, nx, ny)
    if other < 0:
        return ACTS, nx, ny
    distance, ox, oy = touch(shapes, p, pose_p, other, pose_q)
    if distance > CONTACT:
        return ACTS, nx, ny
    if leans_on(shapes, links, other, ox, oy) < 0:
        return LEFT, nx, ny
    v, k = shapes.vertices, shapes.part_start[q]
    ex, ey = v[k + 1, 0] - v[k, 0], v[k + 1, 1] - v[k, 1]
    size = np.copysign(np.hypot(ex, ey), nx * ey - ny * ex)
    return SIDE, ey / size, -ex / size
