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
from physim.simulation.engine.meeting import Spot, ruling
from physim.simulation.engine.space import Hosted
from physim.simulation.engine.verdict import APART, LEFT, Links, Meeting, segment_links

# Places in the table of numbers and addresses that the callbacks get: contacts since the last
# `Guard.take`, and whether they are judged at all; how many there are,
REPORTED, CHECKS, PARTS, VERTICES, BODIES = range(5)
# functions of the engine,
SHAPES_OF, PROCESS, GET_BODY, GET_ARBITER, SET_POINTS, APPEND = range(5, 11)
# arrays of `Shapes` and `Links`,
VERTEX, PART_START, BODY_START, RADIUS, LINK_PART, LINK_END = range(11, 17)
# the engine's pointers to shapes, sorted, the part of each, and pointers to the bodies of parts,
HANDLES, PART_OF_HANDLE, BODY_OF_PART = range(17, 20)
# what the engine is asked for, where it writes the answer, and what the callbacks write.
BODY_FIELDS, IMPULSE_FIELDS, POINT_FIELDS = range(20, 23)
FLOATS, FLOAT_COUNT, INTS, INT_COUNT, POINTS, FOUND, KEPT_OUT, SCRATCH = range(23, 31)
SLOTS = 31


class Touches(NamedTuple):
    """True contacts of parts in one solve, in the order in which the engine met them."""

    part: IntArray
    """(M, 2) part numbers"""
    impulse: FloatArray
    """(M,) [N s] magnitude"""


NOTHING = Touches(np.zeros((0, 2), dtype=np.int64), np.zeros(0))


@compiled
def parts_of(table: IntArray, arbiter: int) -> tuple[int, int]:
    """Part numbers of a contact, in the engine's order."""
    scratch = array_at(pointer(table[SCRATCH]), (2,), np.int64)
    call(table[SHAPES_OF], (arbiter, table[SCRATCH], table[SCRATCH] + 8))
    handles = array_at(pointer(table[HANDLES]), (table[PARTS],), np.int64)
    parts = array_at(pointer(table[PART_OF_HANDLE]), (table[PARTS],), np.int64)
    one, other = np.searchsorted(handles, scratch[0]), np.searchsorted(handles, scratch[1])
    return int(parts[one]), int(parts[other])


@compiled
def asked(table: IntArray, function: int, what: int, fields: int) -> FloatArray:
    """What the engine says of a body or a contact: the numbers (8,); whole ones lie at INTS."""
    array_at(pointer(table[FLOAT_COUNT]), (1,), np.int32)[0] = 0
    array_at(pointer(table[INT_COUNT]), (1,), np.int32)[0] = 0
    call(table[function], (what, table[fields]))
    found: FloatArray = array_at(pointer(table[FLOATS]), (8,), np.float64)
    return found


@compiled
def pose_of(table: IntArray, part: int) -> FloatArray:
    """Pose (3,) of the body of a part."""
    bodies = array_at(pointer(table[BODY_OF_PART]), (table[PARTS],), np.int64)
    return asked(table, GET_BODY, bodies[part], BODY_FIELDS)[:3].copy()


@callback(3)
def judge(arbiter: int, space: int, data: int) -> None:
    """Let a contact act, as it is to, or keep it out; the engine calls this before it solves."""
    table = array_at(pointer(data), (SLOTS,), np.int64)
    table[REPORTED] += 1
    if not table[CHECKS]:
        return
    parts, ends = table[PARTS], (table[PARTS], 2)
    shapes = Shapes(
        array_at(pointer(table[VERTEX]), (table[VERTICES], 2), np.float64),
        array_at(pointer(table[PART_START]), (parts + 1,), np.int64),
        array_at(pointer(table[BODY_START]), (table[BODIES] + 1,), np.int64),
        array_at(pointer(table[RADIUS]), (table[BODIES],), np.float64),
    )
    links = Links(
        array_at(pointer(table[LINK_PART]), ends, np.int64),
        array_at(pointer(table[LINK_END]), ends, np.int64),
    )
    one, other = parts_of(table, arbiter)
    p, q, is_swapped = min(one, other), max(one, other), one > other
    meeting = Meeting(shapes, links, p, pose_of(table, p), q, pose_of(table, q))
    found = asked(table, GET_ARBITER, arbiter, POINT_FIELDS)
    ax, ay, bx, by = found[0], found[1], found[2], found[3]
    points = array_at(pointer(table[INTS]), (1,), np.int64)[0]
    spot = Spot(bx, by, ax, ay) if is_swapped else Spot(ax, ay, bx, by)
    rules = ruling(meeting, points, spot)
    call(table[PROCESS], (arbiter, np.int64(rules.verdict not in (APART, LEFT))))
    if rules.verdict == APART:
        call(table[APPEND], (table[KEPT_OUT], np.int64(one)))
        call(table[APPEND], (table[KEPT_OUT], np.int64(other)))
    if rules.is_put:  # for all the points that it has, one of either part
        put = array_at(pointer(table[POINTS]), (13,), np.float64)
        array_at(pointer(table[POINTS]), (1,), np.int32)[0] = points
        px, py, qx, qy = rules.spot
        for k in (3, 8):
            if is_swapped:
                put[1], put[2] = rules.nx, rules.ny
                put[k], put[k + 1], put[k + 2], put[k + 3] = qx, qy, px, py
            else:
                put[1], put[2] = -rules.nx, -rules.ny
                put[k], put[k + 1], put[k + 2], put[k + 3] = px, py, qx, qy
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
    for number in (np.int64(one), np.int64(other), bits):
        call(table[APPEND], (table[FOUND], number))


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
        table: IntArray = np.zeros(SLOTS, dtype=np.int64)
        self._table, self._kept = table, list[Any]()  # and what the table points to
        table[CHECKS], table[VERTICES] = checks, len(shapes.vertices)
        table[PARTS], table[BODIES] = len(shapes.part_start) - 1, len(shapes.body_start) - 1
        for slot, array in enumerate((*shapes, *segment_links(shapes)), VERTEX):
            table[slot] = self._keep(array)
        handles = np.array([_address(shape._shape) for shape in hosted.parts], dtype=np.int64)
        order = np.argsort(handles)
        bodies = [_address(shape.body._body) for shape in hosted.parts]  # type: ignore[union-attr]
        table[HANDLES], table[PART_OF_HANDLE] = self._keep(handles[order]), self._keep(order)
        table[BODY_OF_PART] = self._keep(np.array(bodies, dtype=np.int64))
        for slot, name in (
            (SHAPES_OF, "cpArbiterGetShapes"),
            (PROCESS, "cpArbiterSetProcessCollision"),
            (GET_BODY, "pmSpaceBodyGetIteratorFuncBatched"),
            (GET_ARBITER, "pmSpaceArbiterIteratorFuncBatched"),
            (SET_POINTS, "cpArbiterSetContactPointSet"),
            (APPEND, "pmIntArrayPush"),
        ):
            table[slot] = _address(ffi.addressof(lib, name))
        floats = ffi.gc(lib.pmFloatArrayNew(64), lib.pmFloatArrayFree)
        ints, self._found, self._kept_out = (
            ffi.gc(lib.pmIntArrayNew(size), lib.pmIntArrayFree) for size in (64, 192, 128)
        )
        self._kept += [floats, ints]
        table[FLOATS], table[FLOAT_COUNT] = _address(floats.arr), _address(floats)
        table[INTS], table[INT_COUNT] = _address(ints.arr), _address(ints)
        table[FOUND], table[KEPT_OUT] = _address(self._found), _address(self._kept_out)
        table[SCRATCH] = self._keep(np.array((0.0, 0.0, 2.0, 0.0)))
        table[POINTS] = self._keep(np.zeros(13))
        points = ArbiterFields.CONTACT_COUNT | ArbiterFields.POINT_A_1 | ArbiterFields.POINT_B_1
        for slot, fields in (
            (BODY_FIELDS, BodyFields.POSITION | BodyFields.ANGLE),
            (IMPULSE_FIELDS, ArbiterFields.TOTAL_IMPULSE),
            (POINT_FIELDS, points),
        ):
            data = ffi.new("pmBatchedData *")
            data.fields, data.floatArray, data.intArray = fields.value, floats, ints
            self._kept.append(data)
            table[slot] = _address(data)
        hosted.space.on_collision(None, None, pre_solve=_nothing, post_solve=_nothing)
        handler = hosted.space._handlers[None, None]._handler
        handler.userData = ffi.cast("void *", self._keep(table))
        handler.preSolveFunc = ffi.cast("cpCollisionPreSolveFunc", judge.address)
        handler.postSolveFunc = ffi.cast("cpCollisionPostSolveFunc", note.address)

    def take(self) -> Touches:
        """Return the true contacts since the last call."""
        self.reported = self._table.item(REPORTED)
        if not self.reported:
            return NOTHING
        self._table[REPORTED] = 0
        found = _taken(self._found, 3)  # two parts, and the bits of the impulse
        return Touches(found[:, :2].copy(), found[:, 2].copy().view(np.float64))

    def take_rejected(self) -> IntArray:
        """Return the parts (M, 2) of the false contacts since the last call."""
        return _taken(self._kept_out, 2) if self._kept_out.num else NOTHING.part

    def _keep(self, array: NDArray[Any]) -> int:
        """Address of an array that stays where it is as long as the guard."""
        array = np.ascontiguousarray(array)
        self._kept.append(array)
        return int(array.ctypes.data)


def _taken(numbers: Any, columns: int) -> IntArray:
    """Rows of what callbacks appended to an array of the engine's library, which is empty then."""
    found = np.zeros((numbers.num // columns, columns), dtype=np.int64)
    ffi.memmove(ffi.from_buffer(found), numbers.arr, found.nbytes)
    numbers.num = 0
    return found


def _address(pointed: Any) -> int:
    """Number of a pointer of the engine's library."""
    return int(ffi.cast("intptr_t", pointed))


def _nothing(*arguments: Any) -> None:
    """A callback in Python, which the compiled one replaces."""
