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
from physim.geometry.collision import clear_of_part, part_time, stays, swept_disc
from physim.geometry.motion import Course, still_course
from physim.geometry.neighbours import put_in_order
from physim.geometry.safe_point import outline_distance
from physim.geometry.separation import wall_gap
from physim.geometry.shapes import FloatArray, IntArray, Shapes

LEAF = 4
"""Parts of a leaf."""

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
    box: FloatArray
    """(2 leaves, 4) [m] least x, y, greatest x, y of each node; row 0 is not used"""
    leaves: int
    """a power of two"""


class Sight(NamedTuple):
    """Walls as a robot sees them: the parts that come within ``reach`` of (x, y)."""

    tree: WallTree
    x: float
    y: float
    reach: float
    """[m]"""
    nearest: IntArray
    """(N,) part that was nearest to each robot when last asked, or -1: it only saves time"""


def build_wall_tree(walls: Shapes) -> WallTree:
    """Order the parts of walls along a Z-curve and box them."""
    count = len(walls.part_start) - 1
    leaves = 1
    while leaves * LEAF < count:
        leaves *= 2
    box = np.tile([np.inf, np.inf, -np.inf, -np.inf], (2 * leaves, 1))
    if not count:
        return WallTree(walls, np.zeros(0, dtype=np.int64), box, leaves)
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
    return WallTree(walls, order.astype(np.int64), box, leaves)


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
def beyond(box: FloatArray, node: int, x: float, y: float, distance: float) -> bool:
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
def is_seen(sight: Sight, part: int) -> bool:
    """Whether the robot sees a part."""
    start = sight.tree.walls.part_start
    V, reach = sight.tree.walls.vertices, sight.reach
    return outline_distance(V, start[part], start[part + 1], sight.x, sight.y) <= reach


@compiled
def parts_seen(sight: Sight, x: float, y: float, within: float) -> IntArray:
    """Parts in sight that come within ``within`` [m] of (x, y), increasing.

    Of parts just farther than that it may give some, too, up to MARGIN.
    """
    tree, W, start = sight.tree, sight.tree.walls.vertices, sight.tree.walls.part_start
    found = np.empty(16, dtype=np.int64)
    count = 0
    leaf = leaf_after(tree, 0, x, y, within)
    while leaf:
        first = (leaf - tree.leaves) * LEAF
        for k in range(first, min(first + LEAF, len(tree.part))):
            part = tree.part[k]
            apart = outline_distance(W, start[part], start[part + 1], x, y)
            if apart <= within + MARGIN and is_seen(sight, part):
                if count == len(found):
                    more = np.empty(2 * count, dtype=np.int64)
                    for m in range(count):  # a slice would take long to compile
                        more[m] = found[m]
                    found = more
                found[count] = part
                count += 1
        leaf = leaf_after(tree, leaf, x, y, within)
    put_in_order(found, count)
    return found[:count]


@compiled
def all_seen(sight: Sight) -> IntArray:
    """All parts in sight, increasing."""
    return parts_seen(sight, sight.x, sight.y, sight.reach)


def parts_within(tree: WallTree, x: float, y: float, reach: float) -> IntArray:
    """Parts that come within ``reach`` [m] of a place, increasing."""
    return all_seen(Sight(tree, x, y, reach, np.zeros(0, dtype=np.int64)))


@compiled
def comes_near(sight: Sight, x: float, y: float, distance: float) -> bool:
    """Whether a part in sight is nearer to (x, y) than ``distance`` [m]."""
    tree, W, start = sight.tree, sight.tree.walls.vertices, sight.tree.walls.part_start
    leaf = leaf_after(tree, 0, x, y, distance)
    while leaf:
        first = (leaf - tree.leaves) * LEAF
        for k in range(first, min(first + LEAF, len(tree.part))):
            part = tree.part[k]
            apart = outline_distance(W, start[part], start[part + 1], x, y)
            if apart < distance and is_seen(sight, part):
                return True
        leaf = leaf_after(tree, leaf, x, y, distance)
    return False


@compiled
def segment_bound(
    W: FloatArray, w: int, Q: FloatArray, q0: int, q1: int, c: float, s: float, x: float, y: float
) -> float:
    """Lower bound [m] of the signed distance of a segment ``W[w:w + 2]`` from ``Q[q0:q1]``.

    In the frame of the segment the vertices have a box, which is held against the segment; -inf
    where the two meet.
    """
    ex, ey = W[w + 1, 0] - W[w, 0], W[w + 1, 1] - W[w, 1]
    length = math.sqrt(ex * ex + ey * ey)
    ex, ey = ex / length, ey / length
    dx, dy = x - W[w, 0], y - W[w, 1]
    along, across = ex * dx + ey * dy, ex * dy - ey * dx
    ux, uy = c * ex + s * ey, c * ey - s * ex
    low_u, high_u, low_v, high_v = np.inf, -np.inf, np.inf, -np.inf
    for k in range(q0, q1):
        u = ux * Q[k, 0] + uy * Q[k, 1]
        v = ux * Q[k, 1] - uy * Q[k, 0]
        low_u, high_u = min(low_u, u), max(high_u, u)
        low_v, high_v = min(low_v, v), max(high_v, v)
    gap_u = max(along + low_u - length, -(along + high_u), 0.0)
    gap_v = max(across + low_v, -(across + high_v), 0.0)
    gap = math.sqrt(gap_u * gap_u + gap_v * gap_v)
    return gap if gap > 0.0 else -np.inf


@compiled
def nearest_seen(
    shapes: Shapes, i: int, x: float, y: float, c: float, s: float, sight: Sight
) -> tuple[float, int]:
    """Signed distance [m] of robot i from the walls in sight, and the nearest part.

    The robot is at (x, y), its heading has the cosine c and the sine s. Of equally near parts it
    is the lowest; (inf, -1) without any.
    """
    tree, W, w_start = sight.tree, sight.tree.walls.vertices, sight.tree.walls.part_start
    Q, q_start = shapes.vertices, shapes.part_start
    first_q, last_q = shapes.body_start[i], shapes.body_start[i + 1]
    q0, q1, radius = q_start[first_q], q_start[last_q], shapes.radius[i]
    best, nearest, likely = np.inf, -1, sight.nearest[i]
    if likely >= 0 and is_seen(sight, likely):
        w0, w1, nearest = w_start[likely], w_start[likely + 1], likely
        best = wall_gap(W, w0, w1, Q, q_start, first_q, last_q, radius, c, s, x, y, np.inf)
    leaf = leaf_after(tree, 0, x, y, best + radius)
    while leaf:
        first = (leaf - tree.leaves) * LEAF
        for k in range(first, min(first + LEAF, len(tree.part))):
            part = tree.part[k]
            w0, w1 = w_start[part], w_start[part + 1]
            if part == likely or (
                w1 - w0 == 2 and segment_bound(W, w0, Q, q0, q1, c, s, x, y) > best + MARGIN
            ):
                continue
            # A hair more than the best, so that a part just as near gives its exact distance.
            enough = np.nextafter(best, np.inf)
            gap = wall_gap(W, w0, w1, Q, q_start, first_q, last_q, radius, c, s, x, y, enough)
            if (gap < best or (gap == best and part < nearest)) and is_seen(sight, part):
                best, nearest = gap, part
        leaf = leaf_after(tree, leaf, x, y, best + radius)
    if nearest >= 0:
        sight.nearest[i] = nearest
    return best, nearest


@compiled
def seen_distance(shapes: Shapes, i: int, pose: FloatArray, sight: Sight) -> float:
    """Signed distance [m] of robot i at ``pose`` from the walls in sight; inf without any."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return nearest_seen(shapes, i, pose[0], pose[1], c, s, sight)[0]


@compiled
def reached_disc(a: Course, time: float) -> tuple[float, float, float]:
    """Return (x, y, radius) of a disc that a body does not leave up to a time [s]."""
    half = 0.5 * a.speed * time
    if a.turn == 0.0 and half < np.inf:
        return a.x + 0.5 * time * a.vx, a.y + 0.5 * time * a.vy, a.radius + half
    if stays(a):
        x, y, radius = swept_disc(a)
        if not radius > a.radius + 2.0 * half:
            return x, y, radius
    return a.x, a.y, a.radius + 2.0 * half


@compiled
def seen_time(shapes: Shapes, i: int, a: Course, sight: Sight, horizon: float) -> float:
    """Collision time [s] of robot i on course a and the walls in sight; inf if none.

    As `physim.geometry.collision.walls_time` gives it for the parts in sight.
    """
    tree, W, w_start = sight.tree, sight.tree.walls.vertices, sight.tree.walls.part_start
    Q, q_start = shapes.vertices, shapes.part_start
    first_q, last_q = shapes.body_start[i], shapes.body_start[i + 1]
    still, xi = still_course(), np.inf
    if a.spin != 0.0 and (a.turn == a.spin or a.speed == 0.0):
        # After a full turn all repeats.
        horizon = min(horizon, 2.0 * math.pi / abs(a.spin) * (1.0 + 1e-6))
    x, y, radius = reached_disc(a, horizon)
    leaf = leaf_after(tree, 0, x, y, radius)
    while leaf:
        first = (leaf - tree.leaves) * LEAF
        for k in range(first, min(first + LEAF, len(tree.part))):
            part = tree.part[k]
            w0, w1 = w_start[part], w_start[part + 1]
            if clear_of_part(a, W, w0, w1, min(xi, horizon)) or not is_seen(sight, part):
                continue
            for q in range(first_q, last_q):
                until = min(xi, horizon)
                time = part_time(W, w0, w1, still, Q, q_start[q], q_start[q + 1], a, until)
                if time < xi:
                    xi = time
                    x, y, radius = reached_disc(a, min(xi, horizon))
        leaf = leaf_after(tree, leaf, x, y, radius)
    return xi
