"""Formation errors and formation energy, (7) to (10) (Figs. 2, 7).

A run has formation errors when its world has a formation and more than one robot.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.metrics.values import Each, Moment, Series
from physim.metrics.way import GRID, Rows, column_over_time, last_decisions
from physim.record import Record

MOST_PAIRS = 30_000_000
"""Pairs of robots and moments that `formation_energy` looks at, about: bounds its time."""
RANGE = 10.0
"""[m] `range` of a formation that does not give it (paper)"""


def has_formation(record: Record) -> bool:
    """Whether formation errors mean something: a formation, and two robots at least."""
    return record.robots > 1 and isinstance(record.world_settings.get("formation"), Mapping)


def formation_error_peak(record: Record) -> Moment | None:
    """Largest absolute formation error at a decision, (10) [m] (Figs. 2, 7)."""
    return _largest_error(record, record.updates)


def formation_error_final(record: Record) -> Moment | None:
    """Largest absolute formation error at the last decision of each robot, (10) [m]."""
    return _largest_error(record, record.updates[last_decisions(record)])


def formation_error_rms(record: Record) -> Each | None:
    """Root of the mean square of the formation errors over time [m], of all robots and of each."""
    course = formation_errors(record)
    if course is None or not np.isfinite(course.values).any():
        return None
    square = np.square(course.values)
    each = tuple(
        float(np.sqrt(np.nanmean(column))) if np.isfinite(column).any() else None
        for column in square.T
    )
    return Each(float(np.sqrt(np.nanmean(square))), each)


def formation_errors(record: Record, every: float = GRID) -> Series | None:
    """Formation error of each robot over time, (10): values (K, N) [m].

    Positive for a robot that is behind its place. Exact at the robot's decisions and linear
    between them. None in a run without formation.
    """
    return column_over_time(record, "formation_error", every) if has_formation(record) else None


def formation_energy(record: Record, every: float = GRID) -> Series | None:
    """Formation energy W over time, (9): values (K,) [m^2]. None in a run without formation.

    Of the stations on s* at the decisions, taken linear between them; None where a robot made none.
    Pairs are those of N_i: within the world's ``formation.range`` along s* at that moment, all, or
    listed. With many robots the moments are farther apart than ``every`` [s].
    """
    lead = desired_leads(record)
    if lead is None:
        return None
    moments = record.steps_run * record.dt / every + 1.0
    every *= max(1.0, np.ceil(moments * record.robots**2 / MOST_PAIRS))
    time, station = column_over_time(record, "reference_station", every)
    if not np.isfinite(station).all():
        return None
    plan = record.world_settings["formation"]
    pairs, reach = _listed(plan, record.names), float(plan.get("range", RANGE))
    energy = np.empty(len(time))
    for k, s in enumerate(station):
        late = s - lead
        errors = np.square(late[:, None] - late)
        near = np.abs(s[:, None] - s) <= reach if pairs is None else pairs
        energy[k] = 0.5 * (errors * near).sum()  # (9)
    return Series(time, energy)


def desired_leads(record: Record) -> FloatArray | None:
    """Desired place of each robot on s* less the robots' mean place, (N,) [m], left of (7).

    None in a run without formation.
    """
    return record.lead - record.lead.mean() if has_formation(record) else None


def _listed(plan: Mapping[str, Any], names: Sequence[str]) -> FloatArray | None:
    """(N, N) 1 where j is in N_i; None when neighbours are those within range."""
    neighbours = plan.get("neighbours", "range")
    if neighbours == "range":
        return None
    if neighbours == "all":
        return np.ones((len(names), len(names)))
    listed = np.zeros((len(names), len(names)))
    for a, b in neighbours:
        i, j = names.index(a), names.index(b)
        listed[i, j] = listed[j, i] = 1.0
    return listed


def _largest_error(record: Record, rows: Rows) -> Moment | None:
    if not has_formation(record):
        return None
    errors = np.abs(rows["formation_error"])
    if not np.isfinite(errors).any():
        return None
    row = rows[int(np.nanargmax(errors))]
    step = int(row["step"])
    return Moment(abs(float(row["formation_error"])), step, step * record.dt, int(row["robot"]))
