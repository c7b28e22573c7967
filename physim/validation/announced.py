"""Are all decisions there? Each says when its robot decides next; every robot begins at once."""

from __future__ import annotations

import numpy as np

from physim.record import Record
from physim.validation.decisions import DecisionTable
from physim.validation.mismatch import Mismatches


def check_schedule(record: Record, table: DecisionTable, found: Mismatches) -> None:
    """Hold the step of every decision against what the one before announced.

    A run whose robots were told what to do from outside has no decisions at all.
    """
    rows = record.updates
    if not record.steps_run or (not len(rows) and len(record.commands)):
        return
    order = table.decisions.order
    robot, step, due = (rows[name][order] for name in ("robot", "step", "next_step"))
    begins = np.diff(robot, prepend=-1) != 0
    for k in np.flatnonzero(begins & (step != 0)).tolist():
        found.add(
            "/updates", "step", int(step[k]), 0, "as every robot decides at the start",
            row=int(order[k]), robot=int(robot[k]), step=int(step[k]),
        )  # fmt: skip
    for i in np.setdiff1d(np.arange(record.robots), robot).tolist():
        found.add(
            "/updates", "robot", "nowhere", "deciding at the start", "as every robot is", robot=i,
            step=0,
        )  # fmt: skip
    after = np.append(step[1:], 0)
    last = np.append(begins[1:], True) if len(rows) else begins
    lost = np.where(last, due < record.steps_run, due != after)
    for k in np.flatnonzero(lost).tolist():
        found.add(
            "/updates", "next_step", int(due[k]),
            "never" if last[k] else int(after[k]),
            "by the next decision of that robot in the table",
            row=int(order[k]), robot=int(robot[k]), step=int(step[k]),
        )  # fmt: skip
    late = rows["step"] > record.steps_run - (0 if record.ended == "running" else 1)
    found.add_rows("/updates", "step", rows, 0, late, record.steps_run - 1, "at the latest")
