"""Records with rows made by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from physim.contacts import CONTACT
from physim.geometry.shapes import FloatArray
from physim.record import Record, RecordWriter
from physim.record.layout import EXTREME, FARTHEST, UPDATE
from tests.records import make_scene


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
) -> Record:
    """Record with these rows; contacts are (step, a, b, phase, depth, impulse).

    Updates are put in the order of steps and hold for one step unless they say otherwise;
    ``pose`` (K, N, 3) are the samples 0 to K - 1.
    """
    out = RecordWriter(None, make_scene(robots), world, name="by hand")
    rows = np.zeros(len(updates), UPDATE)
    rows["collision_time"] = np.inf
    for row, values in zip(rows, updates, strict=True):
        for key, value in values.items():
            row[key] = value
        if "next_step" not in values:
            row["next_step"] = row["step"] + 1
    out.append_updates(rows[np.argsort(rows["step"], kind="stable")])
    touching = np.zeros(len(contacts), CONTACT)
    for name, column in zip(
        ("step", "a", "b", "phase", "depth", "impulse"), zip(*contacts, strict=True), strict=False
    ):
        touching[name] = column
    out.append_contacts(touching)
    if pose is not None:
        none = np.full(pose.shape[:2], np.inf)
        out.append_steps(np.arange(len(pose)), pose, none, none)
    if extremes:
        far = None if farthest is None else np.array(farthest, FARTHEST)
        out.set_extremes(np.array(list(extremes), EXTREME), far)
    out.close("duration", steps_run=steps_run, rejected=0, wall_clock={})
    return out.record()
