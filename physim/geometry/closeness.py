"""Where and how deep pairs of bodies touch, by exact separation.

The engine's own depth is wrong for aligned shapes, so nothing is said about a contact but by the
separation kernels of `physim.geometry`. Robots and walls share one numbering here, robots first.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.separation import body_separation
from physim.geometry.shapes import FloatArray, IntArray, Shapes


def joined(shapes: Shapes, walls: Shapes) -> Shapes:
    """Return robots and walls in one numbering of bodies and parts: robots first."""
    return Shapes(
        np.concatenate((shapes.vertices, walls.vertices)),
        np.concatenate((shapes.part_start, walls.part_start[1:] + shapes.part_start[-1])),
        np.concatenate((shapes.body_start, walls.body_start[1:] + shapes.body_start[-1])),
        np.concatenate((shapes.radius, walls.radius)),
    )


@compiled
def describe_pairs(shapes: Shapes, pose: FloatArray, pairs: IntArray) -> FloatArray:
    """Return (M, 5) for pairs (M, 2) of bodies at ``pose`` (B, 3): x, y, nx, ny, signed distance.

    The point [m] lies midway between the deepest points of either body within the other, or
    midway between the nearest points where they are apart; the unit normal leads from the first
    body to the second.
    """
    out = np.empty((len(pairs), 5))
    for k in range(len(pairs)):
        a, b = pairs[k, 0], pairs[k, 1]
        d, nx, ny, ax, ay, bx, by = body_separation(shapes, a, pose[a], shapes, b, pose[b])
        out[k, 0] = 0.5 * (ax + bx)
        out[k, 1] = 0.5 * (ay + by)
        out[k, 2] = nx
        out[k, 3] = ny
        out[k, 4] = d
    return out
