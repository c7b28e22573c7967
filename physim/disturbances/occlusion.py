"""Occlusion: robots do not see what stands behind walls, obstacles and other bodies."""

from __future__ import annotations

from math import cos, isnan, sin
from typing import NamedTuple

import numpy as np

from physim.compiled import compiled
from physim.disturbances.rows import Rows, Stage
from physim.geometry.shapes import Flags, FloatArray, IntArray, Part, Rows3, Shapes
from physim.geometry.walls import LEAF, WallTree, leaf_after
from physim.world.scene import Scene

LEAST = 1e-9
"""[-] share of a line that must run inside a body to end there: touching a corner hides nothing"""
MARGIN = 1e-6
"""[m] by which bodies that may lie in between are taken to be larger"""


class Occlusion(Stage):
    """Hides robots of which nothing is seen past walls, obstacles and other bodies.

    A robot is seen where the straight line from the observer's reference point to its own, or to
    one of its corners, meets no wall and no third body.
    """

    def hide(self, scene: Scene, step: int, rows: Rows, out: Flags) -> None:
        """Write which rows (M,) are about what stands behind something, by where all really are."""
        put_hidden(scene.wall_tree, scene.shapes, scene.moving, rows, out)


class Line(NamedTuple):
    """A straight line from one point to another."""

    px: float
    py: float
    qx: float
    qy: float


@compiled
def put_hidden(tree: WallTree, shapes: Shapes, bodies: int, rows: Rows, out: Flags) -> None:
    """Write of which bodies in sight nothing is seen past others."""
    V, pose, radius = shapes.vertices, rows.truth, shapes.radius
    near, between = np.empty(bodies, np.int64), np.empty(bodies, np.int64)
    for i in range(rows.observers):
        x, y, reach, many = pose[i, 0], pose[i, 1], 0.0, 0
        for row in range(rows.first[i], rows.end[i]):
            j = rows.robot[row]
            far = np.hypot(pose[j, 0] - x, pose[j, 1] - y) + radius[j]
            if far > reach and not isnan(rows.seen[row, 0]):
                reach = far
        for k in range(bodies):
            ox, oy, wide = pose[k, 0] - x, pose[k, 1] - y, reach + radius[k] + MARGIN
            if k != i and ox * ox + oy * oy < wide * wide:
                near[many] = k
                many += 1
        for row in range(rows.first[i], rows.end[i]):
            j, count, out[row] = rows.robot[row], 0, False
            if i == j or isnan(rows.seen[row, 0]):
                continue
            dx, dy = pose[j, 0] - x, pose[j, 1] - y
            far = np.sqrt(dx * dx + dy * dy)
            for m in range(many):  # those that lie near the way to it
                k = near[m]
                ox, oy, wide = pose[k, 0] - x, pose[k, 1] - y, radius[k] + radius[j] + MARGIN
                if k != j and abs(dx * oy - dy * ox) <= wide * far:
                    between[count] = k
                    count += 1
            line = Line(x, y, pose[j, 0], pose[j, 1])
            hidden = is_blocked(line, tree, shapes, pose, between, count)
            if hidden:
                c, s = cos(pose[j, 2]), sin(pose[j, 2])
                first, end = shapes.body_start[j], shapes.body_start[j + 1]
                for k in range(shapes.part_start[first], shapes.part_start[end]):
                    qx = pose[j, 0] + c * V[k, 0] - s * V[k, 1]
                    qy = pose[j, 1] + s * V[k, 0] + c * V[k, 1]
                    line = Line(x, y, qx, qy)
                    if not is_blocked(line, tree, shapes, pose, between, count):
                        hidden = False
                        break
            out[row] = hidden


@compiled
def is_blocked(
    line: Line, tree: WallTree, shapes: Shapes, pose: Rows3, between: IntArray, many: int
) -> bool:
    """Whether a line meets a wall, or one of so many bodies ``between``."""
    for m in range(many):
        k = between[m]
        c, s = cos(pose[k, 2]), sin(pose[k, 2])
        px, py = line.px - pose[k, 0], line.py - pose[k, 1]
        qx, qy = line.qx - pose[k, 0], line.qy - pose[k, 1]
        own = Line(c * px + s * py, c * py - s * px, c * qx + s * qy, c * qy - s * qx)
        for part in range(shapes.body_start[k], shapes.body_start[k + 1]):
            one = Part(shapes.vertices, shapes.part_start[part], shapes.part_start[part + 1])
            if meets(own, one):
                return True
    x, y = 0.5 * (line.px + line.qx), 0.5 * (line.py + line.qy)
    reach = np.hypot(line.qx - x, line.qy - y)
    W, start = tree.walls.vertices, tree.walls.part_start
    leaf = leaf_after(tree, 0, x, y, reach)
    while leaf:
        begin = (leaf - tree.leaves) * LEAF
        for k in range(begin, min(begin + LEAF, tree.parts)):
            part = tree.part[k]
            if meets(line, Part(W, start[part], start[part + 1])):
                return True
        leaf = leaf_after(tree, leaf, x, y, reach)
    return False


@compiled
def meets(line: Line, part: Part) -> bool:
    """Whether a line crosses a segment, or runs inside a convex part."""
    V, a = part.vertices, part.end - 1
    if part.end - part.first == 2:
        p = beside(V[part.first], V[a], line.px, line.py)
        q = beside(V[part.first], V[a], line.qx, line.qy)
        ex, ey = line.qx - line.px, line.qy - line.py
        u = ex * (V[a, 1] - line.py) - ey * (V[a, 0] - line.px)
        v = ex * (V[part.first, 1] - line.py) - ey * (V[part.first, 0] - line.px)
        return p * q < 0.0 and u * v <= 0.0
    low, high = 0.0, 1.0
    for b in range(part.first, part.end):
        p = beside(V[a], V[b], line.px, line.py)
        q = beside(V[a], V[b], line.qx, line.qy)
        if p <= 0.0 and q <= 0.0:
            return False
        if p < 0.0:
            low = max(low, p / (p - q))
        elif q < 0.0:
            high = min(high, p / (p - q))
        a = b
    return high - low > LEAST


@compiled
def beside(a: FloatArray, b: FloatArray, x: float, y: float) -> float:
    """Twice the area of the triangle a, b, (x, y): positive where that is to the left of a to b."""
    return float((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]))
