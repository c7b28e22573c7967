"""The pymunk space: robots and what they push as dynamic bodies, movers as kinematic ones, walls as
shapes of the static body.

`BodyArrays` reads and writes poses and velocities of all robots as arrays, by the functions behind
`pymunk.batch`. Bodies are listed in the order in which they were added; the space's static body
closes the list.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib
from pymunk.batch import BodyFields, Buffer

from physim.geometry.polygon import moment
from physim.geometry.shapes import FloatArray, Shapes, body_parts
from physim.tolerances import CONTACT

SLOP = 1e-3
"""[m] Overlap that the engine leaves in place (its default is 0.1 m)."""

RADIUS = CONTACT
"""[m] Skin of every shape. Shapes touch at CONTACT; two skins are twice that, so that the engine
reports every pair that may touch and the exact check alone decides."""

CELL = 3.0
"""[-] Side of a cell of the spatial hash, in lengths of the longest robot. Cells of one length made
the engine's step slower by a half, of four lengths no faster but where robots are far apart."""

BINS = 10
"""Bins of the spatial hash for each part of a robot."""

LEAST_BINS = 100
"""Bins of the spatial hash at least: a few robots among many walls."""

MOST_WALL_CELLS = 1_000_000
"""A wall is entered into every cell of its bounding box. Cells are larger where walls would fill
more than this, as a wall of kilometres drawn diagonally does."""


NEVER_AMONG_THEMSELVES = pymunk.ShapeFilter(group=1)
"""Movers and walls: what neither gives way has no contacts"""


class Hosted(NamedTuple):
    """A space and its shapes, numbered like the parts of robots and then of walls."""

    space: pymunk.Space
    bodies: list[pymunk.Body]
    """of all that moves"""
    parts: list[pymunk.Shape]
    """one shape a part"""


def build_space(
    shapes: Shapes,
    walls: Shapes,
    start: FloatArray,
    mass: FloatArray,
    friction: float,
    elasticity: float,
) -> Hosted:
    """Set up the engine as measured to be right for commanded robots: no gravity, no damping.

    With the spatial hash the engine finds the pairs that touch in an order that depends on the
    present poses and the order of insertion alone; with its default, a tree, on the past too.
    """
    space = pymunk.Space()
    space.use_spatial_hash(cell_side(shapes, walls), max(LEAST_BINS, BINS * shapes.body_start[-1]))
    space.gravity = (0.0, 0.0)
    space.damping = 1.0
    space.collision_slop = SLOP
    space.collision_persistence = 1
    bodies, parts = [], []
    for robot, (x, y, heading) in enumerate(start.tolist()):
        # Origin and centre of gravity are the reference point, so that a commanded twist, which
        # is that point's, is the body's velocity.
        own, m = body_parts(shapes, robot), float(mass[robot])
        if m < np.inf:
            body = pymunk.Body(m, moment(own, m))
        else:
            body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        body.position, body.angle = (x, y), heading
        polygons = [_solid(body, part) for part in own]
        space.add(body, *polygons)
        bodies.append(body)
        parts += polygons
        for shape in polygons if m == np.inf else ():
            shape.filter = NEVER_AMONG_THEMSELVES
    for wall in range(len(walls.body_start) - 1):
        solids = [_solid(space.static_body, part) for part in body_parts(walls, wall)]
        for shape in solids if np.isinf(mass).any() else ():
            shape.filter = NEVER_AMONG_THEMSELVES
        space.add(*solids)
        parts += solids
    for shape in parts:
        # The engine multiplies the values of two shapes.
        shape.friction = float(np.sqrt(friction))
        shape.elasticity = float(np.sqrt(elasticity))
    return Hosted(space, bodies, parts)


def _solid(body: pymunk.Body, part: FloatArray) -> pymunk.Shape:
    """A polygon, or a segment: it does not know its neighbours, see the module of verdicts."""
    if len(part) == 2:
        return pymunk.Segment(body, tuple(part[0]), tuple(part[1]), RADIUS)
    return pymunk.Poly(body, part.tolist(), radius=RADIUS)


def cell_side(shapes: Shapes, walls: Shapes) -> float:
    """Side [m] of the cells of the spatial hash, for robots and walls."""
    side = CELL * 2.0 * float(shapes.radius.max())
    if not len(walls.vertices):
        return side
    first = walls.part_start[:-1]
    low, high = (pick.reduceat(walls.vertices, first) for pick in (np.minimum, np.maximum))
    while np.prod(np.floor((high - low) / side) + 2.0, axis=1).sum() > MOST_WALL_CELLS:
        side *= 2.0
    return side


_POSE = BodyFields.POSITION | BodyFields.ANGLE
_VELOCITY = BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
_DRIVE = _VELOCITY | BodyFields.FORCE | BodyFields.TORQUE


class BodyArrays:
    """Reads and writes the N bodies of a space that move; the arrays are shared with the engine.

    Fill ``pose``, ``velocity`` or ``drive`` and call the method of that name to pass it on.
    """

    def __init__(self, space: pymunk.Space, robots: int) -> None:
        """Attach to a space that has ``robots`` bodies that move."""
        self.pose, self.read_pose, self.write_pose = _shared(space, robots, 3, _POSE)
        """(N, 3) x, y [m], heading [rad, unwrapped], as last read or to be written"""
        self.velocity, self.read_velocity, self.write_velocity = _shared(
            space, robots, 3, _VELOCITY
        )
        """(N, 3) vx, vy [m/s], omega [rad/s], as last read or to be written"""
        self.drive, _, self.write_drive = _shared(space, robots, 6, _DRIVE)
        """(N, 6) vx, vy, omega, fx, fy [N], torque [N m], to be written; the engine forgets forces
        after a step"""


def _shared(
    space: pymunk.Space, robots: int, columns: int, fields: BodyFields
) -> tuple[FloatArray, Callable[[], None], Callable[[], None]]:
    """Rows (N, columns) of the robots' fields, and what reads and what writes them.

    What pymunk.batch does at each call is made ready once.
    """
    # The static body is listed too. And one spare row: the engine must never find the array full,
    # or it would reallocate it.
    array = np.zeros((robots + 2, columns))
    buffer = Buffer()
    buffer.set_float_buf(array)
    numbers = buffer._float_arr
    data = ffi.new("pmBatchedData *")
    data.fields, data.floatArray, data.intArray = fields.value, numbers, buffer._int_arr

    def caller(name: str) -> Callable[[], None]:
        each, handle, function = lib.cpSpaceEachBody, space._space, ffi.addressof(lib, name)

        def call() -> None:
            numbers.num = 0  # where the engine reads or writes next
            each(handle, function, data)

        call.buffer = buffer  # type: ignore[attr-defined]
        return call

    get, put = "pmSpaceBodyGetIteratorFuncBatched", "pmSpaceBodySetIteratorFuncBatched"
    return array[:robots], caller(get), caller(put)
