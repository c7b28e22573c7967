"""Decisions and samples of a record: decisions by robot, and samples with stations in blocks.

Whatever is computed at every sample shares these blocks, so poses are read and robots are
followed along their paths once, and memory stays flat.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.analysis.validation.analytic_contacts import pose_blocks
from physim.geometry.path import path_length, project, track
from physim.geometry.shapes import FloatArray, IntArray, read_only
from physim.geometry.tracking import Tracking
from physim.record import Record

WINDOW = 2.0
"""[m] least stretch of the reference path in which a robot is looked for after its last decision"""

BLOCK = 1 << 14
"""Commands worked out at once where single ones are asked for"""
BLOCKS = 32
"""of such blocks, how many are kept: 8 MB"""


class RowsByRobot:
    """Rows of a table with the columns ``step`` and ``robot``, by robot, then step."""

    def __init__(self, rows: NDArray[np.void]) -> None:
        self._robot, self._step = rows["robot"], rows["step"]
        self.order = np.lexsort((self._step, self._robot))
        """(M,) row numbers, those of the first robot first, each robot's in the order of steps"""
        self._span = int(self._step.max(initial=0)) + 2
        self._keys = self._key(self._robot, self._step)[self.order]

    def last(self, robot: IntArray | int, step: IntArray | int) -> IntArray:
        """Number of the last row of each robot at or before each step; -1 before its first."""
        at = np.searchsorted(self._keys, self._key(robot, step), side="right") - 1
        if not len(self._keys):
            return np.asarray(at)
        row = self.order[at]
        return np.where((at >= 0) & (self._robot[row] == robot), row, -1)

    def at(self, robot: IntArray | int, step: IntArray | int) -> IntArray:
        """Number of the row of each robot at each step; -1 where there is none."""
        row = self.last(robot, step)
        if not len(self._keys):
            return row
        return np.where((row >= 0) & (self._step[row] == step), row, -1)

    def _key(self, robot: IntArray | int, step: IntArray | int) -> IntArray:
        key = np.asarray(robot, dtype=np.int64) * self._span + np.minimum(step, self._span - 1)
        return np.asarray(key)


class DecisionTable:
    """Decisions by robot, and the commands that robots were driven by."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.decisions = RowsByRobot(record.updates)
        """rows of the update table"""
        self.commands = RowsByRobot(record.commands)
        """rows of the table of commands"""
        self.radius = record.shapes.radius
        """(N,) [m] of the circle round each reference point that holds the footprint"""

    def steps(self, robot: int) -> IntArray:
        """Steps at which a robot decided, increasing."""
        rows = self.record.updates
        return np.asarray(rows["step"][rows["robot"] == robot])

    def last(self, robot: int, step: int) -> np.void | None:
        """Last decision of a robot at or before a step; None before its first."""
        row = int(self.decisions.last(robot, step))
        return None if row < 0 else self.record.updates[row]

    def held(self, robot: int, step: int) -> tuple[float, float]:
        """Command (v [m/s], omega [rad/s]) that drives a robot over the step from a sample on.

        That is the applied one; 0 before its first decision.
        """
        block, place = divmod(step, self._block_steps)
        v, omega = self._held_block(block)[place, robot].tolist()
        return v, omega

    @property
    def _block_steps(self) -> int:
        return max(1, BLOCK // self.record.robots)

    @cached_property
    def _held_block(self) -> Callable[[int], FloatArray]:
        """Makes a block of the applied commands by its number; the last few are kept."""
        steps, over = self._block_steps, self.record.commands_over
        return lru_cache(BLOCKS)(lambda k: over("applied", k * steps, (k + 1) * steps))

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

    def last_before(self, robots: list[int], step: int) -> int | None:
        """Step of the last decision of any of these robots before a step."""
        rows = [row for row in (self.last(i, step - 1) for i in robots) if row is not None]
        return max((int(row["step"]) for row in rows), default=None)


class SampleBlock(NamedTuple):
    """B consecutive samples of a record and the decisions made at them."""

    first: int
    """step of the first sample"""
    pose: FloatArray
    """(B, N, 3)"""
    course: FloatArray
    """(B, N, 3) station, deviation, reference station [m], computed from the poses"""
    held: FloatArray
    """(B, N, 2) nominal commands held before each of these steps, as a snapshot has them"""
    rows: NDArray[np.void]
    """decisions at these samples, rows of the update table"""
    row: int
    """number of the first of them in the table"""

    @property
    def reference_station(self) -> FloatArray:
        """(B, N) [m] along s*."""
        return self.course[:, :, 2]

    @property
    def at(self) -> NDArray[np.int64]:
        """(M,) which of the samples each decision was made at."""
        return np.asarray(self.rows["step"] - self.first, dtype=np.int64)


def sample_blocks(record: Record) -> Iterator[SampleBlock]:
    """Blocks of a record that holds the poses of every step. Each decision comes once."""
    updates, radius = record.updates, record.shapes.radius
    tracking = None
    for pose, first in pose_blocks(record):
        if tracking is None:
            tracking = Tracking(record.paths, record.reference, radius, pose[0])
        course = tracking.course(pose)  # its first sample is the last of the block before: it stays
        last = first + len(pose)
        end = last if last >= record.samples else last - 1
        low, high = (int(k) for k in np.searchsorted(updates["step"], (first, end)))
        held = read_only(record.commands_over("nominal", first - 1, last - 1))
        yield SampleBlock(first, pose, course, held, updates[low:high], low)
