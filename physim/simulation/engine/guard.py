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

from physim.compiled import address_of, compiled
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.natives import (
    call2,
    call3,
    doubles_at,
    int_rows2_at,
    integers_at,
    put_short,
    rows2_at,
)
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
    scratch = integers_at(table[SCRATCH], 2)
    call3(table[SHAPES_OF], arbiter, table[SCRATCH], table[SCRATCH] + 8)
    handles = integers_at(table[HANDLES], table[PARTS])
    parts = integers_at(table[PART_OF_HANDLE], table[PARTS])
    one = place_of(handles, table[PARTS], scratch[0])
    return parts[one], parts[place_of(handles, table[PARTS], scratch[1])]


@compiled
def place_of(handles: IntArray, count: int, handle: int) -> int:
    """Where a handle stands among others, sorted."""
    low, high = 0, count - 1
    while low < high:
        middle = (low + high) // 2
        if handles[middle] < handle:
            low = middle + 1
        else:
            high = middle
    return low


@compiled
def asked(table: IntArray, function: int, what: int, fields: int) -> FloatArray:
    """What the engine says of a body or a contact: the numbers (8,); whole ones lie at INTS."""
    put_short(table[FLOAT_COUNT], 0)
    put_short(table[INT_COUNT], 0)
    call2(table[function], what, table[fields])
    return doubles_at(table[FLOATS], 8)


@compiled
def put_pose(table: IntArray, part: int, out: FloatArray) -> None:
    """Write the pose (3,) of the body of a part."""
    bodies = integers_at(table[BODY_OF_PART], table[PARTS])
    found = asked(table, GET_BODY, bodies[part], BODY_FIELDS)
    out[0], out[1], out[2] = found[0], found[1], found[2]


@compiled
def judge_contact(arbiter: int, space: int, data: int) -> None:
    """Let a contact act, as it is to, or keep it out; the engine calls this before it solves."""
    table = integers_at(data, SLOTS)
    table[REPORTED] += 1
    if table[CHECKS] == 0:
        return
    shapes = Shapes(
        rows2_at(table[VERTEX], table[VERTICES]),
        integers_at(table[PART_START], table[PARTS] + 1),
        integers_at(table[BODY_START], table[BODIES] + 1),
        doubles_at(table[RADIUS], table[BODIES]),
    )
    links = Links(
        int_rows2_at(table[LINK_PART], table[PARTS]), int_rows2_at(table[LINK_END], table[PARTS])
    )
    one, other = parts_of(table, arbiter)
    p, q, is_swapped = min(one, other), max(one, other), one > other
    pose_p, pose_q = np.zeros(3), np.zeros(3)
    put_pose(table, p, pose_p)
    put_pose(table, q, pose_q)
    meeting = Meeting(shapes, links, p, pose_p, q, pose_q)
    found = asked(table, GET_ARBITER, arbiter, POINT_FIELDS)
    points = integers_at(table[INTS], 1)[0]
    spot = Spot(found[0], found[1], found[2], found[3])
    if is_swapped:
        spot = Spot(found[2], found[3], found[0], found[1])
    rules = ruling(meeting, points, spot)
    acts = rules.verdict != APART and rules.verdict != LEFT
    call2(table[PROCESS], arbiter, 1 if acts else 0)
    if rules.verdict == APART:
        call2(table[APPEND], table[KEPT_OUT], one)
        call2(table[APPEND], table[KEPT_OUT], other)
    if rules.is_put:  # for all the points that it has, one of either part
        put, at = doubles_at(table[POINTS], 13), rules.spot
        put_short(table[POINTS], points)
        put[1], put[2] = -rules.nx, -rules.ny
        if is_swapped:
            put[1], put[2] = rules.nx, rules.ny
            at = Spot(at.qx, at.qy, at.px, at.py)
        for point in range(2):
            k = 3 + 5 * point
            put[k], put[k + 1], put[k + 2], put[k + 3] = at.px, at.py, at.qx, at.qy
        call2(table[SET_POINTS], arbiter, table[POINTS])


@compiled
def note_contact(arbiter: int, space: int, data: int) -> None:
    """Take down a contact that acted; the engine calls this when it has solved."""
    table = integers_at(data, SLOTS)
    one, other = parts_of(table, arbiter)
    found = asked(table, GET_ARBITER, arbiter, IMPULSE_FIELDS)
    # As Python's x**2 does it. The exponent comes from memory: as a constant the compiler would
    # make a product of it, which now and then is another number.
    scratch = doubles_at(table[SCRATCH], 4)
    scratch[3] = math.sqrt(math.pow(found[0], scratch[2]) + math.pow(found[1], scratch[2]))
    call2(table[APPEND], table[FOUND], one)
    call2(table[APPEND], table[FOUND], other)
    call2(table[APPEND], table[FOUND], integers_at(table[SCRATCH], 4)[3])


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
        handler.preSolveFunc = ffi.cast("cpCollisionPreSolveFunc", address_of(judge_contact))
        handler.postSolveFunc = ffi.cast("cpCollisionPostSolveFunc", address_of(note_contact))

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
