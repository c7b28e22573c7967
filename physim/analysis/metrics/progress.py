"""How far robots came: who is active, who has arrived, and what keeps the others.

A robot is active, under way, until it is at its stop station, less the world's tolerance; it has
arrived once it stands there (see `physim.simulation.arrival`). Both are decided by places, never by
what a controller says of itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.analysis.metrics.metric import Each, Series
from physim.errors import PhysimError
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record
from physim.simulation.arrival import STILL_TIME, most_beside, still_distances, still_steps
from physim.tolerances import LENGTH

Rows = NDArray[np.void]

ASTRAY = 1.0
"""[m] from its path beyond which a robot that has not arrived is said to be off it"""
BACKWARDS = 90.0
"""[deg] from the direction of its path beyond which it is said to be turned"""
MOST_MOMENTS = 2_000_000
"""Values of a course of all robots, about: of longer runs moments are farther apart."""
GRID = 0.1
"""[s] between two values of a course over time: the longest update interval (14)"""
MOST_COMMANDS = 500_000
"""Commands of robots and steps that are looked at together."""


def active_decisions(record: Record) -> tuple[Rows, FloatArray]:
    """Decisions of robots that are not at their stop station, and the steps that each held."""
    rows = record.updates
    rows = rows[~_at_stop(record, rows)]
    until = np.minimum(rows["next_step"], record.steps_run)
    return rows, np.maximum(until - rows["step"], 0).astype(np.float64)


def active_steps(record: Record) -> IntArray:
    """(N,) steps from the start until each robot was at its stop station for good.

    By its samples, and by its decisions between the last of them away from there and the next;
    between two of these its station is taken to be linear. To the end of the run where it was not
    there. By its arrival in a record without samples.
    """
    if not record.samples:
        return np.asarray(np.where(record.arrived >= 0, record.arrived, record.steps_run))
    station, least = record.course[:, :, 0], record.stop_station - arrival_tolerance(record)
    away = active_samples(record)
    last = np.where(away.any(axis=0), record.samples - 1 - np.argmax(away[::-1], axis=0), -1)
    steps = np.where(last < 0, 0, record.steps_run)
    (robots,) = np.nonzero((last >= 0) & (last < record.samples - 1))
    decisions = rows_of_robots(record)
    for i in robots.tolist():
        rows, k = decisions[i], last[i]
        rows = rows[(rows["step"] > record.steps[k]) & (rows["step"] < record.steps[k + 1])]
        at = np.concatenate((record.steps[k : k + 1], rows["step"], record.steps[k + 1 : k + 2]))
        known = np.concatenate((station[k : k + 1, i], rows["station"], station[k + 1 : k + 2, i]))
        j = int(np.flatnonzero(known < least[i])[-1])
        share = (least[i] - known[j]) / (known[j + 1] - known[j])
        steps[i] = at[j] + np.ceil(share * (at[j + 1] - at[j]) - 1e-9)
    return np.asarray(steps)


def active_samples(record: Record) -> NDArray[np.bool_]:
    """(K, N) whether each robot is not at its stop station at each sample."""
    return np.asarray(record.course[:, :, 0] < record.stop_station - arrival_tolerance(record))


def finished(record: Record) -> bool:
    """Whether all robots have arrived at their stop stations, by their motion."""
    return record.robots > 0 and bool((record.arrived >= 0).all())


def time_to_finish(record: Record) -> float | None:
    """Time at which the last robot had arrived [s]; None for a run that did not finish."""
    return float(record.arrived.max() * record.dt) if finished(record) else None


def stop_distance(record: Record) -> Each | None:
    """Distances [m] of all robots from their stop stations at the last sample, and the largest.

    None of a run that did not finish.
    """
    if not finished(record):
        return None
    paths = zip(pairwise(record.paths.start), record.stop_station.tolist(), strict=True)
    stops = [
        shapely.line_interpolate_point(shapely.LineString(record.paths.points[a:b]), station)
        for (a, b), station in paths
    ]
    away = np.hypot(*(record.pose[-1, :, :2] - shapely.get_coordinates(stops)).T)
    return Each(float(away.max()), tuple(away.tolist()))


@dataclass(frozen=True)
class Absent:
    """A robot that has not arrived at the end of a run, and why."""

    robot: int
    short: float
    """[m] along its path from where it is to its stop station; negative when past it"""
    tolerance: float
    """[m] by which it may be short, or past"""
    stands: bool
    """it moved no more in the last 0.5 s than one that stands may"""
    beside: float = 0.0
    """[m] how far it is from the nearest point of that part of its path"""
    turned: float = 0.0
    """[deg] from the direction of its path there, 0 to 180"""
    room: float = np.inf
    """[m] that it may be beside"""

    def sentence(self, name: str) -> str:
        """Why robot ``name`` has not arrived."""
        if abs(self.short) > self.tolerance:
            side = "short of" if self.short > 0.0 else "past"
            away, allowed = _lengths(abs(self.short), self.tolerance)
        elif self.beside > self.room:
            side, (away, allowed) = "beside", _lengths(self.beside, self.room)
        elif self.stands:
            return f"{name} is at its stop station, but has not stood there for {STILL_TIME:g} s"
        else:
            return f"{name} still moves at its stop station"
        off, where = self._off(), f"{away} m {side} its stop station"
        if self.stands:
            return f"{name} stands {where} (tolerance {allowed} m){off}"
        return f"{name} still moves, {where}{off}"

    @property
    def is_astray(self) -> bool:
        """Whether it is so far off its path, or so turned, that it does not follow it."""
        return self.beside > ASTRAY or self.turned > BACKWARDS

    def _off(self) -> str:
        """How a robot that no longer follows its path lies to it; empty for others."""
        where = [f"{self.beside:.1f} m off its path"] if self.beside > ASTRAY else []
        if self.turned > BACKWARDS:
            where.append(f"turned {self.turned:.0f}° from its direction")
        return f": it is {' and '.join(where)}" if where else ""


def _lengths(away: float, allowed: float) -> tuple[str, str]:
    """How far a robot is away, and may be, with as many digits as they need to differ."""
    digits = 2 if away < 10.0 else 1
    while f"{away:.{digits}f}" == f"{allowed:.{digits}f}" and digits < 9:
        digits += 1
    return f"{away:.{digits}f}", f"{allowed:.{max(digits, 2)}f}"


def absent(record: Record) -> tuple[Absent, ...]:
    """Robots that have not arrived at the end of the run, by index; none of a run without poses."""
    if not record.samples:
        return ()
    still = _stood(record)
    station, tolerance = last_stations(record), arrival_tolerance(record)
    room = most_beside(record.shapes, record.course[0, :, 1])
    found = []
    for i in np.flatnonzero(record.arrived < 0).tolist():
        past, beside, turned = _astray(record, i, float(station[i]))
        short = float(record.stop_station[i] - station[i]) - past
        found.append(Absent(i, short, tolerance, bool(still[i]), beside, turned, float(room[i])))
    return tuple(found)


def _stood(record: Record) -> NDArray[np.bool_]:
    """(N,) whether robots stood for the last `STILL_TIME`, by its samples.

    Where none begins it, samples being far apart: no sample since the one before shows a robot
    elsewhere, or none within it does and no more was commanded; of a shorter run the share of it.
    """
    begin = record.time[-1] - STILL_TIME
    first = int(np.searchsorted(record.time, begin - 1e-9))
    off = record.pose[max(first - 1, 0) :, :, :2] - record.pose[-1, :, :2]
    most = still_distances(record.shapes.radius[: record.robots])
    near = np.hypot(*off.transpose(2, 0, 1)) <= most
    within = near[min(first, 1) :].all(axis=0)
    if record.time[first] <= begin + 1e-9:
        return np.asarray(within)
    last, steps = record.steps_run, still_steps(record.dt)
    applied = record.commands_over("applied", max(0, last - steps), last)
    commanded = np.abs(applied[:, :, 0]).sum(axis=0) * record.dt
    idle = commanded <= most * min(last, steps) / steps
    return np.asarray((within & idle) | (near.all(axis=0) & (first > 0)))


def _astray(record: Record, robot: int, station: float) -> tuple[float, float, float]:
    """How far [m] a robot is at the end past its path, whose nearest point has this station, and
    beside it, and how it is turned [deg]."""
    lines = record.paths
    a, b = lines.start[robot : robot + 2]
    points, at = lines.points[a:b], lines.station[a:b]
    k = int(np.clip(np.searchsorted(at, station, side="right") - 1, 0, len(at) - 2))
    along = (points[k + 1] - points[k]) / (at[k + 1] - at[k])
    x, y, heading = record.pose[-1, robot]
    way = (x, y) - points[k] - (station - at[k]) * along
    past = max(float(way @ along), 0.0) if station >= at[-1] - LENGTH else 0.0
    beside = np.hypot(*(way - past * along))
    turned = abs((heading - np.arctan2(along[1], along[0]) + np.pi) % (2.0 * np.pi) - np.pi)
    return past, float(beside), float(np.degrees(turned))


def last_stations(record: Record) -> FloatArray:
    """(N,) [m] station of each robot on its own path at the last sample.

    The nearest point of the path, no farther along it from the station of the robot's last decision
    than the robot has moved since, since a path may pass near itself.
    """
    found = np.zeros(record.robots)
    rows = dict(zip(record.updates["robot"][(last := last_decisions(record))], last, strict=True))
    lines = record.paths
    for i, (a, b) in enumerate(pairwise(lines.start)):
        near, reach, points, at = 0.0, np.inf, lines.points[a:b], lines.station[a:b]
        if i in rows:
            row = record.updates[rows[i]]
            first = int(np.searchsorted(record.steps, row["step"]))
            moves = np.diff(record.pose[max(first - 1, 0) :, i, :2], axis=0)
            near, reach = float(row["station"]), 1.0 + 2.0 * float(np.hypot(*moves.T).sum())
        along = np.diff(points, axis=0)
        here = record.pose[-1, i, :2] - points[:-1]
        share = np.clip((here * along).sum(axis=1) / np.square(along).sum(axis=1), 0.0, 1.0)
        station = at[:-1] + share * np.diff(at)
        gap = np.hypot(*(here - share[:, None] * along).T)
        gap[np.abs(station - near) > reach] = np.inf
        found[i] = station[int(np.argmin(gap))] if np.isfinite(gap).any() else near
    return found


def arrival_tolerance(record: Record) -> float:
    """[m] by which a robot may be short of its stop station, or past it: the world's, or 0.1."""
    arrival = record.world_settings.get("arrival")
    tolerance = arrival.get("tolerance") if isinstance(arrival, Mapping) else None
    if isinstance(tolerance, float) or (isinstance(tolerance, int) and abs(tolerance) < 2**63):
        return float(tolerance)
    from physim.world import Arrival

    return Arrival().tolerance


def active_time(record: Record) -> FloatArray:
    """(N,) [s] that the decisions of each robot held before it was at its stop station."""
    rows, held = active_decisions(record)
    return np.asarray(np.bincount(rows["robot"], held, record.robots) * record.dt)


def ratio(part: NDArray[Any], whole: NDArray[Any]) -> Each | None:
    """``part / whole`` (N,) of all robots together, and of each; None where there is no whole."""
    if not whole.sum() > 0:
        return None
    each = (float(p / w) if w > 0 else None for p, w in zip(part, whole, strict=True))
    return Each(float(part.sum() / whole.sum()), tuple(each))


def last_decisions(record: Record) -> IntArray:
    """Row of the last decision of each robot that has made one, by robot."""
    robots = record.updates["robot"]
    _, from_end = np.unique(robots[::-1], return_index=True)
    return (len(robots) - 1 - from_end).astype(np.int64)


def blocks(record: Record) -> Iterator[tuple[int, int]]:
    """First step and one past the last of stretches of the run whose commands fit into memory."""
    size = max(1, MOST_COMMANDS // max(1, record.robots))
    for first in range(0, record.steps_run, size):
        yield first, min(first + size, record.steps_run)


def check_positive(name: str, value: float) -> None:
    """Raise PhysimError unless a time [s] that was given is positive and finite."""
    if not (isinstance(value, int | float | np.number) and 0.0 < value < float("inf")):
        raise PhysimError(f"{name}: a positive number of seconds; given: {value!r}")


def spacing(record: Record, every: float) -> float:
    """``every`` [s], or more where a course of all robots would have `MOST_MOMENTS`.

    Raises PhysimError unless it is positive.
    """
    check_positive("every", every)
    duration = record.steps_run * record.dt
    return max(every, duration * max(record.robots, 1) / MOST_MOMENTS)


def grid(record: Record, every: float = GRID) -> FloatArray:
    """Times (K,) [s] from 0 on, ``every`` [s] apart (`spacing`), and the end of the run."""
    every, end = spacing(record, every), record.steps_run * record.dt
    times: FloatArray = every * np.arange(float(int(end / every + 1e-9) + 1))
    return np.append(times, end) if end > times[-1] + 1e-9 else times


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


def samples_over_time(record: Record, samples: FloatArray, every: float = GRID) -> Series:
    """Values (K, N) of robots at the samples as a course: linear between them, held after the last.

    NaN in a record without samples.
    """
    time = grid(record, every)
    values = np.full((len(time), record.robots), np.nan)
    if record.samples:
        for robot in range(record.robots):
            values[:, robot] = np.interp(time, record.time, samples[:, robot])
    return Series(time, values)


def _at_stop(record: Record, rows: Rows) -> NDArray[np.bool_]:
    """Whether each decision was made at the stop station, less the tolerance."""
    least = record.stop_station - arrival_tolerance(record)
    return np.asarray(rows["station"] >= least[rows["robot"]])
