"""The state of the physics as a value: named arrays of all that the next step depends on."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class PhysicsState:
    """State of `Physics` at one sample; it never changes, and equal states go on equally.

    Arrays are read-only copies of what is given, in copies and after unpickling too. Two states
    are equal when all their arrays are, bit for bit. There are no velocities: they are given
    anew at every step. What the engine would still ease of overlaps follows from the poses.

    Where the engine's memory of contacts cannot be had (see `physim.physics.engine_state`), the
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
    """contact rows of the sample: handed on, though the next step needs none of them"""
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
