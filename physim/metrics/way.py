"""Decisions of robots under way, and when each arrived."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from physim.geometry.shapes import FloatArray, IntArray
from physim.metrics.values import Series
from physim.record import Record

Rows = NDArray[np.void]

GRID = 0.1
"""[s] between two values of a course over time: the longest update interval (14)"""


def under_way(record: Record) -> tuple[Rows, FloatArray]:
    """Decisions of robots that have not arrived, and the steps that each held within the run."""
    rows = record.updates
    since = record.arrived[rows["robot"]]
    rows = rows[(since < 0) | (rows["step"] < since)]
    until = np.minimum(rows["next_step"], record.steps_run)
    return rows, np.maximum(until - rows["step"], 0).astype(np.float64)


def last_decisions(record: Record) -> IntArray:
    """Row of the last decision of each robot that has made one, by robot."""
    robots = record.updates["robot"]
    _, from_end = np.unique(robots[::-1], return_index=True)
    return (len(robots) - 1 - from_end).astype(np.int64)


def arrival_steps(record: Record) -> IntArray:
    """Sample (N,) from which on each robot has arrived, to the end; -1 if it has not."""
    return record.arrived


def finished(record: Record) -> bool:
    """Whether all robots have arrived at their stop stations."""
    return record.robots > 0 and bool((arrival_steps(record) >= 0).all())


def time_to_finish(record: Record) -> float | None:
    """Time at which the last robot arrived for good [s]; None for a run that did not finish."""
    return float(arrival_steps(record).max() * record.dt) if finished(record) else None


def grid(record: Record, every: float = GRID) -> FloatArray:
    """Times (K,) [s] from 0 to the end of the run, ``every`` [s] apart."""
    count = int(record.steps_run * record.dt / every + 1e-9) + 1
    return np.asarray(every * np.arange(float(count)))


def rows_of_robots(record: Record) -> list[Rows]:
    """Decisions of each of the N robots, in the order of time."""
    rows = record.updates
    order = np.argsort(rows["robot"], kind="stable")
    ends = np.searchsorted(rows["robot"][order], np.arange(record.robots + 1))
    return [rows[order[a:b]] for a, b in zip(ends[:-1], ends[1:], strict=True)]


def column_over_time(record: Record, name: str, every: float = GRID) -> Series:
    """A column of the decisions as a course of each robot: values (K, N).

    Exact at decisions, linear between them, held after the last; NaN for a robot without any.
    """
    time = grid(record, every)
    values = np.full((len(time), record.robots), np.nan)
    for robot, rows in enumerate(rows_of_robots(record)):
        rows = rows[np.isfinite(rows[name])]
        if len(rows):
            values[:, robot] = np.interp(time, rows["step"] * record.dt, rows[name])
    return Series(time, values)
