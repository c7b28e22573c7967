"""The guard that keeps the engine's false contacts out, as compiled callbacks of its step.

pymunk now and then reports a contact more than a metre deep between polygons that are apart and
have edges on one line. So each contact it reports is judged by the exact separation of the parts
(`physim.simulation.engine.verdict`): what is apart is not processed, not noted, only told. And
where the engine errs about where parts meet (`physim.simulation.engine.meeting`) it is set right.

Nothing is read at offsets of our own: poses, impulses and points of contact come by the functions
behind `pymunk.batch`, which append them to arrays, and all that the callbacks need lies at
addresses in one table. Parts are known by the engine's own pointers to their shapes.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import ffi, lib
from pymunk.batch import ArbiterFields, BodyFields

from physim.c_calls import array_at, call, pointer
from physim.compiled import callback, compiled
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.simulation.engine.meeting import is_misled, meeting
from physim.simulation.engine.space import Hosted
from physim.simulation.engine.verdict import (
    APART,
    LEFT,
    SIDE,
    Links,
    classify,
    deepest_point,
    segment_links,
)

# Places in the table of numbers and addresses that the callbacks get.
REPORTED, CHECKS = 0, 1
"""contacts since the last `Guard.take`; whether contacts are judged at all"""
PARTS, VERTICES, BODIES = 2, 3, 4
"""how many"""
SHAPES_OF, PROCESS, GET_BODY, GET_ARBITER, SET_POINTS, APPEND = 5, 6, 7, 8, 9, 10
"""functions of the engine"""
VERTEX, PART_START, BODY_START, RADIUS, LINK_PART, LINK_END = 11, 12, 13, 14, 15, 16
"""arrays of `Shapes` and `Links`"""
HANDLES, PART_OF_HANDLE, BODY_OF_PART = 17, 18, 19
"""the engine's pointers to shapes, sorted, the part of each, and pointers to the bodies of parts"""
BODY_FIELDS, IMPULSE_FIELDS, POINT_FIELDS = 20, 21, 22
"""what the engine is asked for"""
FLOATS, FLOAT_COUNT, INTS, INT_COUNT = 23, 24, 25, 26
"""where it writes the answer"""
POINTS, FOUND, KEPT_OUT, SCRATCH = 27, 28, 29, 30
SLOTS = 31


class Touches(NamedTuple):
    """True contacts of parts in one solve, in the order in which the engine met them."""

    part: IntArray
    """(M, 2) part numbers"""
    impulse: FloatArray
    """(M,) [N s] magnitude"""


NOTHING = Touches(np.zeros((0, 2), dtype=np.int64), np.zeros(0))


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
    )


@compiled
def parts_of(table: IntArray, arbiter: int) -> tuple[int, int]:
    """Part numbers of a contact, in the engine's order."""
    scratch = array_at(pointer(table[SCRATCH]), (2,), np.int64)
    call(table[SHAPES_OF], (arbiter, table[SCRATCH], table[SCRATCH] + 8))
    handles = array_at(pointer(table[HANDLES]), (table[PARTS],), np.int64)
    parts = array_at(pointer(table[PART_OF_HANDLE]), (table[PARTS],), np.int64)
    return part_of(handles, parts, scratch[0]), part_of(handles, parts, scratch[1])


@compiled
def part_of(handles: IntArray, parts: IntArray, handle: int) -> int:
    """Part whose shape has a pointer, which is one of ``handles``, sorted."""
    low, high = 0, len(handles) - 1
    while low < high:
        middle = (low + high) // 2
        if handles[middle] < handle:
            low = middle + 1
        else:
            high = middle
    return int(parts[low])


@compiled
def asked(table: IntArray, function: int, what: int, fields: int) -> FloatArray:
    """What the engine says of a body or a contact: the numbers (8,); whole ones lie at INTS."""
    array_at(pointer(table[FLOAT_COUNT]), (1,), np.int32)[0] = 0
    array_at(pointer(table[INT_COUNT]), (1,), np.int32)[0] = 0
    call(table[function], (what, table[fields]))
    found: FloatArray = array_at(pointer(table[FLOATS]), (8,), np.float64)
    return found


@compiled
def pose_of(table: IntArray, part: int, out: FloatArray) -> None:
    """Write the pose (3,) of the body of a part."""
    bodies = array_at(pointer(table[BODY_OF_PART]), (table[PARTS],), np.int64)
    found = asked(table, GET_BODY, bodies[part], BODY_FIELDS)
    out[0], out[1], out[2] = found[0], found[1], found[2]


@callback(3)
def judge(arbiter: int, space: int, data: int) -> None:
    """Let a contact act, or keep it out; the engine calls this before it solves."""
    table = array_at(pointer(data), (SLOTS,), np.int64)
    table[REPORTED] += 1
    if not table[CHECKS]:
        return
    one, other = parts_of(table, arbiter)
    p, q = min(one, other), max(one, other)
    pose_p, pose_q = np.empty(3), np.empty(3)
    pose_of(table, p, pose_p)
    pose_of(table, q, pose_q)
    shapes, links = shapes_at(table), links_at(table)
    verdict, nx, ny = classify(shapes, links, p, pose_p, q, pose_q)
    acts = verdict not in (APART, LEFT)
    call(table[PROCESS], (arbiter, np.int64(acts)))
    if verdict == APART:
        call(table[APPEND], (table[KEPT_OUT], np.int64(one)))
        call(table[APPEND], (table[KEPT_OUT], np.int64(other)))
    elif verdict == SIDE:
        turn(table, shapes, links, arbiter, one == q, p, pose_p, q, nx, ny)
    elif acts:
        set_right(table, shapes, arbiter, one == q, p, pose_p, q, pose_q)


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
    """Put a contact of which the engine is misled where the parts p and q meet.

    ``swapped``: the engine has q before p.
    """
    found = asked(table, GET_ARBITER, arbiter, POINT_FIELDS)
    points = array_at(pointer(table[INTS]), (1,), np.int64)[0]
    dx, dy = found[2] - found[0], found[3] - found[1]
    if not is_misled(shapes, p, pose_p, q, pose_q, points, dx, dy):
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

    The engine's points are those of its own normal: turned to the segment's they would show an
    overlap of millimetres where the part is half a metre beyond. ``swapped``: the engine has q
    before p.
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


@callback(3)
def note(arbiter: int, space: int, data: int) -> None:
    """Take down a contact that acted; the engine calls this when it has solved."""
    table = array_at(pointer(data), (SLOTS,), np.int64)
    one, other = parts_of(table, arbiter)
    found = asked(table, GET_ARBITER, arbiter, IMPULSE_FIELDS)
    # As Python's x**2 does it. The exponent comes from memory: as a constant the compiler would
    # make a product of it, which now and then is another number.
    scratch = array_at(pointer(table[SCRATCH]), (4,), np.float64)
    size = math.sqrt(math.pow(found[0], scratch[2]) + math.pow(found[1], scratch[2]))
    scratch[3] = size
    bits = array_at(pointer(table[SCRATCH]), (4,), np.int64)[3]
    call(table[APPEND], (table[FOUND], np.int64(one)))
    call(table[APPEND], (table[FOUND], np.int64(other)))
    call(table[APPEND], (table[FOUND], bits))


class Pile:
    """Numbers that callbacks append, in an array of the engine's library that grows as needed."""

    def __init__(self, columns: int) -> None:
        self._array = ffi.gc(lib.pmIntArrayNew(64 * columns), lib.pmIntArrayFree)
        self._columns = columns
        self.address = address(self._array)

    def take(self) -> IntArray | None:
        """Return the rows since the last call, a copy; None where there are none."""
        count = self._array.num
        if not count:
            return None
        self._array.num = 0
        memory = ffi.buffer(self._array.arr, 8 * count)
        return np.frombuffer(memory, np.int64).reshape(-1, self._columns).copy()


def address(pointed: Any) -> int:
    """Number of a pointer of the engine's library."""
    return int(ffi.cast("intptr_t", pointed))


class Guard:
    """Judges every contact of a space.

    ``reported`` counts the contacts of parts, true and false, that the engine reported between the
    last two calls of `take`: as many as it remembers, if that was one solve.
    """

    def __init__(self, hosted: Hosted, shapes: Shapes, *, checks: bool = True) -> None:
        """Attach to the space; ``shapes`` has the parts of robots and walls in one numbering.

        Without ``checks`` every contact passes.
        """
        self.reported = 0
        self._found, self._kept_out = Pile(3), Pile(2)  # two parts, and the bits of the impulse
        self._table: IntArray = np.zeros(SLOTS, dtype=np.int64)
        self._table[CHECKS] = checks
        self._kept: list[Any] = []  # what the table points to
        self._describe(hosted, shapes)
        self._connect(hosted)

    def take(self) -> Touches:
        """Return the true contacts since the last call."""
        self.reported = self._table.item(REPORTED)
        if not self.reported:
            return NOTHING
        self._table[REPORTED] = 0
        found = self._found.take()
        if found is None:
            return NOTHING
        return Touches(found[:, :2].copy(), found[:, 2].copy().view(np.float64))

    def take_rejected(self) -> IntArray:
        """Return the parts (M, 2) of the false contacts since the last call."""
        found = self._kept_out.take()
        return NOTHING.part if found is None else found

    def _describe(self, hosted: Hosted, shapes: Shapes) -> None:
        """Enter the shapes, and which pointers of the engine are theirs."""
        table: IntArray = self._table
        table[PARTS], table[BODIES] = len(shapes.part_start) - 1, len(shapes.body_start) - 1
        table[VERTICES] = len(shapes.vertices)
        for slot, array in zip(range(VERTEX, RADIUS + 1), shapes, strict=True):
            table[slot] = self._keep(array)
        for slot, ends in zip(range(LINK_PART, LINK_END + 1), segment_links(shapes), strict=True):
            table[slot] = self._keep(ends)
        handles = np.array([address(shape._shape) for shape in hosted.parts], dtype=np.int64)
        order = np.argsort(handles)
        bodies = [address(shape.body._body) for shape in hosted.parts]  # type: ignore[union-attr]
        table[HANDLES], table[PART_OF_HANDLE] = self._keep(handles[order]), self._keep(order)
        table[BODY_OF_PART] = self._keep(np.array(bodies, dtype=np.int64))

    def _connect(self, hosted: Hosted) -> None:
        """Enter the engine's functions and the places of their answers; hand it the callbacks."""
        table = self._table
        for slot, name in (
            (SHAPES_OF, "cpArbiterGetShapes"),
            (PROCESS, "cpArbiterSetProcessCollision"),
            (GET_BODY, "pmSpaceBodyGetIteratorFuncBatched"),
            (GET_ARBITER, "pmSpaceArbiterIteratorFuncBatched"),
            (SET_POINTS, "cpArbiterSetContactPointSet"),
            (APPEND, "pmIntArrayPush"),
        ):
            table[slot] = address(ffi.addressof(lib, name))
        table[FOUND], table[KEPT_OUT] = self._found.address, self._kept_out.address
        table[SCRATCH] = self._keep(np.array((0.0, 0.0, 2.0, 0.0)))
        table[POINTS] = self._keep(np.zeros(13))
        floats, ints = lib.pmFloatArrayNew(64), lib.pmIntArrayNew(64)
        self._kept += [ffi.gc(floats, lib.pmFloatArrayFree), ffi.gc(ints, lib.pmIntArrayFree)]
        table[FLOATS], table[FLOAT_COUNT] = address(floats.arr), address(floats)
        table[INTS], table[INT_COUNT] = address(ints.arr), address(ints)
        body = BodyFields.POSITION | BodyFields.ANGLE
        points = ArbiterFields.CONTACT_COUNT | ArbiterFields.POINT_A_1 | ArbiterFields.POINT_B_1
        for slot, fields in (
            (BODY_FIELDS, body.value),
            (IMPULSE_FIELDS, ArbiterFields.TOTAL_IMPULSE.value),
            (POINT_FIELDS, points.value),
        ):
            data = ffi.new("pmBatchedData *")
            data.fields, data.floatArray, data.intArray = fields, floats, ints
            self._kept.append(data)
            table[slot] = address(data)
        hosted.space.on_collision(None, None, pre_solve=_nothing, post_solve=_nothing)
        handler = hosted.space._handlers[None, None]._handler
        handler.userData = ffi.cast("void *", self._keep(table))
        handler.preSolveFunc = ffi.cast("cpCollisionPreSolveFunc", judge.address)
        handler.postSolveFunc = ffi.cast("cpCollisionPostSolveFunc", note.address)

    def _keep(self, array: NDArray[Any]) -> int:
        """Address of an array that stays where it is as long as the guard."""
        array = np.ascontiguousarray(array)
        self._kept.append(array)
        return int(array.ctypes.data)


def _nothing(*arguments: Any) -> None:
    """A callback in Python, which the compiled one replaces."""
