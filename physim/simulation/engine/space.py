"""The pymunk space, with robots as dynamic bodies and walls as shapes of the static body.

`BodyArrays` reads and writes poses and velocities of all robots as arrays: the one user of
`pymunk.batch`, which pymunk marks experimental, and of the members behind it. Bodies are listed in
the order in which they were added, dynamic ones first; the space's static body closes the list.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pymunk
from pymunk.batch import BodyFields, Buffer, get_space_bodies, set_space_bodies

from physim.geometry.polygon import moment
from physim.geometry.shapes import FloatArray, Shapes, body_parts
from physim.tolerances import CONTACT

SLOP = 1e-3
"""[m] Overlap that the engine leaves in place (its default is 0.1 m)."""

LEAST_ROUNDS, MOST_ROUNDS = 20, 400
"""Rounds of the contact solver per step. Each mends one contact after the other, so a push needs
the more of them the more robots it goes through, and the lighter they are than who pushes."""

ALL_ROUNDS = 2_500
"""Rounds times the square of the pairs that touch, where not at one of these bounds. Rows of up to
six robots go straight by it; more rounds in crowds would cost more than all else of a step."""

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


class Hosted(NamedTuple):
    """A space and its shapes, numbered like the parts of robots and then of walls."""

    space: pymunk.Space
    bodies: list[pymunk.Body]
    """of the N robots"""
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
    for robot, pose in enumerate(start):
        body = _robot_body(shapes, robot, pose, float(mass[robot]))
        polygons: list[pymunk.Shape] = [
            pymunk.Poly(body, part.tolist(), radius=RADIUS) for part in body_parts(shapes, robot)
        ]
        space.add(body, *polygons)
        bodies.append(body)
        parts += polygons
    for wall in range(len(walls.body_start) - 1):
        solids = _wall_shapes(space.static_body, body_parts(walls, wall))
        space.add(*solids)
        parts += solids
    for shape in parts:
        # The engine multiplies the values of two shapes.
        shape.friction = float(np.sqrt(friction))
        shape.elasticity = float(np.sqrt(elasticity))
    return Hosted(space, bodies, parts)


def rounds(pairs: int) -> int:
    """Rounds of the contact solver where so many pairs touch."""
    return max(LEAST_ROUNDS, min(MOST_ROUNDS, ALL_ROUNDS // max(1, pairs * pairs)))


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


def parking(shapes: Shapes, walls: Shapes) -> FloatArray:
    """Poses (N, 3) for all robots far from the walls and from each other, above and in a row."""
    room = 4.0 * float(shapes.radius.max())
    pose = np.zeros((len(shapes.radius), 3))
    pose[:, 0] = room * np.arange(len(pose))
    pose[:, 1] = room + walls.vertices[:, 1].max(initial=0.0)
    return pose


def _robot_body(shapes: Shapes, robot: int, pose: FloatArray, mass: float) -> pymunk.Body:
    # Origin and centre of gravity are the reference point, so that a commanded twist, which is
    # that point's, is the body's velocity.
    body = pymunk.Body(mass, moment(body_parts(shapes, robot), mass))
    body.position = (float(pose[0]), float(pose[1]))
    body.angle = float(pose[2])
    return body


def _wall_shapes(static: pymunk.Body, parts: list[FloatArray]) -> list[pymunk.Shape]:
    # Segments do not know their neighbours: see physim.simulation.engine.verdict.
    made: list[pymunk.Shape] = []
    for part in parts:
        if len(part) == 2:
            made.append(pymunk.Segment(static, tuple(part[0]), tuple(part[1]), RADIUS))
        else:
            made.append(pymunk.Poly(static, part.tolist(), radius=RADIUS))
    return made


_POSE = BodyFields.POSITION | BodyFields.ANGLE
_VELOCITY = BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
_DRIVE = _VELOCITY | BodyFields.FORCE | BodyFields.TORQUE


class BodyArrays:
    """Reads and writes the N robots of a space; the arrays are shared with the engine.

    Fill ``pose``, ``velocity`` or ``drive`` and call the method of that name to pass it on.
    """

    def __init__(self, space: pymunk.Space, robots: int) -> None:
        """Attach to a space that has ``robots`` dynamic bodies."""
        rows = robots + 1  # the static body is listed too
        pose, pose_buffer = _shared(rows, 3)
        velocity, velocity_buffer = _shared(rows, 3)
        drive, drive_buffer = _shared(rows, 6)
        self.pose: FloatArray = pose[:robots]
        """(N, 3) x, y [m], heading [rad, unwrapped], as last read or to be written"""
        self.velocity: FloatArray = velocity[:robots]
        """(N, 3) vx, vy [m/s], omega [rad/s], as last read or to be written"""
        self.drive: FloatArray = drive[:robots]
        """(N, 6) vx, vy, omega, fx, fy [N], torque [N m], to be written"""
        self.read_pose = reader(space, _POSE, pose_buffer)
        """Fill ``pose``."""
        self.write_pose = writer(space, _POSE, pose_buffer)
        """Put every robot at its row of ``pose``."""
        self.read_velocity = reader(space, _VELOCITY, velocity_buffer)
        """Fill ``velocity``."""
        self.write_velocity = writer(space, _VELOCITY, velocity_buffer)
        """Give every robot its row of ``velocity``."""
        self.write_drive = writer(space, _DRIVE, drive_buffer)
        """Give every robot its row of ``drive``; the engine forgets forces after a step."""


def _shared(rows: int, columns: int) -> tuple[FloatArray, Buffer]:
    # One spare row: the engine must never find the array full, or it would reallocate it.
    array = np.zeros((rows + 1, columns))
    buffer = Buffer()
    buffer.set_float_buf(array)
    return array, buffer


def reader(space: pymunk.Space, fields: BodyFields, buffer: Buffer) -> Callable[[], None]:
    """Return what fills a buffer from all bodies."""
    quick = _each_body(space, fields, buffer, "pmSpaceBodyGetIteratorFuncBatched")
    if quick is not None:
        return quick

    def read() -> None:
        buffer.clear()
        get_space_bodies(space, fields, buffer)

    return read


def writer(space: pymunk.Space, fields: BodyFields, buffer: Buffer) -> Callable[[], None]:
    """Return what gives all bodies what is in a buffer."""
    quick = _each_body(space, fields, buffer, "pmSpaceBodySetIteratorFuncBatched")
    return quick or functools.partial(set_space_bodies, space, fields, buffer)


def _each_body(
    space: pymunk.Space, fields: BodyFields, buffer: Buffer, name: str
) -> Callable[[], None] | None:
    """What pymunk.batch does at each call, made ready once; None where its members are others."""
    try:
        from pymunk._chipmunk_cffi import ffi, lib

        numbers = buffer._float_arr
        data = ffi.new("pmBatchedData *")
        data.fields, data.floatArray, data.intArray = fields.value, numbers, buffer._int_arr
        each, handle, function = lib.cpSpaceEachBody, space._space, ffi.addressof(lib, name)
    except Exception:  # whatever a missing or changed private member brings about
        return None

    def call() -> None:
        numbers.num = 0  # where the engine reads or writes next
        each(handle, function, data)

    return call


def stepper(space: pymunk.Space, dt: float) -> Callable[[], None]:
    """Return what makes a step of the engine.

    Past pymunk's own bookkeeping, which serves callbacks that add and remove bodies.
    """
    try:
        from pymunk._chipmunk_cffi import lib

        return functools.partial(lib.cpSpaceStep, space._space, dt)
    except (ImportError, AttributeError):
        return functools.partial(space.step, dt)
