"""Applied commands from one change to the next: of a run of many steps there are few."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record

MOST_COMMANDS = 500_000
"""Commands that are looked at in one go."""


class Held:
    """The applied commands of a run at any of its steps, as `Record.commands_over` gives them."""

    def __init__(self, record: Record) -> None:
        self.robots = record.robots
        updates, table = record.updates, record.commands
        self._decided, self._changed = (
            [rows[rows["robot"] == robot] for robot in range(record.robots)]
            for rows in (updates, table)
        )
        steps = updates["step"], table["step"], table["step"] + 1
        self.changes: IntArray = np.unique(np.concatenate(([0, record.steps_run], *steps)))
        """steps from which on a command may be another, with the first and the last"""

    def at(self, steps: IntArray) -> FloatArray:
        """(K, N, 2) v [m/s] and omega [rad/s] that are applied in steps (K,)."""
        found = np.zeros((len(steps), self.robots, 2))
        for robot, (decided, changed) in enumerate(zip(self._decided, self._changed, strict=True)):
            row = np.searchsorted(decided["step"], steps, side="right") - 1
            there = row >= 0
            place = np.minimum(np.searchsorted(changed["step"], steps), len(changed) - 1)
            for column, name in enumerate(("v", "omega")):
                found[there, robot, column] = decided[f"nominal_{name}"][row[there]]
                if len(changed):
                    here = changed["step"][place] == steps
                    found[here, robot, column] = changed[f"applied_{name}"][place[here]]
        return found

    def stretches(self, *others: IntArray) -> Iterator[tuple[IntArray, FloatArray]]:
        """Steps (K + 1,) between which no command changes, and the commands (K, N, 2) held there.

        A piece of the run at a time, each from the last step of the one before; ``others`` are
        among the steps, those within the run.
        """
        at = np.unique(np.concatenate((self.changes, *others)))
        at = at[(at >= 0) & (at <= self.changes[-1])]
        size = max(1, MOST_COMMANDS // max(1, self.robots))
        for first in range(0, len(at) - 1, size):
            piece = at[first : first + size + 1]
            yield piece, self.at(piece[:-1])
