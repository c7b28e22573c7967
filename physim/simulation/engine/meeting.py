"""Where do two parts that touch meet, if the engine says it wrong?

Where an edge lies on one line with another, to 1e-16 m, pymunk takes it for overlap all along the
edge, and pushes the parts apart sideways, or takes a normal askew: boxes that one pushed straight
on with its whole face were 1 m deep in each other, and sprang 19 mm and 3 degrees in a step. Or it
finds a point at one end of the faces alone, where they part by a nanometre at the other, and turns
the boxes about it for a whole step, one in a row of four by 12 mrad. Such a contact is put in the
middle of what the two faces have in common, along their own normal.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, Shapes
from physim.simulation.engine.verdict import touch

MISLED = 1e-3
"""[m] The engine takes parts to be this much deeper in each other than they are: what it eases is
of that order (`space.SLOP`), what it is misled by are lengths of edges"""
SKINS = 1e-6
"""[m] Up to here parts are in each other by little more than their skins (`space.RADIUS`)"""
ASKEW = 1e-6
"""[rad] of the engine's normal to that of the parts, about"""
FACE = 1e-6
"""[m] Corners of a part that lie this near to the farthest one belong to the same face"""


@compiled
def is_misled(
    shapes: Shapes,
    p: int,
    pose_p: FloatArray,
    q: int,
    pose_q: FloatArray,
    points: int,
    dx: float,
    dy: float,
) -> bool:
    """Whether the engine is wrong about parts that touch, at so many ``points``; (dx, dy) [m] lead
    from its first point of one to that of the other."""
    reported = np.hypot(dx, dy)
    if SKINS < reported <= MISLED:
        return False
    distance, nx, ny = touch(shapes, p, pose_p, q, pose_q)
    if reported > MISLED:
        return bool(reported > MISLED - distance)
    if distance <= -SKINS:
        return False
    if abs(dx * ny - dy * nx) > ASKEW * reported:
        return True
    return points == 1 and _in_common(shapes, p, pose_p, q, pose_q, nx, ny)[1] > 0.0


@compiled
def meeting(
    shapes: Shapes, p: int, pose_p: FloatArray, q: int, pose_q: FloatArray
) -> tuple[float, float, float, float, float, float]:
    """Where two parts that touch meet: the unit normal (world frame) from q to p, and a point of
    each, on one line along it: in the middle of what their faces have in common."""
    _, nx, ny = touch(shapes, p, pose_p, q, pose_q)
    along, _, height_p, height_q = _in_common(shapes, p, pose_p, q, pose_q, nx, ny)
    tx, ty = -ny, nx
    px, py = along * tx - height_p * nx, along * ty - height_p * ny
    return nx, ny, px, py, along * tx + height_q * nx, along * ty + height_q * ny


@compiled
def _in_common(
    shapes: Shapes, p: int, pose_p: FloatArray, q: int, pose_q: FloatArray, nx: float, ny: float
) -> tuple[float, float, float, float]:
    """Middle and length [m] of what the faces of two parts have in common, along the tangent of
    q's (left of the normal); and how far each lies along its own normal."""
    low_p, high_p, height_p = _face(shapes, p, pose_p, -nx, -ny)
    low_q, high_q, height_q = _face(shapes, q, pose_q, nx, ny)
    first, last = max(-high_p, low_q), min(-low_p, high_q)  # p's tangent goes against q's
    return 0.5 * (first + last), last - first, height_p, height_q


@compiled
def _face(
    shapes: Shapes, part: int, pose: FloatArray, nx: float, ny: float
) -> tuple[float, float, float]:
    """Ends of the face of a part that lies farthest in a direction, along its tangent (left of
    it), and how far it lies [m]; of a corner both ends are the corner."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    first, last = shapes.part_start[part], shapes.part_start[part + 1]
    height = -np.inf
    for k in range(first, last):
        x = pose[0] + c * shapes.vertices[k, 0] - s * shapes.vertices[k, 1]
        y = pose[1] + s * shapes.vertices[k, 0] + c * shapes.vertices[k, 1]
        height = max(height, nx * x + ny * y)
    low, high = np.inf, -np.inf
    for k in range(first, last):
        x = pose[0] + c * shapes.vertices[k, 0] - s * shapes.vertices[k, 1]
        y = pose[1] + s * shapes.vertices[k, 0] + c * shapes.vertices[k, 1]
        if nx * x + ny * y >= height - FACE:
            low, high = min(low, nx * y - ny * x), max(high, nx * y - ny * x)
    return low, high, height
