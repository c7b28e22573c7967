"""Modes over time: shares of safe and danger mode, switches between them (Fig. 8)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.declared import NO_NUMBER
from physim.geometry.shapes import FloatArray
from physim.metrics.values import DangerShare, Each
from physim.metrics.way import Rows, rows_of_robots, under_way
from physim.record import Record

SPAN = np.dtype([("robot", "<i4"), ("mode", "i1"), ("begin", "<f8"), ("end", "<f8")])
"""A stretch of time [s] in which a robot's decisions all had one mode."""


def danger_shares(record: Record) -> tuple[DangerShare, ...]:
    """Share of danger mode of each robot, by decisions and by time (Fig. 8).

    Danger is every mode that the controller declares as such; decisions of a robot at its stop
    station, or that gave no mode, do not count at all. Without such modes every share is None.
    """
    rows, held = _with_mode(record)
    pairs = zip(_shares(record, rows, np.ones(len(rows))), _shares(record, rows, held), strict=True)
    return tuple(DangerShare(i, *pair) for i, pair in enumerate(pairs))


def danger_time_share(record: Record) -> float | None:
    """Share of danger mode of all robots together, by time under way [-].

    None where the controller declares no mode of danger, and where no decision gave a mode.
    """
    rows, held = _with_mode(record)
    return float(held[is_danger(record, rows)].sum() / held.sum()) if held.sum() > 0 else None


def share_of_modes(record: Record, danger: bool) -> Each | None:
    """Share of danger or of safe mode by time [-], of all robots together and of each."""
    share = danger_time_share(record)
    if share is None:
        return None
    each = (one.time for one in danger_shares(record))
    if danger:
        return Each(share, tuple(each))
    return Each(1.0 - share, tuple(None if one is None else 1.0 - one for one in each))


def mode_switches(record: Record) -> Each | None:
    """Changes between safe and danger mode a minute under way [1/min].

    Of a mean robot (all changes over all robots' time) and of each; changes between the two kinds
    of danger do not count.
    """
    minutes, rows = time_under_way(record) / 60.0, _with_mode(record)[0]
    if not minutes.sum() > 0 or not len(rows):
        return None
    count = np.zeros(record.robots)
    for robot in range(record.robots):
        mine = rows[rows["robot"] == robot]
        count[robot] = np.count_nonzero(np.diff(is_danger(record, mine)))
    each = tuple(float(c / m) if m > 0 else None for c, m in zip(count, minutes, strict=True))
    return Each(float(count.sum() / minutes.sum()), each)


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


def time_under_way(record: Record) -> FloatArray:
    """(N,) [s] that the decisions of each robot held before it was at its stop station."""
    rows, held = under_way(record)
    return np.asarray(np.bincount(rows["robot"], held, record.robots) * record.dt)


def has_danger(record: Record) -> bool:
    """Whether the controller declares a mode of danger."""
    return any(mode.danger for mode in record.modes)


def is_danger(record: Record, rows: Rows) -> NDArray[np.bool_]:
    """Whether each decision is in a mode that the controller declares as danger."""
    danger = np.array([*(mode.danger for mode in record.modes), False])
    return np.asarray(danger[rows["mode"]])  # NO_NUMBER is the last


def _with_mode(record: Record) -> tuple[Rows, FloatArray]:
    """Decisions under way that gave a mode, and the steps that each held; see `under_way`.

    None of a controller without modes of danger: what is not danger would not be safe either.
    """
    rows, held = under_way(record)
    told = (rows["mode"] != NO_NUMBER) & has_danger(record)
    return rows[told], held[told]


def _shares(record: Record, rows: Rows, weight: FloatArray) -> list[float | None]:
    total = np.bincount(rows["robot"], weight, record.robots)
    part = np.bincount(rows["robot"], weight * is_danger(record, rows), record.robots)
    return [float(p / t) if t > 0 else None for p, t in zip(part, total, strict=True)]
