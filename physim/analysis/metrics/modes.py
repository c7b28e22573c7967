"""Decisions: shares of safe and danger mode, switches between them (Fig. 8), and their cost (14).

The cost is counted in updates, messages and collision times computed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.analysis.metrics.metric import DangerShare, Each
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


def danger_shares(record: Record) -> tuple[DangerShare, ...]:
    """Share of danger mode of each robot, by decisions and by time (Fig. 8).

    Danger is every mode that the controller declares as such; decisions of a robot at its stop
    station, or that gave no mode, do not count at all. Without such modes every share is None.
    """
    rows, held = _with_mode(record)
    none = Each(0.0, (None,) * record.robots)
    by_decisions = _danger_share(record, rows, np.ones(len(rows))) or none
    by_time = _danger_share(record, rows, held) or none
    pairs = zip(by_decisions.robots, by_time.robots, strict=True)
    return tuple(DangerShare(i, *pair) for i, pair in enumerate(pairs))


def danger_time_share(record: Record) -> float | None:
    """Share of danger mode of all robots together, by active time [-].

    None where the controller declares no mode of danger, and where no decision gave a mode.
    """
    share = _danger_share(record, *_with_mode(record))
    return None if share is None else share.value


def share_of_modes(record: Record, danger: bool) -> Each | None:
    """Share of danger or of safe mode by time [-], of all robots together and of each."""
    share = _danger_share(record, *_with_mode(record))
    if share is None or danger:
        return share
    each = (None if one is None else 1.0 - one for one in share.robots)
    return Each(1.0 - share.value, tuple(each))


def mode_switches(record: Record) -> Each | None:
    """Changes between safe and danger mode a minute of active time [1/min].

    Of a mean robot (all changes over all robots' time) and of each; changes between the two kinds
    of danger do not count.
    """
    rows, _ = _with_mode(record)
    if not len(rows):
        return None
    count = np.zeros(record.robots)
    for robot in range(record.robots):
        mine = rows[rows["robot"] == robot]
        count[robot] = np.count_nonzero(np.diff(is_danger(record, mine)))
    return ratio(count, active_time(record) / 60.0)


def mode_spans(record: Record) -> NDArray[np.void]:
    """Stretches of one mode, rows of `SPAN`, by robot and time; they fill the run (Fig. 8)."""
    end = record.steps_run * record.dt
    spans = []
    for robot, rows in enumerate(rows_of_robots(record)):
        if not len(rows):
            continue
        first = np.flatnonzero(np.concatenate(([True], np.diff(rows["mode"]) != 0)))
        mine = np.zeros(len(first), SPAN)
        mine["robot"], mine["mode"] = robot, rows["mode"][first]
        mine["begin"] = rows["step"][first] * record.dt
        mine["end"] = np.append(mine["begin"][1:], max(end, float(mine["begin"][-1])))
        spans.append(mine)
    return np.concatenate(spans) if spans else np.zeros(0, SPAN)


def is_danger(record: Record, rows: Rows) -> NDArray[np.bool_]:
    """Whether each decision is in a mode that the controller declares as danger."""
    danger = np.array([*(mode.danger for mode in record.modes), False])
    return np.asarray(danger[rows["mode"]])  # NO_NUMBER is the last


def _with_mode(record: Record) -> tuple[Rows, FloatArray]:
    """Decisions of active robots that gave a mode, and the steps held; see `active_decisions`.

    None of a controller without modes of danger: what is not danger would not be safe either.
    """
    rows, held = active_decisions(record)
    given = (rows["mode"] != NO_NUMBER) & any(mode.danger for mode in record.modes)
    return rows[given], held[given]


def _danger_share(record: Record, rows: Rows, weight: FloatArray) -> Each | None:
    """Share of danger mode in decisions of these weights."""
    total = np.bincount(rows["robot"], weight, record.robots)
    return ratio(np.bincount(rows["robot"], weight * is_danger(record, rows), record.robots), total)


def decisions(record: Record) -> int | None:
    """Number of decisions of all robots; None where they were not recorded."""
    return len(record.updates) if "updates" in record.tables else None


def messages(record: Record) -> int | None:
    """Messages that the decisions needed: one for each considered robot and decision, (14)."""
    return None if decisions(record) is None else int(record.updates["considered"].sum())


def evaluations(record: Record) -> int | None:
    """Collision times worked out; None where the controller does not report them."""
    count = record.column("evaluations", absent=np.nan)
    with np.errstate(over="ignore"):
        total = np.nansum(count)
    return int(total) if np.isfinite(count).any() and np.isfinite(total) else None


def filtered_steps(record: Record) -> int:
    """Robot-steps over which the filtered command differs from the nominal one."""
    return _differing(record, "nominal", "filtered")


def disturbed_steps(record: Record) -> int:
    """Robot-steps over which the applied command differs from the filtered one."""
    return _differing(record, "filtered", "applied")


def _differing(record: Record, one: str, other: str) -> int:
    rows = record.commands  # at every step at which any stage differs from another
    differ = rows[f"{one}_v"] != rows[f"{other}_v"]
    return int((differ | (rows[f"{one}_omega"] != rows[f"{other}_omega"])).sum())


def updates_per_second(record: Record) -> Each | None:
    """Decisions a second of active time [1/s], of a mean robot and of each, (14)."""
    rows, _ = active_decisions(record)
    return ratio(np.bincount(rows["robot"], minlength=record.robots), active_time(record))
