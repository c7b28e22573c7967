"""Walls that touch are one solid: its outline has no seams that could hold what slides along it.

Obstacles are of one solid where they touch, boundaries where an end of one is exactly an end of
another. A solid of several walls is its outline: straight segments from corner to corner, however
many walls make one up. A wall on its own stays as it is, to the last bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, pairwise
from typing import NamedTuple

import numpy as np
import shapely

from physim.geometry.shapes import (
    FloatArray,
    IntArray,
    Shapes,
    body_parts,
    pack_parts,
    part_bodies,
)
from physim.tolerances import CONTACT, LENGTH
from physim.world.ground.area import united
from physim.world.ground.lines import simplified

FLUSH = 2.0 * LENGTH
"""[m] How far an outline may be from the walls it goes along: rounding to the grid of `LENGTH`, on
which polygons are united, moves each by less than half of that."""


class Solids(NamedTuple):
    """What W walls are made of."""

    shapes: Shapes
    """the S solids, world frame, in the order of their first walls"""
    of: IntArray
    """(W,) solid of each wall"""
    start: IntArray
    """(S + 1,) solid s has the walls ``wall[start[s]:start[s + 1]]``"""
    wall: IntArray
    """(W,)"""
    faces: Shapes
    """for each wall the segments of its solid that go along it; none for a wall on its own"""


def solids_of(walls: Shapes) -> Solids:
    """Unite the walls that touch."""
    of = _solids(walls)
    wall = np.argsort(of, kind="stable")
    start = np.searchsorted(of[wall], np.arange(of.max(initial=-1) + 2))
    solids: list[list[FloatArray]] = []
    faces: list[list[FloatArray]] = [[] for _ in of]
    for first, last in pairwise(start):
        bodies = [body_parts(walls, w) for w in wall[first:last]]
        if len(bodies) == 1:
            solids += bodies
            continue
        solids.append(_outline(list(chain.from_iterable(bodies))))
        for w, own in zip(wall[first:last], _along(solids[-1], bodies), strict=True):
            faces[w] = own
    return Solids(pack_parts(solids), of, start, wall, pack_parts(faces))


def _solids(walls: Shapes) -> IntArray:
    """Number (W,) of the solid of each wall, in the order of their first walls."""
    body, count = part_bodies(walls), len(walls.body_start) - 1
    parts = np.split(walls.vertices, walls.part_start[1:-1]) if len(body) else []
    polygons = np.array([shapely.Polygon(part) for part in parts if len(part) > 2], dtype=object)
    is_line = np.diff(walls.part_start) == 2
    tree = shapely.STRtree(polygons)
    touching = body[~is_line][tree.query(polygons, predicate="dwithin", distance=CONTACT)]
    lines = np.flatnonzero(np.repeat(is_line, np.diff(walls.part_start)))
    _, node = np.unique(walls.vertices[lines], axis=0, return_inverse=True)
    ends = np.repeat(body[is_line], 2), count + node.ravel()
    one, other = np.concatenate((touching, ends), axis=1)
    least = np.arange(count + len(lines))  # of all that are known to be of one solid
    while True:  # scipy has this, but takes as long to import as all of physim
        before = least.copy()
        np.minimum.at(least, one, before[other])
        np.minimum.at(least, other, before[one])
        least = least[least]
        if np.array_equal(least, before):
            break
    return np.asarray(np.unique(least[:count], return_inverse=True)[1], dtype=np.int64)


def _outline(parts: Sequence[FloatArray]) -> list[FloatArray]:
    """Segments (2, 2) of the outline of polygons that touch, or of segments that join."""
    if len(parts[0]) > 2:
        solid = united([shapely.Polygon(part) for part in parts])
        lines = shapely.get_parts(shapely.get_rings(shapely.get_parts(solid)))
        drawn = np.concatenate(parts)
    else:
        lines = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(list(parts))))
        drawn = np.zeros((0, 2))
    corners = shapely.STRtree(shapely.points(drawn))
    found = []
    for line in map(shapely.get_coordinates, lines):
        rounded, corner = corners.query_nearest(
            shapely.points(line), max_distance=FLUSH, all_matches=False
        )
        line[rounded] = drawn[corner]
        if (line[0] == line[-1]).all():  # begins at a corner, not somewhere along a side
            far = int(np.argmax(np.hypot(*(line - line.mean(axis=0)).T)))
            line = np.concatenate((line[far:-1], line[: far + 1]))
        found += [np.array(pair) for pair in pairwise(simplified(line, FLUSH))]
    return found


def _along(
    outline: Sequence[FloatArray], bodies: Sequence[Sequence[FloatArray]]
) -> list[list[FloatArray]]:
    """For each body those segments of an outline that go along an edge of it for a stretch."""
    edges, owner = [], []
    for body, parts in enumerate(bodies):
        for part in parts:
            own = np.stack((part, np.roll(part, -1, axis=0)), axis=1)
            edges.append(own if len(part) > 2 else own[:1])
            owner += [body] * len(edges[-1])
    edge, segments = np.concatenate(edges), np.array(outline)
    tree = shapely.STRtree(shapely.linestrings(segments))
    near, which = tree.query(shapely.linestrings(edge), predicate="dwithin", distance=2.0 * FLUSH)
    way = segments[which, 1] - segments[which, 0]
    length = np.hypot(*way.T)
    way /= length[:, None]
    off = edge[near] - segments[which, :1]
    along, beside = off @ way[:, :, None], off @ (way[:, ::-1] * (-1.0, 1.0))[:, :, None]
    low, high = np.maximum(along.min(axis=(1, 2)), 0.0), np.minimum(along.max(axis=(1, 2)), length)
    goes = high - low > 2.0 * FLUSH
    (first, last), (start, end) = along[goes, :, 0].T, beside[goes, :, 0].T
    share = (0.5 * (low + high)[goes] - first) / (last - first)
    goes[goes] = np.abs(start + share * (end - start)) <= 2.0 * FLUSH
    found: list[list[FloatArray]] = [[] for _ in bodies]
    for body, k in sorted({(owner[n], k) for n, k in zip(near[goes], which[goes], strict=True)}):
        found[body].append(outline[k])
    return found
