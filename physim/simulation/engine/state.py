"""The state of the physics as a value, with what the engine remembers of contacts.

Looks into the engine's memory through the structures that pymunk itself pickles; nothing is read
at offsets of our own.

A step of the engine depends on its bodies (pose, velocity, force, and the pseudo-velocities that
ease overlaps) and on its cached contacts. Of that, at a sample of `Physics`,

- velocities and forces are set anew before the next step;
- the order in which pairs are found follows from the poses, by the spatial hash;
- the cached contacts are those found at the present poses (`collision_persistence` is 1), the
  rejected ones too, and stand in the same order if they are found again there;
- the pseudo-velocities are worked out from nothing in every solve, from the contacts alone and
  apart from velocities and impulses: finding the contacts again, with as many rounds of the solver
  (`host.ALL_ROUNDS`), brings them back to the last bit.

So what is left are the pairs that touched at the sample before, by whose number those rounds go
(`PhysicsState.before`), and the impulses that each point of contact has accumulated, from which the
next solve begins.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.contacts import Kind, Phase
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray, IntArray
from physim.simulation.engine.space import Hosted


@dataclass(frozen=True, eq=False)
class PhysicsState:
    """State of `Physics` at one sample; it never changes, and equal states go on equally.

    Arrays are read-only copies of what is given, in copies and after unpickling too. Two states
    are equal when all their arrays are, bit for bit. There are no velocities: they are given
    anew at every step. What the engine would still ease of overlaps follows from the poses.
    """

    step: IntArray
    """() number of the sample"""
    pose: FloatArray
    """(N, 3) x, y [m], heading [rad, unwrapped]"""
    part: IntArray
    """(C, 2) the parts that meet at each point of contact, in the engine's order; sorted"""
    feature: NDArray[np.uint64]
    """(C,) the engine's number of the corners that meet there: it carries impulses over by it"""
    impulse: FloatArray
    """(C, 2) [N s] along normal and tangent, from which the next solve begins"""
    contacts: NDArray[np.void]
    """contact rows of the sample: the next step needs their phases alone, `touching`, `before`"""
    false_contacts: NDArray[np.void]
    """rows of the false contacts of the sample: handed on"""

    def __post_init__(self) -> None:
        """Keep read-only copies."""
        for name, array in self.arrays().items():
            copy = np.array(array)
            copy.flags.writeable = False
            object.__setattr__(self, name, copy)

    @property
    def before(self) -> IntArray:
        """Pairs (K, 2) that touched at the sample before: they go on, or have ended."""
        return _pairs(self.contacts[self.contacts["phase"] != Phase.BEGAN])

    @property
    def touching(self) -> IntArray:
        """Pairs (K, 2) that touch, by ids, the smaller first, sorted."""
        rows = self.contacts[self.contacts["kind"] == Kind.PHYSICAL]
        return _pairs(rows[rows["phase"] != Phase.ENDED])

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All arrays by name; ``PhysicsState(**arrays)`` makes the same state of them."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def __eq__(self, other: object) -> bool:
        """Whether all arrays are the same, bit for bit."""
        if not isinstance(other, PhysicsState):
            return NotImplemented
        pairs = zip(self.arrays().values(), other.arrays().values(), strict=True)
        return all(
            (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes()) for a, b in pairs
        )

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[PhysicsState], tuple[NDArray[Any], ...]]:
        """Copy and unpickle through the constructor, which makes the arrays read-only."""
        return PhysicsState, tuple(self.arrays().values())


def _pairs(rows: NDArray[np.void]) -> IntArray:
    return np.stack((rows["a"], rows["b"]), axis=1).astype(np.int64)


class ContactMemory:
    """What the points of contact of a space have accumulated."""

    def __init__(self, hosted: Hosted) -> None:
        """Attach to a space."""
        self._space = hosted.space
        self._number = {shape._shape: part for part, shape in enumerate(hosted.parts)}
        self.nothing = self.read()

    def read(self) -> tuple[IntArray, NDArray[np.uint64], FloatArray]:
        """Return ``part``, ``feature`` and ``impulse`` of a state after the last solve."""
        part, feature, points = self._points()
        impulse = [(point.jnAcc, point.jtAcc) for point in points]
        return part, feature, np.array(impulse, dtype=np.float64).reshape(-1, 2)

    def write(self, state: PhysicsState) -> None:
        """Put impulses back after a solve that found the same contacts.

        Raises PhysimError where it found others.
        """
        part, feature, points = self._points()
        if not (np.array_equal(part, state.part) and np.array_equal(feature, state.feature)):
            raise PhysimError(
                "the state is of another scene: at its poses the engine finds other contacts "
                f"({len(part)} points) than those in it ({len(state.part)})"
            )
        for point, (normal, tangent) in zip(points, state.impulse.tolist(), strict=True):
            point.jnAcc, point.jtAcc = normal, tangent

    def _points(self) -> tuple[IntArray, NDArray[np.uint64], list[Any]]:
        """Parts, number and structure of every point of contact, sorted."""
        found: list[tuple[int, int, int, Any]] = []
        for arbiter in self._space._get_arbiters():  # in the order of addresses
            parts = self._number[arbiter.a], self._number[arbiter.b]
            found += [(*parts, k, arbiter.contacts[k]) for k in range(arbiter.count)]
        found.sort(key=lambda point: point[:3])
        part = np.array([point[:2] for point in found], dtype=np.int64).reshape(-1, 2)
        points = [point[3] for point in found]
        return part, np.array([point.hash for point in points], dtype=np.uint64), points
