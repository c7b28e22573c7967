"""What moves a robot: the contract of drives, which make motion of commands.

A drive is one class in one file, registered in the entry point group ``physim.drives`` and named by
a robot's key ``drive:``. It has settings, which a pydantic model ``Settings`` checks, and nothing
else: what its robots do is a state that the simulation holds, a row for each of them:

    v [m/s], omega [rad/s], lateral [m/s], steering [rad]

the twist of the last step, which is constant over a step, and the angle of its steered wheels, left
positive, 0 of a drive without any. A class with ``steers = True`` has such wheels: records hold
their angle.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, Rows2, read_only

PLAIN = "unicycle"
"""The drive of robots without one, and of those controllers that do not say what they can drive."""
ANY = "any"
"""Said in ``drives`` by a controller of all."""
NO_DRIVES = read_only(np.zeros((0, 4)))
"""State in worlds whose robots all follow their commands at once."""


class Most(NamedTuple):
    """Greatest commands in either direction: what is beyond is refused."""

    v: float
    """[m/s]"""
    omega: float
    """[rad/s]"""
    lateral: float = 0.0
    """[m/s]; above 0 of an omnidirectional drive, and its robots' commands have a third column"""
    curvature: float = inf
    """[1/m] of |omega| over |v|"""
    acceleration: float = inf
    """[m/s²] by which it brakes: who is to stop must begin in time"""


class Reach(NamedTuple):
    """Least and greatest values that a robot can come to within a time."""

    v: tuple[float, float]
    """[m/s]"""
    omega: tuple[float, float]
    """[rad/s]"""
    curvature: tuple[float, float]
    """[1/m] omega over v; infinite where it can turn on the spot"""


@runtime_checkable
class Drive(Protocol):
    """Moves M robots that have the same settings."""

    def most(self, v: float, omega: float) -> Most:
        """Greatest commands of a robot whose ``limits`` are these."""
        ...

    def follow(self, command: FloatArray, state: FloatArray, dt: float) -> FloatArray:
        """State (M, 4) over a step of ``dt`` [s], as near to the commands as can be.

        From commands (M, 3), which are within what is greatest, and the state before.
        """
        ...

    def reach(self, state: FloatArray, time: float) -> FloatArray:
        """(M, 6) least and greatest v, omega and curvature within a time [s] of a state (M, 4).

        Those of `most` are held against it, so it may say inf.
        """
        ...


def towards(wanted: FloatArray, now: FloatArray, most: float | FloatArray) -> FloatArray:
    """What is ``wanted``, or the nearest to it that differs from ``now`` by no more than that."""
    return np.clip(wanted, now - most, now + most)


@compiled
def clip_pairs(pairs: Rows2, count: int, reach: FloatArray) -> None:
    """Make of each of so many speed pairs (v, omega) the nearest that a robot can come to.

    ``reach`` (6,) are its least and greatest v, omega and curvature. Where the curvature is
    bounded it counts more than omega: the robot keeps to its way, slower.
    """
    for k in range(count):
        wanted, turn = pairs[k, 0], pairs[k, 1]
        v = min(max(wanted, reach[0]), reach[1])
        if reach[5] < np.inf:
            curvature = turn / wanted if wanted != 0.0 else 0.0
            turn = v * min(max(curvature, reach[4]), reach[5])
        pairs[k, 0], pairs[k, 1] = v, min(max(turn, reach[2]), reach[3])


__all__ = ["Drive", "Most", "Reach", "towards"]
