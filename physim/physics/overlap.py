"""How far a part is beyond a segment, measured along the segment's own normal."""

from __future__ import annotations

import numpy as np

from physim.geometry.shapes import FloatArray, Shapes
from physim.physics.verdict import Links, onward


def deepest(
    shapes: Shapes, links: Links, p: int, pose_p: FloatArray, segment: int, nx: float, ny: float
) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Points of part p farthest beyond a segment, two at most, each with its foot on its line.

    The unit normal (nx, ny) leads from the segment to the side on which the part belongs. The part
    is cut off at the ends of the segment, beyond which other walls may stand otherwise; but not at
    an end where the next segment bends to the part's side: what is beyond one line there is beyond
    the corner. The deepest point first; the nearest one where none is beyond.
    """
    v, k = shapes.vertices, shapes.part_start[segment]
    length = float(np.hypot(*(v[k + 1] - v[k])))
    ex, ey = (v[k + 1] - v[k]) / length
    c, s = np.cos(pose_p[2]), np.sin(pose_p[2])
    points = v[shapes.part_start[p] : shapes.part_start[p + 1]]
    x = pose_p[0] - v[k, 0] + c * points[:, 0] - s * points[:, 1]
    y = pose_p[1] - v[k, 1] + s * points[:, 0] + c * points[:, 1]
    # (along the segment, height over it)
    part = np.stack((ex * x + ey * y, nx * x + ny * y), 1)
    for end, at in ((0, 0.0), (1, length)):
        if links.part[segment, end] >= 0:
            ox, oy = onward(shapes, links, segment, end)
            if nx * ox + ny * oy > 0.0:
                continue
        part = _cut(part, at, 1.0 - 2.0 * end)
    if not len(part):
        return []
    part = part[np.argsort(part[:, 1], kind="stable")]
    beyond = part[part[:, 1] <= 0.0][:2]
    found = []
    for along, height in (beyond if len(beyond) else part[:1]).tolist():
        foot = (float(v[k, 0] + along * ex), float(v[k, 1] + along * ey))
        found.append(((foot[0] + height * nx, foot[1] + height * ny), foot))
    return found


def _cut(part: FloatArray, at: float, sign: float) -> FloatArray:
    """Polygon (n, 2) without what lies where sign * x < sign * at."""
    kept: list[FloatArray] = []
    inside = sign * (part[:, 0] - at) >= 0.0
    for k in range(len(part)):
        if inside[k] != inside[k - 1]:
            one, other = part[k - 1], part[k]
            share = (at - one[0]) / (other[0] - one[0])
            kept.append(np.array((at, one[1] + share * (other[1] - one[1]))))
        if inside[k]:
            kept.append(part[k])
    return np.array(kept).reshape(-1, 2)
