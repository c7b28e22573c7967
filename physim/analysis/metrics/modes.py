"""Decisions: shares of safe and danger mode, switches between them (Fig. 8), and their cost (14).

The cost is counted in decisions, messages and collision times computed.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from physim.analysis.metrics.metric import Each
from physim.analysis.metrics.progress import (
    Rows,
    active_decisions,
    active_time,
    ratio,
    rows_of_robots,
)
from physim.geometry.shapes import FloatArray
from physim.parts.declarations import NO_NUMBER
from physim.record import Record

SPAN = np.dtype([("robot", "<i4"), ("mode", "i1"), ("begin", "<f8"), ("end", "<f8")])
"""A stretch of time [s] in which a robot's decisions all had one mode."""


def share_of_modes(record: Record, danger: bool) -> Each | None:
    """Share of danger or of safe mode by active time [-], of all robots together and of each.

    Danger is every mode that the controller declares as such; each decision weighs as long as it
    held. None where it declares none, and where no decision of a robot under way gave a mode.
    """
    rows, held = _with_mode(record)
    found = is_danger(record, rows) == danger
    total = np.bincount(rows["robot"], held, record.robots)
    return ratio(np.bincount(rows["robot"], held * found, record.robots), total)


def mode_switches(record: Record) -> Each | None:
    """Changes between safe and danger mode a minute of active time [1/min].

    Of a mean robot (all changes over all robots' time) and of each; changes between the two kinds
    of danger do not count.
    """
    rows, _ = _with_mode(record)
    if not len(rows):
        return None
    rows = rows[np.argsort(rows["robot"], kind="stable")]
    changes = np.diff(is_danger(record, rows)) & (np.diff(rows["robot"]) == 0)
    count = np.bincount(rows["robot"][1:][changes], minlength=record.robots)
    return ratio(count, active_time(record) / 60.0)


def mode_spans(record: Record) -> NDArray[np.void]:
    """Stretches of one mode, rows of `SPAN`, by robot and time; they fill the run (Fig. 8)."""
    end = record.steps_run * record.dt
    spans = [np.zeros(0, SPAN)]
    for robot, rows in enumerate(rows_of_robots(record)):
        first = np.flatnonzero(np.diff(rows["mode"], prepend=np.int8(-2)) != 0)
        mine = np.zeros(len(first), SPAN)
        mine["robot"], mine["mode"] = robot, rows["mode"][first]
        mine["begin"] = rows["step"][first] * record.dt
        mine["end"][:-1] = mine["begin"][1:]
        mine["end"][-1:] = np.maximum(end, mine["begin"][-1:])
        spans.append(mine)
    return np.concatenate(spans)


def is_danger(record: Record, rows: Rows) -> NDArray[np.bool_]:
    """Whether each decision is in a mode that the controller declares as danger."""
    danger = np.array([*(mode.danger for mode in record.modes), False])
    return np.asarray(danger[rows["mode"]])  # NO_NUMBER is the last


def danger_of(record: Record, robots: Collection[int]) -> float | None:
    """Share of danger mode by active time [-] of some robots; None as `share_of_modes`."""
    rows, held = _with_mode(record)
    mine = np.isin(rows["robot"], list(robots))
    total = float(held[mine].sum())
    return float(held[mine & is_danger(record, rows)].sum()) / total if total > 0.0 else None


def _with_mode(record: Record) -> tuple[Rows, FloatArray]:
    """Decisions of active robots that gave a mode, and the steps held; see `active_decisions`.

    None of a controller without modes of danger: what is not danger would not be safe either.
    """
    rows, held = active_decisions(record)
    given = (rows["mode"] != NO_NUMBER) & any(mode.danger for mode in record.modes)
    return rows[given], held[given]


def messages(record: Record) -> int | None:
    """Messages that the decisions needed: one for each considered robot and decision, (14)."""
    return int(record.updates["considered"].sum()) if "updates" in record.tables else None


def evaluations(record: Record) -> int | None:
    """Collision times worked out; None where the controller does not report them."""
    count = record.column("evaluations", absent=np.nan)
    with np.errstate(over="ignore"):
        total = np.nansum(count)
    return int(total) if np.isfinite(count).any() and np.isfinite(total) else None


def differing_steps(record: Record, one: str, other: str) -> int:
    """Robot-steps over which the commands of two stages differ."""
    rows = record.commands  # at every step at which any stage differs from another
    differ = rows[f"{one}_v"] != rows[f"{other}_v"]
    return int((differ | (rows[f"{one}_omega"] != rows[f"{other}_omega"])).sum())


def updates_per_second(record: Record) -> Each | None:
    """Decisions a second of active time [1/s], of a mean robot and of each, (14)."""
    rows, _ = active_decisions(record)
    return ratio(np.bincount(rows["robot"], minlength=record.robots), active_time(record))
