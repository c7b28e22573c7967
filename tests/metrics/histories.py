"""Records with rows made by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from physim.contacts import CONTACT_ROW
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import NO_NUMBER, Declared
from physim.record import Record, RecordWriter
from physim.record.layout import COMMAND, EXTREME, FARTHEST, OPTIONAL, update_type
from tests.records import DECLARED, make_scene

THERE = 1000.0
"""[m] a station past every stop station"""


def history(
    updates: Sequence[dict[str, Any]] = (),
    contacts: Sequence[tuple[Any, ...]] = (),
    *,
    robots: int = 2,
    steps_run: int = 100,
    extremes: Sequence[tuple[Any, ...]] = (),
    farthest: tuple[Any, ...] | None = None,
    world: str = "formation: {}",
    pose: FloatArray | None = None,
    arrived: Sequence[int] | None = None,
    declared: Declared = DECLARED,
    commands: Sequence[tuple[Any, ...]] = (),
    tables: Sequence[str] = OPTIONAL,
    lead: FloatArray | None = None,
) -> Record:
    """Record with these rows; contacts are (step, a, b, phase, depth, impulse).

    Updates are put in the order of steps and hold for one step unless they say otherwise; the
    command in them is nominal and applied. ``commands`` are rows of `COMMAND`; ``pose`` (K, N, 3)
    are the samples 0 to K - 1; ``arrived`` (N,) is as in `Record.arrived`, ``lead`` as in
    `Record.lead`.
    """
    scene = make_scene(robots)
    if lead is not None:
        scene.formation.lead = lead
    out = RecordWriter(None, scene, world, name="by hand", declared=declared, tables=tables)
    rows = np.zeros(len(updates), update_type([column.name for column in declared.columns]))
    rows["mode"] = 0 if declared.modes else NO_NUMBER
    rows["rule"] = 0 if declared.rules else NO_NUMBER
    if "collision_time" in (rows.dtype.names or ()):
        rows["collision_time"] = np.inf
    for row, values in zip(rows, updates, strict=True):
        for key, value in values.items():
            row[key] = value
        for part in ("v", "omega"):
            row[f"applied_{part}"] = values.get(f"applied_{part}", row[f"nominal_{part}"])
        if "next_step" not in values:
            row["next_step"] = row["step"] + 1
    out.append("updates", rows[np.argsort(rows["step"], kind="stable")])
    if commands:
        out.append("commands", np.array(list(commands), COMMAND))
    touching = np.zeros(len(contacts), CONTACT_ROW)
    for name, column in zip(
        ("step", "a", "b", "phase", "depth", "impulse"), zip(*contacts, strict=True), strict=False
    ):
        touching[name] = column
    out.append("contacts", touching)
    if pose is not None:
        none = np.full(pose.shape[:2], np.inf)
        out.append_steps(np.arange(len(pose)), pose, none, none)
    if extremes:
        out.extremes.rows[:] = np.array(list(extremes), EXTREME)
        if farthest is not None:
            out.extremes.farthest[...] = np.array(farthest, FARTHEST)
    if arrived is not None:
        out.note_arrived(np.array(arrived))
    out.close("duration", steps_run=steps_run, rejected=0, wall_clock={})
    return out.record()
