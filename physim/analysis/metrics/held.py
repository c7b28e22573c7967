"""Applied commands of a robot from one change to the next: of a run of many steps there are few."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record


class Held:
    """The applied commands of a run, robot by robot, as `Record.commands_over` gives them."""

    def __init__(self, record: Record) -> None:
        self.last = record.steps_run
        updates, table = record.updates, record.commands
        self._decided = by_robot(updates, updates["robot"], record.robots)
        self._changed = by_robot(table, table["robot"], record.robots)

    def stretches(self, robot: int, *others: IntArray) -> tuple[IntArray, FloatArray]:
        """Steps (K + 1,) between which its command does not change, and the K commands (K, 2).

        v [m/s] and omega [rad/s]; from 0 to the last step of the run, with those of ``others``.
        """
        decided, changed = self._decided[robot], self._changed[robot]
        run = np.array([0, self.last], dtype=np.int64)
        ends = (run, decided["step"], changed["step"], changed["step"] + 1, *others)
        at: IntArray = np.unique(np.concatenate(ends))
        at = at[(at >= 0) & (at <= self.last)]
        begin = at[:-1]
        found = np.zeros((len(begin), 2))
        row = np.searchsorted(decided["step"], begin, side="right") - 1
        place = np.minimum(np.searchsorted(changed["step"], begin), len(changed) - 1)
        here = changed["step"][place] == begin if len(changed) else np.zeros(len(begin), np.bool_)
        for column, name in enumerate(("v", "omega")):
            found[row >= 0, column] = decided[f"nominal_{name}"][row[row >= 0]]
            found[here, column] = changed[f"applied_{name}"][place[here]]
        return at, found


def by_robot(rows: NDArray[Any], robot: IntArray, robots: int) -> list[NDArray[Any]]:
    """Rows (M,) of each of N robots, in their order; ``robot`` (M,) says whose they are."""
    order = np.argsort(robot, kind="stable")
    ends = np.searchsorted(robot[order], np.arange(1, robots))
    return np.split(rows[order], ends)
