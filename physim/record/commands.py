"""Commands of all robots over consecutive steps, from the decisions and the table of commands."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from physim.geometry.shapes import FloatArray

if TYPE_CHECKING:
    from physim.record.reader import Record

Stage = Literal["nominal", "filtered", "applied"]


def commands_over(record: Record, stage: Stage, first: int, last: int) -> FloatArray:
    """See `Record.commands_over`."""
    steps, robots = max(0, last - first), record.robots
    held = np.zeros((steps, robots, 2))
    updates = record.updates
    nominal = np.stack((updates["nominal_v"], updates["nominal_omega"]), axis=1)
    end = int(np.searchsorted(updates["step"], last))
    at = np.zeros((steps, robots), dtype=np.int64)  # row + 1 of the decision that holds
    begin = int(np.searchsorted(updates["step"], first, side="right"))
    if steps:
        before = updates["robot"][:begin]
        robot, from_end = np.unique(before[::-1], return_index=True)
        at[0, robot] = begin - from_end
        rows = np.arange(begin, end)
        at[updates["step"][rows] - first, updates["robot"][rows]] = rows + 1
        np.maximum.accumulate(at, axis=0, out=at)
        known = at > 0
        held[known] = nominal[at[known] - 1]
        table = record.commands
        a, b = np.searchsorted(table["step"], (first, last))
        mine = table[a:b]
        place = mine["step"] - first, mine["robot"]
        held[place] = np.stack((mine[f"{stage}_v"], mine[f"{stage}_omega"]), axis=1)
    return held
