"""Contacts that would add energy: the solver of the engine failed on them.

Contacts take energy and add none. The solver mends one contact after the other, and with much
friction, where a push along a surface presses a body onto it, each round makes the next worse: a
robot of 150 kg was given 1e76 m/s.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.compiled import compiled
from physim.geometry.shapes import FloatArray, IntArray

OF_PUSHES, OF_IMPACTS = 1.01, 4.0
"""[-] times the energy that robots in contact had, beyond which the solver failed. Pushes never
gain any; impacts, of which the impulses alone are used, up to 0.2 where the elasticity is 0.9."""
TINY = 1e-12
"""[m^2/s^2] times the mass, which is nothing"""


@compiled
def failures(
    key: IntArray,
    bodies: int,
    inertia: FloatArray,
    given: FloatArray,
    found: FloatArray,
    gain: float,
    failed: NDArray[np.bool_],
    impulse: FloatArray,
) -> bool:
    """Find robots in contact to which the solver gave energy; whether there are any.

    ``key`` are the pairs (K,) that touch, ``inertia`` (N, 3) mass [kg] twice and moment [kg m^2],
    ``given`` and ``found`` (N, 3) velocities before and after. Robots that touch each other are one
    group, in which energy may go from one to another: to ``gain`` times what it had. Sets
    ``failed`` (N,), and ``impulse`` (K,) [N s] of their pairs to the momentum that the group had.
    """
    robots = len(given)
    group = np.arange(robots)
    for one in key:
        a, b = one // bodies, one % bodies
        if b < robots:
            _join(group, a, b)
    before, after, momentum = np.zeros(robots), np.zeros(robots), np.zeros(robots)
    for i in range(robots):
        root = _root(group, i)
        for k in range(3):
            before[root] += inertia[i, k] * (given[i, k] ** 2 + TINY)
            after[root] += inertia[i, k] * found[i, k] ** 2
        momentum[root] += inertia[i, 0] * np.hypot(given[i, 0], given[i, 1])
    has_failed = False
    for i in range(robots):
        root = _root(group, i)
        failed[i] = not after[root] <= gain * before[root]
        has_failed |= failed[i]
    if has_failed:
        for m in range(len(key)):
            a = key[m] // bodies
            if failed[a]:
                impulse[m] = momentum[_root(group, a)]
    return has_failed


@compiled
def _root(group: IntArray, i: int) -> int:
    while group[i] != i:
        group[i] = group[group[i]]
        i = group[i]
    return i


@compiled
def _join(group: IntArray, a: int, b: int) -> None:
    group[_root(group, a)] = _root(group, b)
