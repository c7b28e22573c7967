"""Signed distances of bodies of convex parts by their Minkowski difference.

All differences a - b of points of two convex shapes form a convex polygon, the hull of the
differences of their vertices. The shapes' distance is that of the origin from this polygon; where
they overlap the origin lies in it, and its distance from the outline is the depth.
"""

from __future__ import annotations

import numpy as np
import shapely

ORIGIN = shapely.Point(0.0, 0.0)


def part_distances(pairs):
    """Signed distances (K,) [m] of pairs of convex parts (n, 2), (m, 2) in the world frame."""
    if not pairs:
        return np.zeros(0)
    differences = [(a[:, None, :] - b[None, :, :]).reshape(-1, 2) for a, b in pairs]
    longest = max(map(len, differences))
    padded = np.array([np.vstack([d, np.tile(d[-1], (longest - len(d), 1))]) for d in differences])
    hulls = shapely.convex_hull(shapely.linestrings(padded))
    inside = shapely.intersects(hulls, ORIGIN)
    depth = shapely.distance(shapely.boundary(hulls), ORIGIN)
    return np.where(inside, -depth, shapely.distance(hulls, ORIGIN))


def smallest_distances(mine, theirs):
    """Smallest signed distance (C,) [m] of my parts to theirs, for each of C arrangements.

    ``mine`` lists C lists of parts, ``theirs`` C lists; inf where ``theirs`` has none.
    """
    owner, pairs = [], []
    for c, (my_parts, their_parts) in enumerate(zip(mine, theirs, strict=True)):
        for a in my_parts:
            for b in their_parts:
                owner.append(c)
                pairs.append((a, b))
    smallest = np.full(len(mine), np.inf)
    np.minimum.at(smallest, np.array(owner, dtype=int), part_distances(pairs))
    return smallest
