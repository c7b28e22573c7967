"""What may a robot in contact move in a step?

The engine solves for velocities from rest, under forces that would give every robot its commanded
one, with contacts that take energy and add none. So robots that push each other have no more
energy than they were commanded to have, and one of them at most all of it:

    m_i (v_i^2 + k_i^2 omega_i^2) <= sum over j of m_j (v_j^2 + k_j^2 omega_j^2)

with radii of gyration k, and none is faster than `LEVER` times the fastest command among them: so
fast is a light one that heavy ones squeeze out of a gap of 3 degrees between them. Twice a step
each is eased out of overlaps, by a share of their depths.
Pushing each other are robots that touch at either sample of the step, or that touched just before,
and, where that does not explain a step, those within `PUSHED` of them, which they may meet in it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from physim.contacts import touching
from physim.geometry.polygon import moment
from physim.geometry.separation import body_distance
from physim.geometry.shapes import FloatArray, IntArray, body_parts
from physim.record import Record
from physim.tolerances import ONE_STEP, PUSHED, ULPS

MOST_LOOKED_AT = 100
"""Steps of a block in which robots near others are looked for; in no honest run there was one"""
LEVER = 40.0
"""[-] Without this what is said of masses would let a light robot go anywhere."""


class TooFar(NamedTuple):
    """Steps (M,) of robots in contact that are longer than pushes and commands allow."""

    step: IntArray
    """samples at their ends"""
    robot: IntArray
    gap: FloatArray
    """[m] how far it moved"""
    turn: FloatArray
    """[rad] how far it turned"""
    allowed: FloatArray
    """[m] hypot(gap, k turn) at most"""


class Pushing:
    """Holds steps of robots in contact to the energy of their commands."""

    def __init__(self, record: Record, mass: FloatArray) -> None:
        """Sort the contacts of a record; ``mass`` (N,) [kg] of its robots."""
        self.record, self.mass = record, mass
        self.gyration = np.sqrt(
            [moment(body_parts(record.shapes, i), 1.0) for i in range(record.robots)]
        )
        rows = record.contacts
        self.rows = rows[rows["a"] < record.robots]

    def too_far(
        self, poses: FloatArray, first: int, command: FloatArray, held: NDArray[np.bool_]
    ) -> TooFar:
        """Look at the steps of a block of poses (B, N, 3) of which robots are ``held`` (B - 1, N).

        ``first`` is the sample of the first pose, ``command`` (B - 1, N, 2) what was applied.
        """
        steps, robots = held.shape
        span = [np.searchsorted(self.rows["step"], k) for k in (first, first + steps + 1)]
        rows = self.rows[slice(*span)]
        before = rows[rows["step"] < first + steps]
        after = touching(rows[rows["step"] > first])
        at = (before["step"] - first) * robots
        pairs = np.concatenate((
            _between_robots(before, at, robots),
            _between_robots(after, (after["step"] - first - 1) * robots, robots),
        ))  # fmt: skip
        rate = np.hypot(command[..., 0], self.gyration * command[..., 1]).ravel()
        overlap = np.maximum(before["depth"], 0.0)
        depth = np.bincount(at + before["a"], overlap, held.size).astype(np.float64)
        allowed = self._allowed(_groups(pairs, held.size), rate, depth).reshape(held.shape)
        moved = np.diff(poses, axis=0)
        gap, turn = np.hypot(moved[..., 0], moved[..., 1]), np.abs(moved[..., 2])
        shift = np.hypot(gap, self.gyration * turn)
        slack = ONE_STEP + ULPS * np.spacing(np.abs(poses[1:]).max(axis=2))
        step, robot = np.nonzero(held & ~(shift <= allowed * (1.0 + ONE_STEP) + slack))
        for k in np.unique(step)[:MOST_LOOKED_AT].tolist():
            mine = pairs[pairs[:, 0] // robots == k] % robots
            group = _groups(np.concatenate((mine, self._near(poses[k]))), robots)
            part = slice(k * robots, (k + 1) * robots)
            allowed[k] = self._allowed(group, rate[part], depth[part])
        still = ~(shift[step, robot] <= allowed[step, robot] + slack[step, robot])
        step, robot = step[still], robot[still]
        return TooFar(
            first + step + 1, robot, gap[step, robot], turn[step, robot], allowed[step, robot]
        )

    def _allowed(self, group: IntArray, rate: FloatArray, depth: FloatArray) -> FloatArray:
        """[m] what robots may move that push each other in groups, commanded to ``rate`` [m/s]."""
        mass, fastest = np.resize(self.mass, len(group)), np.zeros(len(group))
        np.maximum.at(fastest, group, rate)
        energetic = np.sqrt(np.bincount(group, mass * rate**2)[group] / mass)
        eased = np.bincount(group, depth)[group]
        speed = np.minimum(energetic, LEVER * fastest[group])
        return np.asarray(speed * self.record.dt + 2.0 * eased)

    def _near(self, pose: FloatArray) -> IntArray:
        """Pairs (M, 2) of robots within `PUSHED` of each other."""
        shapes = self.record.shapes
        reach = shapes.radius[: len(pose)]
        apart = np.hypot(*(pose[:, None, :2] - pose[None, :, :2]).T)
        close = np.triu(apart <= reach[:, None] + reach[None] + PUSHED, 1)
        return np.array(
            [
                (a, b)
                for a, b in np.argwhere(close).tolist()
                if body_distance(shapes, a, pose[a], shapes, b, pose[b]) <= PUSHED
            ],
            dtype=np.int64,
        ).reshape(-1, 2)


def _between_robots(rows: NDArray[np.void], at: IntArray, robots: int) -> IntArray:
    """Pairs (M, 2) of rows between robots, numbered from ``at`` (K,) for the step of each row."""
    some = rows["b"] < robots
    return np.column_stack((at[some] + rows["a"][some], at[some] + rows["b"][some]))


def _groups(pairs: IntArray, count: int) -> IntArray:
    """(count,) the group of each, where those of the pairs (M, 2) belong together."""
    linked = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return np.asarray(connected_components(linked, directed=False)[1])
