"""Where and how deep pairs of bodies touch, by exact separation.

The engine's own depth is wrong for aligned shapes, so all that is stated about a contact comes from
the separation kernels of `physim.geometry`.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.separation import body_separation
from physim.geometry.shapes import FloatArray, IntArray, Shapes


@compiled
def describe_pair(
    shapes_a: Shapes,
    a: int,
    pose_a: FloatArray,
    shapes_b: Shapes,
    b: int,
    pose_b: FloatArray,
    out: FloatArray,
) -> None:
    """Write x, y, nx, ny and signed distance [m] of two bodies into ``out`` (5,).

    The point [m] lies midway between the deepest points of either body within the other, or
    midway between the nearest points where they are apart; the unit normal leads from a to b.
    """
    d, nx, ny, ax, ay, bx, by = body_separation(shapes_a, a, pose_a, shapes_b, b, pose_b)
    out[0] = 0.5 * (ax + bx)
    out[1] = 0.5 * (ay + by)
    out[2] = nx
    out[3] = ny
    out[4] = d


@compiled
def describe_pairs(shapes: Shapes, pose: FloatArray, pairs: IntArray) -> FloatArray:
    """Return (M, 5) for pairs (M, 2) of bodies at ``pose`` (B, 3): rows of `describe_pair`."""
    out = np.empty((len(pairs), 5))
    for k in range(len(pairs)):
        a, b = pairs[k, 0], pairs[k, 1]
        describe_pair(shapes, a, pose[a], shapes, b, pose[b], out[k])
    return out
