"""Decisions of a run by robot: the last one before a step, and the command applied at a step."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.geometry.path import path_length, project, track
from physim.geometry.shapes import IntArray
from physim.record import Record
from physim.validation.ledger import robot_shapes

WINDOW = 2.0
"""[m] least stretch of the reference path in which a robot is looked for after its last decision"""


class DecisionTable:
    """Rows of the update table by robot, and the commands that robots were driven by."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.rows = record.updates
        order = np.argsort(self.rows["robot"], kind="stable")
        sorted_robots = self.rows["robot"][order]
        edges = np.searchsorted(sorted_robots, np.arange(record.robots + 1))
        self._index = [order[edges[i] : edges[i + 1]] for i in range(record.robots)]
        self._steps = [self.rows["step"][index] for index in self._index]
        changed = _keys(record, record.commands["step"], record.commands["robot"])
        self._command_row = np.argsort(changed)
        self._changed = changed[self._command_row]
        self.radius = robot_shapes(record).radius
        """(N,) [m] of the circle round each reference point that holds the footprint"""

    def steps(self, robot: int) -> IntArray:
        """Steps at which a robot decided, increasing."""
        return self._steps[robot]

    def of(self, robot: int) -> NDArray[np.void]:
        """Decisions of a robot, rows of the update table in the order of steps."""
        rows: NDArray[np.void] = self.rows[self._index[robot]]
        return rows

    def last(self, robot: int, step: int) -> np.void | None:
        """Last decision of a robot at or before a step; None before its first."""
        place = int(np.searchsorted(self._steps[robot], step, side="right")) - 1
        return None if place < 0 else self.rows[self._index[robot][place]]

    def held(self, robot: int, step: int) -> tuple[float, float]:
        """Command (v [m/s], omega [rad/s]) that drives a robot over the step from a sample on.

        That is the applied one; 0 before its first decision.
        """
        key = _keys(self.record, step, robot)
        place = int(np.searchsorted(self._changed, key))
        if place < len(self._changed) and self._changed[place] == key:
            row = self.record.commands[self._command_row[place]]
            return float(row["applied_v"]), float(row["applied_omega"])
        last = self.last(robot, step)
        if last is None:
            return 0.0, 0.0
        return float(last["nominal_v"]), float(last["nominal_omega"])

    def reference_station(self, robot: int, step: int) -> float:
        """Projection [m] of a robot on the reference path s* at a recorded step.

        Followed from its last decision, so that a path that passes near itself does not mislead.
        """
        record, row = self.record, self.last(robot, step)
        x, y, _ = record.read("/steps/pose", step, step + 1)[0, robot]
        lines = record.reference
        if row is None or not np.isfinite(row["reference_station"]):
            return float(project(lines, 0, x, y, 0.0, path_length(lines, 0))[0])
        seconds = (step - int(row["step"])) * record.dt
        window = WINDOW + 2.0 * abs(float(row["applied_v"])) * seconds
        return float(track(lines, 0, x, y, float(row["reference_station"]), window)[0])


def _keys(record: Record, step: IntArray | int, robot: IntArray | int) -> IntArray:
    """One number for step and robot, increasing with the rows of a table."""
    return np.asarray(np.asarray(step, dtype=np.int64) * record.robots + robot)


def last_before(table: DecisionTable, robots: list[int], step: int) -> int | None:
    """Step of the last decision of any of these robots before a step."""
    rows: list[NDArray[np.void] | np.void | None] = [table.last(i, step - 1) for i in robots]
    steps = [int(row["step"]) for row in rows if row is not None]
    return max(steps, default=None)
