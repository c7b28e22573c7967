"""The commands of a record: within limits, and the same in both tables.

A row of ``/commands`` stands where the stages of a command differ, or where the nominal one is not
that of the last decision; where there is none, the nominal command of the last decision was
applied. So each row must say something, and what stages there were must explain it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.scene import Scene
from physim.tolerances import SHARE
from physim.validation.mismatch import Mismatches, keys

PARTS = ("v", "omega")
Rows = NDArray[np.void]


def check_commands(
    record: Record, scene: Scene | None, stages: Sequence[str] | None, found: Mismatches
) -> None:
    """Hold both tables of commands against each other, the limits and the stages there were.

    ``stages`` are words of the kinds of stages of the run ("filter", "disturbance"); None where
    that is not known.
    """
    _same_in_both(record, found)
    _stages(record, stages, found)
    if scene is not None:
        _limits(record, scene, found)
    late = record.commands["step"] >= max(record.steps_run, 1)
    if record.ended != "running":
        found.add_rows(
            "/commands", "step", record.commands, 0, late, record.steps_run - 1, "at the latest"
        )


def last_decided(record: Record) -> FloatArray:
    """(R, 2) nominal command of the last decision up to each row of /commands; 0 before any."""
    rows, table = record.updates, record.commands
    order = np.lexsort((rows["step"], rows["robot"]))
    span = record.steps_run + 2

    def place(some: Rows) -> NDArray[np.int64]:
        return np.asarray(some["robot"].astype(np.int64) * span + some["step"])

    at = np.searchsorted(place(rows[order]), place(table), side="right") - 1
    known = at >= 0
    known[known] = rows["robot"][order][at[known]] == table["robot"][known]
    command = np.zeros((len(table), 2))
    for k, part in enumerate(PARTS):
        command[known, k] = rows[f"nominal_{part}"][order][at[known]]
    return command


def _same_in_both(record: Record, found: Mismatches) -> None:
    """Applied commands of decisions are those of their step; each row of /commands says more."""
    rows, table = record.updates, record.commands
    key, at = keys(record, table["step"], table["robot"]), keys(record, rows["step"], rows["robot"])
    order = np.argsort(key)
    place = np.searchsorted(key[order], at)
    place[place == len(key)] = 0
    listed = key[order][place] == at if len(key) else np.zeros(len(rows), dtype=np.bool_)
    for part in PARTS:
        exact = rows[f"nominal_{part}"].copy()
        exact[listed] = table[f"applied_{part}"][order][place[listed]]
        wrong = rows[f"applied_{part}"] != exact
        by = "by the table /commands and the nominal command"
        found.add_rows("/updates", f"applied_{part}", rows, 0, wrong, exact, by)
    alike = np.ones(len(table), dtype=np.bool_)
    for k, part in enumerate(PARTS):
        nominal, filtered, applied = (
            table[f"{stage}_{part}"] for stage in ("nominal", "filtered", "applied")
        )
        alike &= (nominal == last_decided(record)[:, k]) & (filtered == nominal)
        alike &= applied == filtered
    for k in np.flatnonzero(alike).tolist():
        found.add(
            "/commands", None, "there", "not", "as all stages are the command last decided",
            row=k, robot=int(table["robot"][k]), step=int(table["step"][k]),
        )  # fmt: skip


def _stages(record: Record, stages: Sequence[str] | None, found: Mismatches) -> None:
    """Commands may change from one stage to the next only where there is something in between."""
    table = record.commands
    decided = last_decided(record)
    for k, part in enumerate(PARTS):
        pairs = [
            ("filtered", f"nominal_{part}", "filter", "by the nominal command: there is no filter"),
            ("applied", f"filtered_{part}", "disturbance",
             "by the filtered command: there is no disturbance"),
        ]  # fmt: skip
        for stage, before, word, by in pairs:
            if stages is not None and word not in stages:
                column = f"{stage}_{part}"
                wrong = table[column] != table[before]
                found.add_rows("/commands", column, table, 0, wrong, table[before], by)
        if len(record.updates):
            column, by = f"nominal_{part}", "by the last decision of that robot"
            wrong = table[column] != decided[:, k]
            found.add_rows("/commands", column, table, 0, wrong, decided[:, k], by)


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
