"""How far robots came: who is active, who has arrived, and what keeps the others.

A robot is active, under way, until it is at its stop station, less the world's tolerance; it has
arrived once it stands there (see `physim.simulation.arrival`). Both are decided by places, never by
what a controller says of itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physim.analysis.metrics.metric import Each, Series, section
from physim.errors import PhysimError
from physim.geometry.motion import twists
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record
from physim.simulation.arrival import STILL_TIME, most_beside, still_distances
from physim.tolerances import LENGTH
from physim.world import Arrival

Rows = NDArray[np.void]

ASTRAY = 1.0
"""[m] from its path beyond which a robot that has not arrived is said to be off it"""
BACKWARDS = 90.0
"""[deg] from the direction of its path beyond which it is said to be turned"""
MOST_MOMENTS = 2_000_000
"""Values of a course of all robots, about: of longer runs moments are farther apart."""
ADVANCE = 0.1
"""[m] along its path by which a robot must come farther than ever before, else it got nowhere"""
LATELY = 5.0
"""[s] before the end of a run that show how far a robot came of late"""
LITTLE = 0.5
"""[m] A robot that moves, but came less far of late, is said to get nowhere."""
GRID = 0.1
"""[s] between two values of a course over time: the longest update interval (14)"""
MOST_COMMANDS = 500_000
"""Commands of robots and steps that are looked at together."""


def active_decisions(record: Record) -> tuple[Rows, FloatArray]:
    """Decisions of robots that are not at their stop station, and the steps that each held."""
    rows, least = record.updates, record.stop_station - arrival_tolerance(record)
    rows = rows[rows["station"] < least[rows["robot"]]]
    until = np.minimum(rows["next_step"], record.steps_run)
    return rows, np.maximum(until - rows["step"], 0).astype(np.float64)


def active_time(record: Record) -> FloatArray:
    """(N,) [s] that the decisions of each robot held before it was at its stop station."""
    rows, held = active_decisions(record)
    return np.asarray(np.bincount(rows["robot"], held, record.robots) * record.dt)


def active_samples(record: Record) -> NDArray[np.bool_]:
    """(K, N) whether each robot is not at its stop station at each sample."""
    return np.asarray(record.course[:, :, 0] < record.stop_station - arrival_tolerance(record))


def active_steps(record: Record) -> IntArray:
    """(N,) step from which on each robot was at its stop station for good.

    By its samples, and by its decisions between the last of them away from there and the next;
    between two of these its station is taken to be linear. To the end of the run where it was not
    there. By its arrival in a record without samples.
    """
    if not record.samples:
        return np.asarray(np.where(record.arrived >= 0, record.arrived, record.steps_run))
    away, least = active_samples(record), record.stop_station - arrival_tolerance(record)
    found = np.full(record.robots, record.steps_run)
    decisions = rows_of_robots(record)
    for i in range(record.robots):
        samples = np.flatnonzero(away[:, i])[-1:]
        if not len(samples):
            found[i] = record.begun_at
        elif (k := int(samples[0])) < record.samples - 1:
            rows, ends = decisions[i], slice(k, k + 2)
            rows = rows[(rows["step"] > record.steps[k]) & (rows["step"] < record.steps[k + 1])]
            at = np.insert(record.steps[ends], 1, rows["step"])
            known = np.insert(record.course[ends, i, 0], 1, rows["station"])
            j = int(np.flatnonzero(known < least[i])[-1])
            share = (least[i] - known[j]) / (known[j + 1] - known[j])
            found[i] = at[j] + np.ceil(share * (at[j + 1] - at[j]) - 1e-9)
    return found


def finished(record: Record) -> bool:
    """Whether all robots have arrived at their stop stations, by their motion."""
    return record.robots > 0 and bool((record.arrived >= 0).all())


def time_to_finish(record: Record) -> float | None:
    """Time at which the last robot had arrived [s]; None for a run that did not finish."""
    return float(record.arrived.max() * record.dt) if finished(record) else None


def standstill(record: Record) -> float | None:
    """For how long [s] before the end no robot advanced `ADVANCE` along its path, unless it had
    arrived; 0 of a run that finished, None without samples.

    A robot advances where its station is larger than ever before, so that one that goes to and fro
    gets nowhere.
    """
    if not record.samples or not record.robots:
        return None
    late = record.arrived < 0
    farthest = np.maximum.accumulate(record.course[:, late, 0], axis=0)
    came = farthest[-1] - farthest
    since = int(np.argmax((came < ADVANCE).all(axis=1)))
    return float(record.time[-1] - record.time[since]) if late.any() else 0.0


def stop_distance(record: Record) -> Each | None:
    """Distances [m] of all robots from their stop stations at the last sample, and the largest.

    None of a run that did not finish.
    """
    if not finished(record):
        return None
    lines, away = record.paths, []
    for i, station in enumerate(record.stop_station):
        mine = slice(*lines.start[i : i + 2])
        stop = [np.interp(station, lines.station[mine], xy) for xy in lines.points[mine].T]
        away.append(float(np.hypot(*(record.pose[-1, i, :2] - stop))))
    return Each(max(away), tuple(away))


@dataclass(frozen=True)
class Absent:
    """A robot that has not arrived at the end of a run, and why."""

    robot: int
    short: float
    """[m] along its path from where it is, or before the path begins, to its stop station;
    negative when past it"""
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
    behind: float = 0.0
    """[m] how far before the beginning of its path it is"""
    pace: float = np.inf
    """[m/s] from where it was `LATELY` ago, or at the start, to where it is"""

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
        off = [f"{self.behind:.1f} m before its path begins"] if self.behind > ASTRAY else []
        off += [f"{self.beside:.1f} m off its path"] if self.beside > ASTRAY else []
        if self.turned > BACKWARDS:
            off.append(f"turned {self.turned:.0f}° from its direction")
        lies = f": it is {' and '.join(off)}" if off else ""
        where = f"{away} m {side} its stop station"
        if self.stands:
            return f"{name} stands {where} (tolerance {allowed} m){lies}"
        came = self.pace * LATELY
        little = f"; it came only {came:.2f} m in the last {LATELY:g} s" if came < LITTLE else ""
        return f"{name} still moves, {where}{lies}{little}"

    @property
    def is_astray(self) -> bool:
        """Whether it is so far off its path, or so turned, that it does not follow it."""
        return max(self.beside, self.behind) > ASTRAY or self.turned > BACKWARDS


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
    tolerance = arrival_tolerance(record)
    # they stand whom all samples since the last one before the final half second show there
    begin = record.time[-1] - STILL_TIME
    first = max(int(np.searchsorted(record.time, begin + 1e-9, side="right")) - 1, 0)
    off = record.pose[first:, :, :2] - record.pose[-1, :, :2]
    most = still_distances(record.shapes.radius[: record.robots])
    stands = (np.hypot(*off.transpose(2, 0, 1)) <= most).all(axis=0)
    back = int(np.searchsorted(record.time, record.time[-1] - LATELY - 1e-9))
    came = np.hypot(*(record.pose[-1, :, :2] - record.pose[back, :, :2]).T)
    pace = came / max(record.time[-1] - record.time[back], record.dt)
    room, lines, found = most_beside(record.shapes, record.course[0, :, 1]), record.paths, []
    for i in np.flatnonzero(record.arrived < 0).tolist():
        mine, station = slice(*lines.start[i : i + 2]), float(record.course[-1, i, 0])
        points, at = lines.points[mine], lines.station[mine]
        k = int(np.clip(np.searchsorted(at, station, side="right") - 1, 0, len(at) - 2))
        along = (points[k + 1] - points[k]) / (at[k + 1] - at[k])
        x, y, heading = record.pose[-1, i]
        way = (x, y) - points[k] - (station - at[k]) * along
        over = float(way @ along)
        past = max(over, 0.0) if station >= at[-1] - LENGTH else 0.0
        behind = max(-over, 0.0) if station <= LENGTH else 0.0
        turned = (heading - np.arctan2(along[1], along[0]) + np.pi) % (2.0 * np.pi) - np.pi
        found.append(
            Absent(
                i, float(record.stop_station[i]) - station - past + behind, tolerance,
                bool(stands[i]), float(np.hypot(*(way - (past - behind) * along))),
                float(np.degrees(abs(turned))), float(room[i]), behind, float(pace[i]),
            )
        )  # fmt: skip
    return tuple(found)


def arrival_tolerance(record: Record) -> float:
    """[m] by which a robot may be short of its stop station, or past it: the world's, or 0.1."""
    return (section(record, "arrival", Arrival) or Arrival()).tolerance


def ratio(part: NDArray[Any], whole: NDArray[Any]) -> Each | None:
    """``part / whole`` (N,) of all robots together, and of each; None where there is no whole."""
    if not whole.sum() > 0:
        return None
    each = (float(p / w) if w > 0 else None for p, w in zip(part, whole, strict=True))
    return Each(float(part.sum() / whole.sum()), tuple(each))


def rows_of_robots(record: Record) -> list[Rows]:
    """Decisions of each of the N robots, in the order of time."""
    rows = record.updates
    order = np.argsort(rows["robot"], kind="stable")
    return np.split(rows[order], np.searchsorted(rows["robot"][order], np.arange(1, record.robots)))


def blocks(record: Record) -> Iterator[tuple[int, int]]:
    """First step and one past the last of stretches of the run whose commands fit into memory."""
    size = max(1, MOST_COMMANDS // max(1, record.robots))
    for first in range(record.begun_at, record.steps_run, size):
        yield first, min(first + size, record.steps_run)


def twists_over(record: Record, first: int, last: int) -> FloatArray:
    """(last - first, N, 3) what each robot follows from steps ``first`` to ``last - 1`` on.

    v [m/s], omega [rad/s], lateral [m/s]: its applied command; of a log that was judged the twist
    that leads to the next step, of all B that move.
    """
    if record.judged is None:
        command = record.commands_over("applied", first, last)
        return twists(command.reshape(-1, command.shape[2])).reshape(*command.shape[:2], 3)
    pose = record.moving_pose[first : last + 1]
    moved = np.diff(pose, axis=0)
    half = 0.5 * moved[..., 2]
    middle, arc = pose[:-1, :, 2] + half, np.sinc(half / np.pi)
    cos, sin = np.cos(middle) / arc, np.sin(middle) / arc
    x, y, turn = np.moveaxis(moved, 2, 0)
    return np.stack((cos * x + sin * y, turn, cos * y - sin * x), axis=-1) / record.dt


def check_positive(name: str, value: float) -> None:
    """Raise PhysimError unless a time [s] that was given is positive and finite."""
    if not (isinstance(value, int | float | np.number) and 0.0 < value < float("inf")):
        raise PhysimError(f"{name}: a positive number of seconds; given: {value!r}")


def spacing(record: Record, every: float) -> float:
    """``every`` [s], or more where a course of all robots would have `MOST_MOMENTS`.

    Raises PhysimError unless it is positive.
    """
    check_positive("every", every)
    return max(every, record.steps_made * record.dt * max(record.robots, 1) / MOST_MOMENTS)


def grid(record: Record, every: float = GRID) -> FloatArray:
    """Times (K,) [s] from the first sample on, ``every`` [s] apart (`spacing`), and the end."""
    every, end = spacing(record, every), record.steps_run * record.dt
    count = int((end - record.begun) / every + 1e-9) + 1
    times: FloatArray = record.begun + every * np.arange(float(count))
    return np.append(times, end) if end > times[-1] + 1e-9 else times


def column_over_time(record: Record, name: str, every: float = GRID) -> Series:
    """A column of the decisions as a course of each robot: values (K, N).

    Exact at decisions, linear between them, held after the last; NaN for a robot without any.
    """
    rows = [one[np.isfinite(one[name])] for one in rows_of_robots(record)]
    return _over_time(record, every, [(one["step"] * record.dt, one[name]) for one in rows])


def samples_over_time(record: Record, samples: FloatArray, every: float = GRID) -> Series:
    """Values (K, N) of robots at the samples as a course: linear between them, held after the last.

    NaN in a record without samples.
    """
    return _over_time(record, every, [(record.time, one) for one in samples.T])


def _over_time(record: Record, every: float, known: list[tuple[FloatArray, FloatArray]]) -> Series:
    """A course by what is known of each robot: times (M,) and values (M,)."""
    time = grid(record, every)
    values = np.full((len(time), record.robots), np.nan)
    for robot, (at, value) in enumerate(known):
        if len(at):
            values[:, robot] = np.interp(time, at, value)
    return Series(time, values)
