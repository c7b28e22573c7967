"""Commands and counts of a record against each other.

A row of ``/commands``
stands where the stages of a command differ, or where the nominal one is not that of the last
decision; where there is none, the nominal command of the last decision was applied. So each row
must say something, and what stages there were must explain it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from physim.analysis.validation.decisions import DecisionTable
from physim.analysis.validation.mismatch import Mismatches
from physim.analysis.validation.origin import Inside
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.record.layout import OPTIONAL
from physim.tolerances import SHARE
from physim.world.scene import Scene

PARTS = ("v", "omega")


def check_commands(record: Record, table: DecisionTable, inside: Inside, found: Mismatches) -> None:
    """Hold both tables of commands against each other, the limits and the stages there were."""
    decided = _last_decided(record, table)
    _same_in_both(record, table, decided, found)
    _stages(record, decided, inside.stages, found)
    if inside.scene is not None:
        _limits(record, inside.scene, found)
    beyond = record.commands["step"] >= max(record.steps_run, 1)
    if record.ended != "running":
        found.add_rows(
            "/commands", "step", record.commands, 0, beyond, record.steps_run - 1, "at the latest"
        )


def _last_decided(record: Record, table: DecisionTable) -> dict[str, FloatArray]:
    """v and omega (R,) of the last decision up to each row of /commands; 0 before any."""
    row = table.decisions.last(record.commands["robot"], record.commands["step"])
    known = row >= 0
    decided = {part: np.zeros(len(row)) for part in PARTS}
    for part, values in decided.items():
        values[known] = record.updates[f"nominal_{part}"][row[known]]
    return decided


def _same_in_both(
    record: Record, table: DecisionTable, decided: dict[str, FloatArray], found: Mismatches
) -> None:
    """Applied commands of decisions are those of their step; each row of /commands says more."""
    rows, commands = record.updates, record.commands
    row = table.commands.at(rows["robot"], rows["step"])
    listed = row >= 0
    alike = np.ones(len(commands), dtype=np.bool_)
    by = "by the table /commands and the nominal command"
    for part in PARTS:
        exact = rows[f"nominal_{part}"].copy()
        exact[listed] = commands[f"applied_{part}"][row[listed]]
        wrong = rows[f"applied_{part}"] != exact
        found.add_rows("/updates", f"applied_{part}", rows, 0, wrong, exact, by)
        nominal, filtered, applied = (
            commands[f"{stage}_{part}"] for stage in ("nominal", "filtered", "applied")
        )
        alike &= (nominal == decided[part]) & (filtered == nominal) & (applied == filtered)
    for k in np.flatnonzero(alike).tolist():
        found.add(
            "/commands", None, "there", "not", "as all stages are the command last decided",
            row=k, robot=int(commands["robot"][k]), step=int(commands["step"][k]),
        )  # fmt: skip


def _stages(
    record: Record,
    decided: dict[str, FloatArray],
    stages: Sequence[str] | None,
    found: Mismatches,
) -> None:
    """Commands may change from one stage to the next only where there is something in between."""
    commands = record.commands
    for part in PARTS:
        pairs = [
            ("filtered", f"nominal_{part}", "filter", "by the nominal command: there is no filter"),
            ("applied", f"filtered_{part}", "disturbance",
             "by the filtered command: there is no disturbance"),
        ]  # fmt: skip
        for stage, before, word, by in pairs:
            if stages is not None and word not in stages:
                column = f"{stage}_{part}"
                wrong = commands[column] != commands[before]
                found.add_rows("/commands", column, commands, 0, wrong, commands[before], by)
        if len(record.updates):
            column, by = f"nominal_{part}", "by the last decision of that robot"
            wrong = commands[column] != decided[part]
            found.add_rows("/commands", column, commands, 0, wrong, decided[part], by)


def _limits(record: Record, scene: Scene, found: Mismatches) -> None:
    """Nominal and filtered commands are within the limits of their robots."""
    for name, rows, stages in (
        ("/updates", record.updates, ("nominal",)),
        ("/commands", record.commands, ("nominal", "filtered")),
    ):
        for k, part in enumerate(PARTS):
            limit = scene.limits[rows["robot"], k]
            for stage in stages:
                column = f"{stage}_{part}"
                wrong = ~(np.abs(rows[column]) <= limit * (1.0 + SHARE))
                by = "at most either way, by the limits of that robot in the world inside"
                found.add_rows(name, column, rows, 0, wrong, limit, by)


def check_counts(record: Record, found: Mismatches) -> None:
    """Hold counts and lists in attributes against the tables."""
    if "false_contacts" in record.tables:
        killed = record.ended == "running"  # it would have counted them in the end
        count = 0 if killed else len(record.false_contacts)
        if record.rejected_contacts != count:
            found.add(
                "attribute", "rejected_contacts", record.rejected_contacts, count,
                "by the table /false_contacts",
            )  # fmt: skip
    for table in OPTIONAL:
        if table not in record.tables and (rows := len(record.read(f"/{table}"))):
            found.add(
                "attribute", "tables", f"without {table}", f"with {table}",
                f"by that table, which has {rows} rows",
            )  # fmt: skip
    steps = record.steps[1:]
    exact = (np.arange(len(steps)) + 1) * record.record_every
    if len(exact):
        exact[-1] = min(int(exact[-1]), int(steps[-1]))
    wrong = np.flatnonzero(steps != exact)
    for k in wrong[:1].tolist():
        apart = int(steps[k] - (steps[k - 1] if k else 0))
        found.add(
            "attribute", "record_every", record.record_every, apart, "by the recorded steps"
        )  # fmt: skip
