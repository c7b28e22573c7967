"""The guard as compiled callbacks of the engine: what `PlainGuard` does, bit for bit, and faster.

Nothing is read at offsets of our own: poses, impulses and points of contact come by the functions
behind `pymunk.batch`, which append them to arrays, and all that the callbacks need lies at
addresses in one table. `judges_natively` tries out whether this version of the engine allows it.

Parts are known by the engine's own pointers to their shapes.
"""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import ffi, lib
from pymunk.batch import ArbiterFields, BodyFields

from physim.c_calls import array_at, call, pointer
from physim.compiled import callback, compiled
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.simulation.engine.guard import NOTHING, Touches
from physim.simulation.engine.native_contacts import (
    APPEND,
    BODIES,
    BODY_FIELDS,
    BODY_OF_PART,
    FLOAT_COUNT,
    FLOATS,
    FOUND,
    GET_ARBITER,
    GET_BODY,
    HANDLES,
    IMPULSE_FIELDS,
    INT_COUNT,
    INTS,
    KEPT_OUT,
    LINK_OWN,
    LINK_PART,
    PART_OF_HANDLE,
    PARTS,
    POINT_FIELDS,
    POINTS,
    PROCESS,
    RADIUS,
    REJECTED,
    REPORTED,
    SCRATCH,
    SET_POINTS,
    SHAPES_OF,
    SLOTS,
    VERTEX,
    VERTICES,
    asked,
    links_at,
    set_right,
    shapes_at,
    turn,
)
from physim.simulation.engine.space import Hosted
from physim.simulation.engine.verdict import (
    APART,
    LEFT,
    SIDE,
    classify,
    segment_links,
)

ROW = 3
"""Numbers of a true contact: two parts, and the bits of the impulse."""


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
def pose_of(table: IntArray, part: int, out: FloatArray) -> None:
    """Write the pose (3,) of the body of a part."""
    bodies = array_at(pointer(table[BODY_OF_PART]), (table[PARTS],), np.int64)
    found = asked(table, GET_BODY, bodies[part], BODY_FIELDS)
    out[0], out[1], out[2] = found[0], found[1], found[2]


@callback(3)
def judge(arbiter: int, space: int, data: int) -> None:
    """`PlainGuard._pre_solve` as the engine calls it."""
    table = array_at(pointer(data), (SLOTS,), np.int64)
    table[REPORTED] += 1
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
        table[REJECTED] += 1
        call(table[APPEND], (table[KEPT_OUT], np.int64(one)))
        call(table[APPEND], (table[KEPT_OUT], np.int64(other)))
    elif verdict == SIDE:
        turn(table, shapes, links, arbiter, one == q, p, pose_p, q, nx, ny)
    elif acts:
        set_right(table, shapes, arbiter, one == q, p, pose_p, q, pose_q)


@callback(3)
def note(arbiter: int, space: int, data: int) -> None:
    """`PlainGuard._post_solve` as the engine calls it."""
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
        self._seen: Any = None
        self._view: IntArray = np.zeros((0, columns), dtype=np.int64)
        self.address = address(self._array)

    def take(self) -> IntArray | None:
        """Return the rows since the last call, a copy; None where there are none."""
        count = self._array.num
        if not count:
            return None
        self._array.num = 0
        if self._array.arr != self._seen or count > self._view.size:
            self._seen = self._array.arr
            whole = self._array.max // self._columns * self._columns
            memory = ffi.buffer(self._seen, 8 * whole)
            self._view = np.frombuffer(memory, np.int64).reshape(-1, self._columns)
        return self._view[: count // self._columns].copy()


class NativeGuard:
    """Judges every contact in compiled callbacks of the engine's step."""

    def __init__(self, hosted: Hosted, shapes: Shapes) -> None:
        """Attach to the space; ``shapes`` has the parts of robots and walls in one numbering.

        Raises whatever comes of private members of pymunk that are missing or others.
        """
        self.reported = 0
        self._found, self._kept_out = Pile(ROW), Pile(2)
        self._table: IntArray = np.zeros(SLOTS, dtype=np.int64)
        self._kept: list[Any] = []  # what the table points to
        self._describe(hosted, shapes)
        self._connect(hosted)

    @property
    def rejected(self) -> int:
        """False contacts of parts met so far."""
        return int(self._table[REJECTED])

    @rejected.setter
    def rejected(self, count: int) -> None:
        self._table[REJECTED] = count

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
        for slot, ends in zip(range(LINK_PART, LINK_OWN + 1), segment_links(shapes), strict=True):
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


def address(pointed: Any) -> int:
    """Number of a pointer of the engine's library."""
    return int(ffi.cast("intptr_t", pointed))


def _nothing(*arguments: Any) -> None:
    """A callback in Python, which the compiled one replaces."""


@functools.cache
def layout_is_known() -> bool:
    """Whether structures of the engine are laid out as the callbacks write and read them."""
    points = ffi.typeof("cpContactPointSet")
    one = dict(dict(points.fields)["points"].type.item.fields)
    places = [
        (dict(points.fields)[name].offset, at)
        for name, at in (("count", 0), ("normal", 8), ("points", 24))
    ]
    places += [(one[name].offset, at) for name, at in (("pointA", 0), ("pointB", 16))]
    places += [(ffi.offsetof("pmIntArray", "num"), 0), (ffi.offsetof("pmFloatArray", "num"), 0)]
    sizes = [
        ("void *", 8),
        ("cpFloat", 8),
        ("uintptr_t", 8),
        ("int", 4),
        ("cpContactPointSet", 104),
    ]
    return all(found == at for found, at in places) and all(
        ffi.sizeof(name) == size for name, size in sizes
    )
