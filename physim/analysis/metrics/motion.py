"""How robots moved: deviation from their paths, averaged speeds, and formation (Figs. 1, 2, 7).

Formation errors and formation energy follow (7) to (10). A run has formation errors when its
world has a formation and more than one robot.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from physim.analysis.metrics.held import Held
from physim.analysis.metrics.metric import Each, Moment, Series
from physim.analysis.metrics.progress import (
    GRID,
    Rows,
    active_decisions,
    active_steps,
    column_over_time,
    last_decisions,
    ratio,
    spacing,
)
from physim.analysis.metrics.travelled import looked_at, travelled
from physim.errors import RecordError
from physim.geometry.shapes import FloatArray
from physim.record import Record

WINDOW = 10.0
"""[s] window of averaged speeds (paper)"""


class AveragedSpeeds(NamedTuple):
    """Speeds averaged over a window about each moment, NaN where not wholly active."""

    time: FloatArray
    """(K,) [s] middle of the window"""
    forward: FloatArray
    """(K, N) [m/s] along the heading, backwards negative"""
    rotational: FloatArray
    """(K, N) [rad/s] left positive"""


def deviations(record: Record, every: float = GRID) -> Series:
    """Signed deviation of each robot from its own path over time (Figs. 1b, 2c, 7d).

    Values (K, N) [m], left of the path positive; exact at the robot's decisions, linear between.
    """
    return column_over_time(record, "deviation", every)


def deviation_peak(record: Record) -> Moment | None:
    """Deviation of greatest size at a decision, with its sign [m] (Figs. 1b, 2c, 7d)."""
    size = np.abs(record.updates["deviation"])
    if not np.isfinite(size).any():
        return None
    row = record.updates[int(np.nanargmax(size))]
    step = int(row["step"])
    return Moment(float(row["deviation"]), step, step * record.dt, int(row["robot"]))


def deviation_rms(record: Record) -> Each | None:
    """Root of the mean square deviation over the active time [m], of all robots and of each.

    That of a decision counts as long as it held: what lies between decisions is not seen, so that
    it errs to either side, by 1 to 3 % where they are 0.2 s apart.
    """
    rows, held = active_decisions(record)
    held = np.where(np.isfinite(rows["deviation"]), held, 0.0)
    square = held * np.square(np.nan_to_num(rows["deviation"]))
    total = np.bincount(rows["robot"], held, record.robots)
    part = np.bincount(rows["robot"], square, record.robots)
    mean = ratio(part, total)
    if mean is None:
        return None
    each = (None if square is None else sqrt(square) for square in mean.robots)
    return Each(sqrt(mean.value), tuple(each))


def mean_speed(record: Record) -> float | None:
    """Mean applied forward speed over time of all active robots [m/s] (Fig. 7).

    From the first command of each on. None where none was recorded.
    """
    ends, begins = active_steps(record), np.full(record.robots, record.steps_run)
    for rows in (record.updates, record.commands):
        np.minimum.at(begins, rows["robot"], rows["step"])
    distance = total = 0.0
    held = Held(record)
    for robot in range(record.robots):
        at, applied = held.stretches(robot, begins[robot : robot + 1], ends[robot : robot + 1])
        counts = (at[:-1] >= begins[robot]) & (at[:-1] < ends[robot])
        steps = np.diff(at) * counts
        distance += float(applied[:, 0] @ steps)
        total += float(steps.sum())
    return distance / total if total > 0 else None


def averaged_speeds(record: Record, window: float = WINDOW, every: float = GRID) -> AveragedSpeeds:
    """Speeds averaged over ``window`` [s] about each moment (Figs. 1c, 7b, 7c).

    As the robots moved (`physim.analysis.metrics.travelled`): the distance along the heading and
    the turn between the ends of the window, over its length. Defined where the whole window lies
    before the robot is at its stop station.
    """
    end, every = record.steps_run * record.dt, spacing(record, every)
    count = int((end - window) / every + 1e-9) + 1 if end >= window - 1e-9 else 0
    if record.samples < 2 or not count:
        return AveragedSpeeds(np.zeros(0), *np.zeros((2, 0, record.robots)))
    middle: FloatArray = window / 2.0 + every * np.arange(float(count))
    ends = middle - window / 2.0, middle + window / 2.0
    steps = looked_at(record, ends)
    courses = travelled(record, steps)
    forward, rotational = (np.full((len(middle), record.robots), np.nan) for _ in range(2))
    arrival = active_steps(record) * record.dt
    for i in range(record.robots):
        whole = ends[1] <= min(arrival[i], end) + 1e-9
        for out, course in zip((forward, rotational), courses, strict=True):
            first, last = (np.interp(one[whole], steps * record.dt, course[:, i]) for one in ends)
            out[whole, i] = (last - first) / window
    return AveragedSpeeds(middle, forward, rotational)


def averaged_extreme(
    time: FloatArray, values: FloatArray, dt: float, largest: bool
) -> Moment | None:
    """Largest or smallest of the averaged speeds (K, N) of robots."""
    if not np.isfinite(values).any():
        return None
    place = int(np.nanargmax(values) if largest else np.nanargmin(values))
    k, robot = np.unravel_index(place, values.shape)
    at = float(time[k])
    return Moment(float(values[k, robot]), round(at / dt), at, int(robot))


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
    pairs, reach = _listed(record, plan), plan.get("range", RANGE)
    if not isinstance(reach, int | float):
        raise RecordError(f"{record.where}: the world inside: formation.range is no number")
    energy = np.empty(len(time))
    for k, s in enumerate(station):
        centre = s - lead  # the formation's, as each robot's station and place give it
        errors = np.square(centre[:, None] - centre)
        near = np.abs(s[:, None] - s) <= reach if pairs is None else pairs
        energy[k] = 0.5 * (errors * near).sum()  # (9)
    return Series(time, energy)


def desired_leads(record: Record) -> FloatArray | None:
    """Desired place of each robot on s* less the robots' mean place, (N,) [m], left of (7).

    None in a run without formation.
    """
    return record.lead - record.lead.mean() if has_formation(record) else None


def _listed(record: Record, plan: Mapping[str, Any]) -> FloatArray | None:
    """(N, N) 1 where j is in N_i; None when neighbours are those within range.

    Raises RecordError where the world inside has something else there.
    """
    neighbours, names = plan.get("neighbours", "range"), record.names
    if neighbours == "range":
        return None
    if neighbours == "all":
        return np.ones((len(names), len(names)))
    listed = np.zeros((len(names), len(names)))
    try:
        pairs = [(names.index(a), names.index(b)) for a, b in neighbours]
    except (TypeError, ValueError):
        raise RecordError(
            f"{record.where}: the world inside: formation.neighbours is neither range nor all, nor "
            "pairs of names of its robots"
        ) from None
    for i, j in pairs:
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
