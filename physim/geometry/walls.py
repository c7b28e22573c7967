"""Walls in a tree of boxes: what a robot sees of them, however many there are.

The parts are put in an order that keeps neighbours together, a few of them to a leaf, and every
node has the box that holds its parts. A question about a place goes down only where a box could
matter. Boxes only leave out what cannot change an answer: values are those of a look at all parts
that the robot sees, to the last bit.

A robot sees a part that comes within its reach.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.geometry.bodies import outline_distance, wall_gap
from physim.geometry.collision import stays, swept_disc, until_all_repeats, wall_time
from physim.geometry.convex import Frame, frame_at
from physim.geometry.motion import Course, chord_factor, still_course
from physim.geometry.neighbours import put_in_order
from physim.geometry.shapes import FloatArray, IntArray, IntRows8, Part, Rows4, Rows9, Shapes

LEAF = 4
"""Parts of a leaf."""

LISTED = 8
"""Parts that are remembered of a search."""

MARGIN = 1e-6
"""[m] A box must be farther than needed by this: far above rounding within 1,000 km."""

CODE_BITS = 16
"""Bits of either coordinate in the order of the parts."""


class WallTree(NamedTuple):
    """Binary tree over the parts of ``walls``: node k has the children 2 k and 2 k + 1.

    Node 1 is the root; the last ``leaves`` nodes are leaves, leaf m with the parts
    ``part[m * LEAF:(m + 1) * LEAF]``.
    """

    walls: Shapes
    part: IntArray
    """(P,)"""
    parts: int
    """P"""
    box: Rows4
    """(2 leaves, 4) [m] least x, y, greatest x, y of each node; row 0 is not used"""
    leaves: int
    """a power of two"""


class NearestWalls(NamedTuple):
    """Parts of walls about each of N robots, from the last search: they only save time."""

    part: IntRows8
    """(N, LISTED) the nearest first; -1: no more"""
    at: Rows4
    """(N, 4) x, y [m], cosine and sine of the heading at that search"""
    gap: Rows9
    """(N, LISTED + 1) [m] how far each of them was then, at least, and every other part"""


class Sight(NamedTuple):
    """Walls as a robot sees them: the parts that come within ``reach`` of (x, y)."""

    tree: WallTree
    x: float
    y: float
    reach: float
    """[m]"""
    nearest: NearestWalls


def nearest_walls(robots: int) -> NearestWalls:
    """What is known before the first search."""
    return NearestWalls(
        np.full((robots, LISTED), -1), np.zeros((robots, 4)), np.zeros((robots, LISTED + 1))
    )


def build_wall_tree(walls: Shapes) -> WallTree:
    """Order the parts of walls along a Z-curve and box them."""
    count = len(walls.part_start) - 1
    leaves = 1
    while leaves * LEAF < count:
        leaves *= 2
    box = np.tile([np.inf, np.inf, -np.inf, -np.inf], (2 * leaves, 1))
    if not count:
        return WallTree(walls, np.zeros(0, dtype=np.int64), 0, box, leaves)
    first = walls.part_start[:-1]
    low = np.minimum.reduceat(walls.vertices, first)
    high = np.maximum.reduceat(walls.vertices, first)
    order = np.argsort(_z_codes(0.5 * (low + high)), kind="stable")
    ordered = np.tile([np.inf, np.inf, -np.inf, -np.inf], (leaves * LEAF, 1))
    ordered[:count] = np.concatenate((low, high), axis=1)[order]
    row = leaves
    while row:
        below = ordered if row == leaves else box[2 * row : 4 * row]
        level = below.reshape(row, -1, 4)
        box[row : 2 * row, :2] = level[..., :2].min(axis=1)
        box[row : 2 * row, 2:] = level[..., 2:].max(axis=1)
        row //= 2
    return WallTree(walls, order.astype(np.int64), count, box, leaves)


def _z_codes(points: FloatArray) -> IntArray:
    """Places of points (n, 2) along a Z-curve over the square that holds them."""
    low = points.min(axis=0)
    size = float((points.max(axis=0) - low).max())
    scale = (2**CODE_BITS - 1) / size if size > 0.0 else 0.0
    x, y = ((points - low) * scale).astype(np.int64).T
    code = np.zeros(len(points), dtype=np.int64)
    for bit in range(CODE_BITS):
        code |= ((x >> bit & 1) << 2 * bit) | ((y >> bit & 1) << 2 * bit + 1)
    return code


@compiled
def beyond(box: Rows4, node: int, x: float, y: float, distance: float) -> bool:
    """Whether the box of a node is surely farther from (x, y) than ``distance`` [m]."""
    dx = max(box[node, 0] - x, x - box[node, 2], 0.0)
    dy = max(box[node, 1] - y, y - box[node, 3], 0.0)
    room = distance + MARGIN
    return room < 0.0 or dx * dx + dy * dy > room * room


@compiled
def leaf_after(tree: WallTree, before: int, x: float, y: float, distance: float) -> int:
    """Next leaf that is not ``beyond`` the distance, behind leaf ``before``; 0: none is left.

    The first one is behind 0.
    """
    node = before
    goes_down = before == 0
    while True:
        if goes_down:
            node = max(1, 2 * node)
        else:
            while node & 1:
                node >>= 1
            if node == 0:
                return 0
            node += 1
        goes_down = not beyond(tree.box, node, x, y, distance)
        if goes_down and node >= tree.leaves:
            return node


@compiled
def is_seen(sight: Sight, wall: Part) -> bool:
    """Whether the robot sees a part."""
    dx, dy = wall.vertices[wall.first, 0] - sight.x, wall.vertices[wall.first, 1] - sight.y
    surely = sight.reach - MARGIN
    if surely > 0.0 and dx * dx + dy * dy < surely * surely:
        return True  # no point of it need be nearer than its first corner
    return outline_distance(wall, sight.x, sight.y) <= sight.reach


class Parts(NamedTuple):
    """Some parts of walls, increasing."""

    number: IntArray
    size: int


@compiled
def parts_seen(sight: Sight, x: float, y: float, within: float) -> Parts:
    """Parts in sight that come within ``within`` [m] of (x, y).

    Of parts just farther than that it may give some, too, up to MARGIN.
    """
    tree, W, start = sight.tree, sight.tree.walls.vertices, sight.tree.walls.part_start
    room, count = 16, 0
    found = np.empty(room, np.int64)
    leaf = leaf_after(tree, 0, x, y, within)
    while leaf:
        first = (leaf - tree.leaves) * LEAF
        for k in range(first, min(first + LEAF, tree.parts)):
            part = tree.part[k]
            wall = Part(W, start[part], start[part + 1])
            if outline_distance(wall, x, y) <= within + MARGIN and is_seen(sight, wall):
                if count == room:
                    room *= 2
                    more = np.empty(room, np.int64)
                    for m in range(count):
                        more[m] = found[m]
                    found = more
                found[count] = part
                count += 1
        leaf = leaf_after(tree, leaf, x, y, within)
    put_in_order(found, count)
    return Parts(found, count)


@compiled
def parts_near(tree: WallTree, x: float, y: float, within: float, known: NearestWalls) -> Parts:
    """Parts that come within ``within`` [m] of (x, y); up to MARGIN farther, some."""
    return parts_seen(Sight(tree, x, y, np.inf, known), x, y, within)


@compiled
def all_seen(sight: Sight) -> Parts:
    """All parts in sight."""
    return parts_seen(sight, sight.x, sight.y, sight.reach)


def parts_within(tree: WallTree, x: float, y: float, reach: float) -> IntArray:
    """Parts that come within ``reach`` [m] of a place, increasing."""
    found = np.empty(tree.parts, np.int64)
    sight = Sight(tree, x, y, reach, nearest_walls(0))
    return found[: put_all_seen(sight, found)]


@compiled
def put_all_seen(sight: Sight, out: IntArray) -> int:
    """Write all parts in sight into ``out``; how many."""
    found = all_seen(sight)
    for k in range(found.size):
        out[k] = found.number[k]
    return found.size


@compiled
def comes_near(sight: Sight, x: float, y: float, distance: float) -> bool:
    """Whether a part in sight is nearer to (x, y) than ``distance`` [m]."""
    tree, W, start = sight.tree, sight.tree.walls.vertices, sight.tree.walls.part_start
    leaf = leaf_after(tree, 0, x, y, distance)
    while leaf:
        first = (leaf - tree.leaves) * LEAF
        for k in range(first, min(first + LEAF, tree.parts)):
            part = tree.part[k]
            wall = Part(W, start[part], start[part + 1])
            if outline_distance(wall, x, y) < distance and is_seen(sight, wall):
                return True
        leaf = leaf_after(tree, leaf, x, y, distance)
    return False


@compiled
def segment_bound(wall: Part, shapes: Shapes, i: int, f: Frame) -> float:
    """Lower bound [m] of the signed distance of a segment from body i, whose frame is f.

    In the frame of the segment the body has a box, which is held against the segment; -inf where
    the two meet, and of what is no segment.
    """
    if wall.end - wall.first != 2:
        return -np.inf
    W, w, Q = wall.vertices, wall.first, shapes.vertices
    ex, ey = W[w + 1, 0] - W[w, 0], W[w + 1, 1] - W[w, 1]
    length = math.sqrt(ex * ex + ey * ey)
    ex, ey = ex / length, ey / length
    dx, dy = f.tx - W[w, 0], f.ty - W[w, 1]
    along, across = ex * dx + ey * dy, ex * dy - ey * dx
    ux, uy = f.c * ex + f.s * ey, f.c * ey - f.s * ex
    low_u, high_u, low_v, high_v = np.inf, -np.inf, np.inf, -np.inf
    first, end = shapes.body_start[i], shapes.body_start[i + 1]
    for k in range(shapes.part_start[first], shapes.part_start[end]):
        u = ux * Q[k, 0] + uy * Q[k, 1]
        v = ux * Q[k, 1] - uy * Q[k, 0]
        low_u, high_u = min(low_u, u), max(high_u, u)
        low_v, high_v = min(low_v, v), max(high_v, v)
    gap_u = max(along + low_u - length, -(along + high_u), 0.0)
    gap_v = max(across + low_v, -(across + high_v), 0.0)
    gap = math.sqrt(gap_u * gap_u + gap_v * gap_v)
    return gap if gap > 0.0 else -np.inf


@compiled
def nearest_seen(shapes: Shapes, i: int, f: Frame, sight: Sight) -> tuple[float, int]:
    """Signed distance [m] of robot i, whose frame is f, from the walls in sight, and the nearest.

    Of equally near parts it is the lowest; (inf, -1) without any. Those about it at the last search
    are tried first: with how far the robot has moved since, they are often known to be all.
    """
    tree, W, start = sight.tree, sight.tree.walls.vertices, sight.tree.walls.part_start
    radius, best, nearest = shapes.radius[i], np.inf, -1
    listed, at, gaps = sight.nearest.part[i], sight.nearest.at[i], sight.nearest.gap[i]
    dx, dy, dc, ds = f.tx - at[0], f.ty - at[1], f.c - at[2], f.s - at[3]
    moved = math.sqrt(dx * dx + dy * dy) + radius * math.sqrt(dc * dc + ds * ds) + MARGIN
    for m in range(LISTED):
        part = listed[m]
        if part < 0:
            break
        wall = Part(W, start[part], start[part + 1])
        if m and (gaps[m] - moved > best or segment_bound(wall, shapes, i, f) > best + MARGIN):
            continue
        # A hair more than the best, so that a part just as near gives its exact distance.
        gap = wall_gap(wall, shapes, i, f, np.nextafter(best, np.inf))
        if (gap < best or (gap == best and part < nearest)) and is_seen(sight, wall):
            best, nearest = gap, part
    if nearest >= 0 and best + moved < gaps[LISTED]:
        return best, nearest
    dx, dy = f.tx - sight.x, f.ty - sight.y
    seen = sight.reach + math.sqrt(dx * dx + dy * dy)  # nothing that is farther is in sight
    tried, count, spare, others = nearest, 0, radius, np.inf
    if nearest >= 0:
        listed[0], gaps[0], count = nearest, best, 1
    leaf = leaf_after(tree, 0, f.tx, f.ty, min(best + spare + radius, seen))
    while leaf:
        first = (leaf - tree.leaves) * LEAF
        for k in range(first, min(first + LEAF, tree.parts)):
            part, enough = tree.part[k], best + spare
            wall = Part(W, start[part], start[part + 1])
            if part == tried or segment_bound(wall, shapes, i, f) > enough + MARGIN:
                continue
            gap = wall_gap(wall, shapes, i, f, np.nextafter(enough, np.inf))
            if (gap < best or (gap == best and part < nearest)) and is_seen(sight, wall):
                best, nearest = gap, part
            place = count
            if count == LISTED:
                place = 0
                for m in range(1, LISTED):
                    if gaps[m] > gaps[place]:
                        place = m
                others = min(others, max(gap, gaps[place]))
            if count < LISTED or gap < gaps[place]:
                listed[place], gaps[place], count = part, gap, min(count + 1, LISTED)
            if best < np.inf:
                spare = max(0.0, min(spare, others - best))
        leaf = leaf_after(tree, leaf, f.tx, f.ty, min(best + spare + radius, seen))
    for m in range(LISTED):
        if m >= count:
            listed[m] = -1
        elif listed[m] == nearest:
            listed[0], listed[m] = listed[m], listed[0]
            gaps[0], gaps[m] = gaps[m], gaps[0]
    at[0], at[1], at[2], at[3] = f.tx, f.ty, f.c, f.s
    gaps[LISTED] = min(others, best + spare, seen - radius)
    return best, nearest


@compiled
def seen_distance(shapes: Shapes, i: int, pose: FloatArray, sight: Sight) -> float:
    """Signed distance [m] of robot i at ``pose`` from the walls in sight; inf without any."""
    f = frame_at(math.cos(pose[2]), math.sin(pose[2]), pose[0], pose[1])
    return nearest_seen(shapes, i, f, sight)[0]


@compiled
def reached_disc(a: Course, time: float) -> tuple[float, float, float]:
    """Return (x, y, radius) of a disc that a body does not leave up to a time [s]."""
    if not time < np.inf:
        if stays(a):
            return swept_disc(a)
        return a.x, a.y, np.inf
    # No point of its way is farther from the middle of it than half its length.
    half, h = 0.5 * a.speed * time, 0.25 * a.turn * time
    c, s, way = math.cos(h), math.sin(h), 0.5 * time * chord_factor(h)
    x, y = a.x + way * (c * a.vx - s * a.vy), a.y + way * (c * a.vy + s * a.vx)
    if stays(a):
        its_x, its_y, radius = swept_disc(a)
        if not radius > a.radius + half:
            return its_x, its_y, radius
    return x, y, a.radius + half


@compiled
def seen_time(shapes: Shapes, i: int, a: Course, sight: Sight, horizon: float) -> float:
    """Collision time [s] of robot i on course a and the walls in sight; inf if none."""
    tree, W, start = sight.tree, sight.tree.walls.vertices, sight.tree.walls.part_start
    until, xi = until_all_repeats(a, horizon), np.inf
    x, y, radius = reached_disc(a, until)
    leaf = leaf_after(tree, 0, x, y, radius)
    while leaf:
        first = (leaf - tree.leaves) * LEAF
        for k in range(first, min(first + LEAF, tree.parts)):
            wall = Part(W, start[tree.part[k]], start[tree.part[k] + 1])
            if is_seen(sight, wall):
                time = wall_time(wall, still_course(), shapes, i, a, min(xi, until))
                if time < xi:
                    xi = time
                    x, y, radius = reached_disc(a, min(xi, until))
        leaf = leaf_after(tree, leaf, x, y, radius)
    return xi
