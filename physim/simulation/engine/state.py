"""The state of the physics as a value, with what the engine remembers of contacts.

Looks into the engine's private memory through the structures that pymunk itself pickles; their
layout is that of its compiler, nothing is read at offsets of our own.

A step of the engine depends on its bodies (pose, velocity, force, and the pseudo-velocities that
ease overlaps) and on its cached contacts. Of that, at a sample of `Physics`,

- velocities and forces are set anew before the next step;
- the order in which pairs are found follows from the poses, by the spatial hash;
- the cached contacts are those found at the present poses (`collision_persistence` is 1), the
  rejected ones too, and stand in the same order if they are found again there;
- the pseudo-velocities are worked out from nothing in every solve, from the contacts alone and
  apart from velocities and impulses: finding the contacts again, with as many rounds of the solver
  (`space.rounds`), brings them back to the last bit.

So what is left are the pairs that touched at the sample before, by whose number those rounds go
(`PhysicsState.before`), and the impulses that each point of contact has accumulated, from which the
next solve begins. `goes_on_from_impulses` tries all of this out.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.contacts import Phase
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray, IntArray, pack_parts
from physim.simulation.engine.space import Hosted, build_space


@dataclass(frozen=True, eq=False)
class PhysicsState:
    """State of `Physics` at one sample; it never changes, and equal states go on equally.

    Arrays are read-only copies of what is given, in copies and after unpickling too. Two states
    are equal when all their arrays are, bit for bit. There are no velocities: they are given
    anew at every step. What the engine would still ease of overlaps follows from the poses.

    Where the engine's memory of contacts cannot be had (see `physim.simulation.engine.state`), the
    arrays ``part``, ``feature`` and ``impulse`` are empty, and the state holds how it came about
    instead: ``origin_...`` and ``applied``, which are empty otherwise.
    """

    step: IntArray
    """() number of the sample"""
    pose: FloatArray
    """(N, 3) x, y [m], heading [rad, unwrapped]"""
    touching: IntArray
    """(K, 2) ids of the bodies that touch, the smaller first, sorted"""
    part: IntArray
    """(C, 2) the parts that meet at each point of contact, sorted"""
    feature: NDArray[np.uint64]
    """(C,) which of their corners meet there, by the engine's numbers"""
    impulse: FloatArray
    """(C, 2) [N s] along normal and tangent, from which the next solve begins"""
    rejected: IntArray
    """() false contacts kept out so far"""
    contacts: NDArray[np.void]
    """contact rows of the sample: handed on; the next step needs their phases alone, `before`"""
    false_contacts: NDArray[np.void]
    """rows of the false contacts of the sample, likewise"""
    origin_step: IntArray
    """() a sample before this one from which poses alone lead on: a start, or free of contact"""
    origin_pose: FloatArray
    """(N, 3) poses there"""
    origin_rejected: IntArray
    """() false contacts kept out until then"""
    applied: FloatArray
    """(M, N, 2) commands of the steps since then"""

    def __post_init__(self) -> None:
        """Keep read-only copies."""
        for name, array in self.arrays().items():
            copy = np.array(array)
            copy.flags.writeable = False
            object.__setattr__(self, name, copy)

    @property
    def before(self) -> IntArray:
        """Pairs (K, 2) that touched at the sample before: they go on, or have ended."""
        rows = self.contacts[self.contacts["phase"] != Phase.BEGAN]
        return np.stack((rows["a"], rows["b"]), axis=1)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All arrays by name; ``PhysicsState(**arrays)`` makes the same state of them."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def __eq__(self, other: object) -> bool:
        """Whether all arrays are the same, bit for bit."""
        if not isinstance(other, PhysicsState):
            return NotImplemented
        pairs = zip(self.arrays().values(), other.arrays().values(), strict=True)
        return all(_same(one, another) for one, another in pairs)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[PhysicsState], tuple[NDArray[Any], ...]]:
        """Copy and unpickle through the constructor, which makes the arrays read-only."""
        return PhysicsState, tuple(self.arrays().values())


def _same(one: NDArray[Any], other: NDArray[Any]) -> bool:
    alike = one.dtype == other.dtype and one.shape == other.shape
    return alike and one.tobytes() == other.tobytes()


class Impulses(NamedTuple):
    """One row a point of contact, sorted by parts, in the engine's order for the same parts."""

    part: IntArray
    """(C, 2) part numbers in the engine's order"""
    feature: NDArray[np.uint64]
    """(C,) the engine's number of the two corners that meet: it carries impulses over by it"""
    impulse: FloatArray
    """(C, 2) [N s] along normal and tangent"""


def no_impulses() -> Impulses:
    """Return the impulses of no contact."""
    return Impulses(
        np.zeros((0, 2), dtype=np.int64), np.zeros(0, dtype=np.uint64), np.zeros((0, 2))
    )


class ContactMemory:
    """The impulses of a space's contacts."""

    def __init__(self, hosted: Hosted) -> None:
        """Attach to a space."""
        self._space = hosted.space
        self._number = {shape._shape: part for part, shape in enumerate(hosted.parts)}

    def read(self) -> Impulses:
        """Return the impulses after the last solve."""
        points = self._points()
        if not points:
            return no_impulses()
        return Impulses(*_identity(points), np.array([(p.jnAcc, p.jtAcc) for *_, p in points]))

    def write(self, kept: Impulses) -> None:
        """Put impulses back after a solve that found the same contacts.

        Raises PhysimError where it found others.
        """
        points = self._points()
        part, feature = _identity(points) if points else no_impulses()[:2]
        if not (np.array_equal(part, kept.part) and np.array_equal(feature, kept.feature)):
            raise PhysimError(
                "the state is of another scene: at its poses the engine finds other contacts "
                f"({len(part)} points) than those in it ({len(kept.part)})"
            )
        for (*_, point), (normal, tangent) in zip(points, kept.impulse.tolist(), strict=True):
            point.jnAcc, point.jtAcc = normal, tangent

    def _points(self) -> list[tuple[int, int, int, Any]]:
        """Part, other part, number and structure of every point of contact, sorted."""
        found = []
        for arbiter in self._space._get_arbiters():  # in the order of addresses
            parts = self._number[arbiter.a], self._number[arbiter.b]
            found += [(*parts, k, arbiter.contacts[k]) for k in range(arbiter.count)]
        return sorted(found, key=lambda point: point[:3])


def _identity(points: list[tuple[int, int, int, Any]]) -> tuple[IntArray, NDArray[np.uint64]]:
    part = np.array([point[:2] for point in points], dtype=np.int64)
    return part, np.array([point.hash for *_, point in points], dtype=np.uint64)


@functools.cache
def goes_on_from_impulses() -> bool:
    """Whether this engine, put to poses with its impulses, goes on bit for bit.

    Tried out once a process. False for a version whose memory is another, or cannot be had.
    """
    try:
        return _trial()
    except Exception:  # whatever a missing or changed private member brings about
        return False


def _trial(boxes: int = 5, before: int = 12, after: int = 3) -> bool:
    """Press a row of boxes against a wall, go on in another space, and compare."""
    start = np.column_stack((1.005 * np.arange(boxes), 0.04 * np.arange(boxes), np.zeros(boxes)))
    one = _row_of_boxes(start)
    for _ in range(before):
        _press(one)
    other = _row_of_boxes(_motion(one)[:, :3])
    other.space.step(_TRIAL_STEP)
    ContactMemory(other).write(ContactMemory(one).read())
    for _ in range(after):
        _press(one)
        _press(other)
        if _motion(one).tobytes() != _motion(other).tobytes():
            return False
    return True


_TRIAL_STEP = 0.05


def _row_of_boxes(start: FloatArray) -> Hosted:
    box = [(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)]
    wall = [(len(start) - 0.51, -9.0), (len(start) - 0.51, 9.0)]
    robots = pack_parts([[box]] * len(start))
    return build_space(robots, pack_parts([[wall]]), start, np.full(len(start), 10.0), 0.3, 0.0)


def _press(hosted: Hosted) -> None:
    for body in hosted.bodies:
        body.velocity, body.angular_velocity = (0.0, 0.0), 0.0
        body.force, body.torque = (200.0, 60.0), 5.0
    hosted.space.step(_TRIAL_STEP)


def _motion(hosted: Hosted) -> FloatArray:
    bodies = hosted.bodies
    return np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in bodies])
