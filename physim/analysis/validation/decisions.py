"""Decisions of a record by robot, and what drives each body that moves."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache

import numpy as np

from physim.geometry.motion import Twist, ended_twists
from physim.geometry.path import path_length, project, track
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record

WINDOW = 2.0
"""[m] least stretch of the reference path in which a robot is looked for after its last decision"""

BLOCK = 1 << 14
"""Commands worked out at once where single ones are asked for"""
BLOCKS = 32
"""of such blocks, how many are kept: 8 MB"""


STILL: Twist = (0.0, 0.0, 0.0)
"""of what stands"""


def movers_of(record: Record) -> range:
    """Return the ids of the movers of a record."""
    count = sum(body.kind == "mover" for body in record.bodies)
    return range(record.robots, record.robots + count)


class DecisionTable:
    """Decisions by robot, and what drives robots, movers and what can be pushed."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.radius = record.shapes.radius
        """(B,) [m] of the circle round each reference point that holds the footprint"""
        self.movers = movers_of(record)
        rows = record.updates
        self._order = np.lexsort((rows["step"], rows["robot"]))
        self._span = int(rows["step"].max(initial=0)) + 2
        self._keys = (rows["robot"].astype(np.int64) * self._span + rows["step"])[self._order]

    def last_rows(self, robot: IntArray | int, step: IntArray | int) -> IntArray:
        """Row of the last decision of each robot at or before each step; -1 before its first."""
        robots = np.asarray(robot, dtype=np.int64)
        key = robots * self._span + np.minimum(step, self._span - 1)
        at = np.searchsorted(self._keys, key, side="right") - 1
        if not len(self._keys):
            return at
        row = self._order[at]
        return np.where((at >= 0) & (self.record.updates["robot"][row] == robots), row, -1)

    def steps(self, robot: int) -> IntArray:
        """Steps at which a robot decided, increasing."""
        rows = self.record.updates
        return np.asarray(rows["step"][rows["robot"] == robot])

    def last(self, robot: int, step: int) -> np.void | None:
        """Last decision of a robot at or before a step; None before its first."""
        row = int(self.last_rows(robot, step))
        return None if row < 0 else self.record.updates[row]

    def last_before(self, robots: list[int], step: int) -> int | None:
        """Step of the last decision of any of these robots before a step."""
        rows = [row for row in (self.last(i, step - 1) for i in robots) if row is not None]
        return max((int(row["step"]) for row in rows), default=None)

    def held(self, body: int, step: int) -> Twist:
        """Twist that drives a body that moves over the step from a sample on: see `held_over`."""
        block, place = divmod(step, self._block_steps)
        v, omega, lateral = self._held_block(block)[place, body].tolist()
        return v, omega, lateral

    def held_over(self, first: int, last: int) -> FloatArray:
        """Twists (K, B, 3) that drive what moves over the steps from each of K samples on.

        Of a robot that is the applied command, 0 before its first decision; of a mover the twist
        that leads from sample to sample, 0 at the last; what can be pushed wants to stand.
        """
        record = self.record
        held = np.zeros((last - first, record.moving, 3))
        command = record.commands_over("applied", first, last)
        held[:, : record.robots, : command.shape[2]] = command
        if self.movers:
            row = np.clip(np.arange(first, last + 1), record.begun_at, record.steps_run)
            row -= record.begun_at
            pose = record.read("/steps/pose", int(row[0]), int(row[-1]) + 1)[row - row[0]]
            pose = pose[:, self.movers]
            moved = (np.diff(pose, axis=0) / record.dt).reshape(-1, 3)
            twist = ended_twists(pose[1:].reshape(-1, 3), moved, record.dt)
            held[:, self.movers] = twist.reshape(pose[1:].shape)
        return held

    @property
    def _block_steps(self) -> int:
        return max(1, BLOCK // self.record.moving)

    @cached_property
    def _held_block(self) -> Callable[[int], FloatArray]:
        """Makes a block of `held_over` by its number; the last few are kept."""
        steps = self._block_steps
        return lru_cache(BLOCKS)(lambda k: self.held_over(k * steps, (k + 1) * steps))

    def reference_station(self, robot: int, step: int) -> float:
        """Projection [m] of a robot on the reference path s* at a recorded step.

        Followed from its last decision, so that a path that passes near itself does not mislead.
        """
        record, row = self.record, self.last(robot, step)
        x, y, _ = record.pose_at(step)[robot].tolist()
        lines = record.reference
        if row is None or not np.isfinite(row["reference_station"]):
            return float(project(lines, 0, x, y, 0.0, path_length(lines, 0))[0])
        seconds = (step - int(row["step"])) * record.dt
        window = WINDOW + 2.0 * abs(float(row["applied_v"])) * seconds
        station = float(row["reference_station"])
        return float(track(lines, 0, x, y, station, window)[0])
