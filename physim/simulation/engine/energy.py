"""Contacts that would add energy: the solver of the engine failed on them.

Contacts take energy and add none. The solver mends one contact after the other, and with much
friction, where a push along a surface presses a body onto it, each round makes the next worse: a
robot of 150 kg was given 1e76 m/s.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import Flags, FloatArray, IntArray, Rows3
from physim.simulation.engine.pairs import Pairs

OF_PUSHES, OF_IMPACTS = 1.01, 4.0
"""[-] times the energy that robots in contact had, beyond which the solver failed. Pushes never
gain any; impacts, of which the impulses alone are used, up to 0.2 where the elasticity is 0.9."""
LEVER = 10.0
"""[-] times the speed of a mover that what it pushes may get, squeezed out between it and a wall"""
TINY = 1e-12
"""[m^2/s^2] times the mass, which is nothing"""


@compiled
def failures(
    pairs: Pairs,
    inertia: Rows3,
    given: Rows3,
    found: Rows3,
    robots: int,
    bodies: int,
    gain: float,
    reach: FloatArray,
    failed: Flags,
) -> bool:
    """Write into ``failed`` (N,) to which robots in contact the solver gave energy; if to any.

    ``pairs`` of so many ``bodies`` touch, ``inertia`` (N, 3) is mass [kg] twice and moment
    [kg m^2], ``given`` and ``found`` (N, 3) velocities before and after. Robots that touch each
    other are one group, in which energy may go from one to another: to ``gain`` times what it had.
    Sets the impulse of their pairs to the momentum that the group had. A mover, which has no
    inertia here, adds what its fastest point, ``reach`` (N,) [m] about its reference point, gives.
    """
    group = np.arange(robots)
    for m in range(pairs.size):
        key = pairs.key[m]
        a, b = key // bodies, key % bodies
        if b < robots:
            group[root(group, a)] = root(group, b)
    before, after, momentum = np.zeros(robots), np.zeros(robots), np.zeros(robots)
    driven = np.zeros(robots)  # [m/s] of the fastest mover of a group
    for i in range(robots):
        if inertia[i, 0] == 0.0:
            speed = np.hypot(given[i, 0], given[i, 1]) + reach[i] * abs(given[i, 2])
            of = root(group, i)
            driven[of] = max(driven[of], speed)
    for i in range(robots):
        of = root(group, i)
        before[of] += inertia[i, 0] * (LEVER * driven[of]) * (LEVER * driven[of])
        for k in range(3):
            before[of] += inertia[i, k] * (given[i, k] * given[i, k] + TINY)
            after[of] += inertia[i, k] * (found[i, k] * found[i, k])
        momentum[of] += inertia[i, 0] * (np.hypot(given[i, 0], given[i, 1]) + driven[of])
    has_failed = False
    for i in range(robots):
        of = root(group, i)
        failed[i] = inertia[i, 0] > 0.0 and not after[of] <= gain * before[of]
        has_failed = has_failed or failed[i]
    if not has_failed:
        return False
    for m in range(pairs.size):
        a, b = pairs.key[m] // bodies, pairs.key[m] % bodies
        if failed[a] or (b < robots and failed[b]):
            pairs.impulse[m] = momentum[root(group, a)]
    return True


@compiled
def root(group: IntArray, i: int) -> int:
    """Robot by which the group of robot i is known."""
    while group[i] != i:
        group[i] = group[group[i]]
        i = group[i]
    return i
