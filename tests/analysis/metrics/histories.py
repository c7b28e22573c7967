"""Records with rows made by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from physim.contacts import CONTACT_ROW
from physim.record import Record, RecordWriter
from tests.helpers import inside
from tests.helpers.records import DECLARED, make_scene

FloatArray, IntArray = inside("physim.geometry", "FloatArray", "IntArray")
NO_NUMBER, Declared = inside("physim.parts", "NO_NUMBER", "Declared")
COMMAND, EXTREME, FARTHEST = inside("physim.record", "COMMAND", "EXTREME", "FARTHEST")
OPTIONAL, update_type = inside("physim.record", "OPTIONAL", "update_type")


def beside_paths(deviations: FloatArray) -> FloatArray:
    """Poses (K, N, 3) of robots beside the middle of the first, straight leg of their own paths.

    ``deviations`` (K, N) [m], left positive.
    """
    paths = make_scene(deviations.shape[1]).paths
    pose = np.zeros((*deviations.shape, 3))
    pose[:, :, 0] = 6.0
    pose[:, :, 1] = paths.points[paths.start[:-1], 1] + deviations
    return pose


def along_reference(steps: IntArray, stations: FloatArray) -> FloatArray:
    """Poses (K, N, 3) at steps 0 to the last of ``steps`` (M,), on s*.

    Stations (M, N) [m] are those at these steps, and linear between them.
    """
    lines = make_scene(stations.shape[1]).reference
    time = np.arange(int(steps[-1]) + 1)
    station = np.stack([np.interp(time, steps, one) for one in stations.T], axis=1)
    pose = np.zeros((*station.shape, 3))
    for k in (0, 1):
        pose[:, :, k] = np.interp(station, lines.station, lines.points[:, k])
    return pose


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
    stops: FloatArray | None = None,
) -> Record:
    """Record with these rows; contacts are (step, a, b, phase, depth, impulse, kind).

    Updates are put in the order of steps and hold for one step unless they say otherwise; the
    command in them is nominal and applied. ``commands`` are rows of `COMMAND`; ``pose`` (K, N, 3)
    are the samples 0 to K - 1; ``arrived`` (N,) is as in `Record.arrived`, ``lead`` as in
    `Record.lead`, ``stops`` (N,) as in `Record.stop_station`.
    """
    scene = make_scene(robots)
    if lead is not None:
        scene.formation.lead = lead
    if stops is not None:
        scene.stop_station = stops
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
        ("step", "a", "b", "phase", "depth", "impulse", "kind"),
        zip(*contacts, strict=True),
        strict=False,
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


def mean_squares(values: FloatArray) -> FloatArray:
    """(N,) mean squares of values (K, N) of samples a step apart, linear between: by 1,000 each."""
    at = (np.arange(1000.0 * (len(values) - 1)) + 0.5) / 1000.0
    fine = [np.interp(at, np.arange(float(len(values))), column) for column in values.T]
    return np.asarray(np.square(fine).mean(axis=1))
