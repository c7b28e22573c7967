"""Contacts as the compiled callbacks of the guard see them: a table of addresses, and what is asked
of the engine by it, and told."""

from __future__ import annotations

import numpy as np

from physim.c_calls import array_at, call, pointer
from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.simulation.engine.verdict import Links, deepest_point, is_misled, meeting

# Places in the table of numbers and addresses that the callbacks get.
REPORTED, REJECTED = 0, 1
PARTS, VERTICES, BODIES = 2, 3, 4
"""how many"""
SHAPES_OF, PROCESS, GET_BODY, GET_ARBITER, SET_POINTS, APPEND = 5, 6, 7, 8, 9, 10
"""functions of the engine"""
VERTEX, PART_START, BODY_START, RADIUS, LINK_PART, LINK_END, LINK_OWN = 11, 12, 13, 14, 15, 16, 17
"""arrays of `Shapes` and `Links`"""
HANDLES, PART_OF_HANDLE, BODY_OF_PART = 18, 19, 20
"""the engine's pointers to shapes, sorted, the part of each, and pointers to the bodies of parts"""
BODY_FIELDS, IMPULSE_FIELDS, POINT_FIELDS = 21, 22, 23
"""what the engine is asked for"""
FLOATS, FLOAT_COUNT, INTS, INT_COUNT = 24, 25, 26, 27
"""where it writes the answer"""
POINTS, FOUND, KEPT_OUT, SCRATCH = 28, 29, 30, 31
SLOTS = 32


@compiled
def shapes_at(table: IntArray) -> Shapes:
    """Robots and walls in one numbering."""
    parts, bodies = table[PARTS], table[BODIES]
    return Shapes(
        array_at(pointer(table[VERTEX]), (table[VERTICES], 2), np.float64),
        array_at(pointer(table[PART_START]), (parts + 1,), np.int64),
        array_at(pointer(table[BODY_START]), (bodies + 1,), np.int64),
        array_at(pointer(table[RADIUS]), (bodies,), np.float64),
    )


@compiled
def links_at(table: IntArray) -> Links:
    """What meets the ends of parts."""
    shape = (table[PARTS], 2)
    return Links(
        array_at(pointer(table[LINK_PART]), shape, np.int64),
        array_at(pointer(table[LINK_END]), shape, np.int64),
        array_at(pointer(table[LINK_OWN]), shape, np.bool_),
    )


@compiled
def asked(table: IntArray, function: int, what: int, fields: int) -> FloatArray:
    """What the engine says of a body or a contact: the numbers (8,); whole ones lie at INTS."""
    array_at(pointer(table[FLOAT_COUNT]), (1,), np.int32)[0] = 0
    array_at(pointer(table[INT_COUNT]), (1,), np.int32)[0] = 0
    call(table[function], (what, table[fields]))
    found: FloatArray = array_at(pointer(table[FLOATS]), (8,), np.float64)
    return found


@compiled
def set_right(
    table: IntArray,
    shapes: Shapes,
    arbiter: int,
    swapped: bool,
    p: int,
    pose_p: FloatArray,
    q: int,
    pose_q: FloatArray,
) -> None:
    """`PlainGuard._set_right`; ``swapped``: the engine has q before p."""
    found = asked(table, GET_ARBITER, arbiter, POINT_FIELDS)
    if not is_misled(shapes, p, pose_p, q, pose_q, found[2] - found[0], found[3] - found[1]):
        return
    nx, ny, px, py, qx, qy = meeting(shapes, p, pose_p, q, pose_q)
    if swapped:
        put(table, arbiter, nx, ny, qx, qy, px, py)
    else:
        put(table, arbiter, -nx, -ny, px, py, qx, qy)


@compiled
def turn(
    table: IntArray,
    shapes: Shapes,
    links: Links,
    arbiter: int,
    swapped: bool,
    p: int,
    pose_p: FloatArray,
    q: int,
    nx: float,
    ny: float,
) -> None:
    """Turn a contact to the normal (nx, ny) of segment q, with its point where p is deepest.

    ``swapped``: the engine has q before p.
    """
    found = asked(table, GET_ARBITER, arbiter, POINT_FIELDS)
    sign = 1.0 if swapped else -1.0
    ax, ay, bx, by = found[0], found[1], found[2], found[3]
    beyond, x, y, foot_x, foot_y = deepest_point(shapes, links, p, pose_p, q, nx, ny)
    if beyond:
        ax, ay, bx, by = (foot_x, foot_y, x, y) if swapped else (x, y, foot_x, foot_y)
    put(table, arbiter, sign * nx, sign * ny, ax, ay, bx, by)


@compiled
def put(
    table: IntArray,
    arbiter: int,
    nx: float,
    ny: float,
    ax: float,
    ay: float,
    bx: float,
    by: float,
) -> None:
    """Give a contact a normal and, for all that it has, one point of either part; the engine was
    last `asked` for the points that it has."""
    points = array_at(pointer(table[POINTS]), (13,), np.float64)
    count = array_at(pointer(table[INTS]), (1,), np.int64)[0]
    array_at(pointer(table[POINTS]), (1,), np.int32)[0] = count
    points[1], points[2] = nx, ny
    for k in (3, 8):
        points[k], points[k + 1], points[k + 2], points[k + 3] = ax, ay, bx, by
    call(table[SET_POINTS], (arbiter, table[POINTS]))
