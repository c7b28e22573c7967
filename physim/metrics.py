"""Figures of one run, each from its `Record` alone: definition, unit and source stand with each.

What has no meaning for a run (the distance between robots of a single one, say) is None, not 0.
Distances are over all physics steps, also those that are not recorded; collision times, formation
errors and modes are over all decisions. "Fig." and numbers in parentheses refer to the paper.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from physim.contacts import Kind, Phase
from physim.control import Mode
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record

Rows = NDArray[np.void]


@dataclass(frozen=True)
class Episode:
    """A contact that lasts: a maximal run of consecutive samples at which two bodies touch."""

    a: int
    """body ids, a < b"""
    b: int
    robots: bool
    """both are robots; otherwise b is a boundary or an obstacle"""
    step: int
    """first sample"""
    time: float
    """[s] of the first sample"""
    samples: int
    """number of samples"""
    depth: float
    """[m] greatest depth"""
    impact: float
    """[N s] impulse of the first sample: the hit itself"""
    impulse: float
    """[N s] sum over the samples: the hit and all pushing after it"""


@dataclass(frozen=True)
class Graze:
    """A contact between two samples: the bodies touch within a step and are apart at its ends."""

    a: int
    """body ids, a < b"""
    b: int
    robots: bool
    """both are robots; otherwise b is a boundary or an obstacle"""
    step: int
    """sample at the end of the step"""
    time: float
    """[s] of that sample"""
    depth: float
    """[m] greatest depth within the step, 0 when they only touch"""


@dataclass(frozen=True)
class Moment:
    """An extreme value, when it was taken and by whom."""

    value: float
    """[m] or [s]"""
    step: int
    time: float
    """[s]"""
    a: int
    """body id"""
    b: int | None = None
    """body id, where the value belongs to two bodies"""


@dataclass(frozen=True)
class DangerShare:
    """How much of its way one robot was in danger mode (Fig. 8); None before its first decision."""

    robot: int
    decisions: float | None
    """[-] share of its decisions"""
    time: float | None
    """[-] share of its time: each decision weighs as long as it held"""


def contact_episodes(record: Record) -> tuple[Episode, ...]:
    """Contact episodes in the order of their beginning; their number is "contacts: N".

    Contacts between two samples are none of them, see `grazes`.
    """
    rows = record.contacts
    rows = rows[(rows["phase"] != Phase.ENDED) & (rows["kind"] == Kind.PHYSICAL)]
    rows = rows[np.lexsort((rows["step"], rows["b"], rows["a"]))]
    if not len(rows):
        return ()
    pair = (np.diff(rows["a"]) != 0) | (np.diff(rows["b"]) != 0)
    firsts = np.flatnonzero(np.concatenate(([True], pair | (np.diff(rows["step"]) > 1))))
    runs = np.split(rows, firsts[1:])
    episodes = [_episode(record, run) for run in runs]
    return tuple(sorted(episodes, key=lambda episode: (episode.step, episode.a, episode.b)))


def grazes(record: Record) -> tuple[Graze, ...]:
    """Contacts between two samples, in the order of time. A pair may have one a step."""
    rows = record.contacts[record.contacts["kind"] == Kind.SWEPT]
    columns = zip(*(rows[key].tolist() for key in ("a", "b", "step", "depth")), strict=True)
    return tuple(
        Graze(a, b, b < record.robots, step, step * record.dt, depth)
        for a, b, step, depth in columns
    )


def shortest_distance(record: Record) -> Moment | None:
    """Shortest distance between two robots, (11) [m]; negative = depth. None for one robot."""
    return _nearest(record, "clearance", "clearance_step", "clearance_other")


def shortest_boundary_distance(record: Record) -> Moment | None:
    """Shortest distance of a robot to a boundary or obstacle [m]; negative = depth."""
    return _nearest(record, "boundary_clearance", "boundary_step", "boundary_other")


def farthest_pair(record: Record) -> Moment | None:
    """Largest distance that two robots ever had [m] (Fig. 6). None for one robot."""
    row = record.farthest
    if row["step"] < 0:
        return None
    step = int(row["step"])
    return Moment(float(row["farthest"]), step, step * record.dt, int(row["a"]), int(row["b"]))


def shortest_collision_time(record: Record) -> Moment | None:
    """Shortest collision time at a decision, (11) [s] (Figs. 3, 6). None if none was seen."""
    times = record.updates["collision_time"]
    times = np.where(np.isnan(times), np.inf, times)
    if not np.isfinite(times).any():
        return None
    return _at(record, record.updates[int(np.argmin(times))], "collision_time")


def formation_error_peak(record: Record) -> Moment | None:
    """Largest absolute formation error at a decision, (10) [m] (Figs. 2, 7)."""
    return _largest_error(record, record.updates)


def formation_error_final(record: Record) -> Moment | None:
    """Largest absolute formation error at the last decision of each robot, (10) [m]."""
    return _largest_error(record, record.updates[last_decisions(record)])


def danger_shares(record: Record) -> tuple[DangerShare, ...]:
    """Share of danger mode of each robot, by decisions and by time (Fig. 8).

    Danger is mode 1 or 2; decisions of a robot that has arrived do not count at all.
    """
    rows, held = _under_way(record)
    danger = (rows["mode"] == Mode.DISTANCE) | (rows["mode"] == Mode.TIME)
    robot = rows["robot"]

    def shares(weight: FloatArray) -> list[float | None]:
        total = np.bincount(robot, weight, record.robots)
        part = np.bincount(robot, weight * danger, record.robots)
        return [float(p / t) if t > 0 else None for p, t in zip(part, total, strict=True)]

    pairs = zip(shares(np.ones(len(rows))), shares(held), strict=True)
    return tuple(DangerShare(i, *pair) for i, pair in enumerate(pairs))


def danger_time_share(record: Record) -> float | None:
    """Share of danger mode of all robots together, by time [-]; arrived ones do not count."""
    rows, held = _under_way(record)
    danger = (rows["mode"] == Mode.DISTANCE) | (rows["mode"] == Mode.TIME)
    return float(held[danger].sum() / held.sum()) if held.sum() > 0 else None


def finished(record: Record) -> bool:
    """Whether all robots have arrived at their stop stations."""
    last = last_decisions(record)
    modes = record.updates["mode"][last]
    return len(last) == record.robots and bool((modes == Mode.ARRIVED).all())


def time_to_finish(record: Record) -> float | None:
    """Time at which the last robot arrived for good [s]; None for a run that did not finish."""
    if not finished(record):
        return None
    rows = record.updates
    on_the_way = rows[rows["mode"] != Mode.ARRIVED]
    left = np.full(record.robots, -1, dtype=np.int64)
    np.maximum.at(left, on_the_way["robot"], on_the_way["step"])
    arrivals = rows[rows["step"] > left[rows["robot"]]]
    _, first = np.unique(arrivals["robot"], return_index=True)
    return float(arrivals["step"][first].max() * record.dt)


def decisions(record: Record) -> int:
    """Number of decisions of all robots."""
    return len(record.updates)


def messages(record: Record) -> int:
    """Messages that the decisions needed: one for each considered robot and decision, (14)."""
    return int(record.updates["considered"].sum())


def evaluations(record: Record) -> int:
    """Collision times worked out."""
    return int(record.updates["evaluations"].sum())


def mean_speed(record: Record) -> float | None:
    """Mean given forward speed over time of all robots under way [m/s] (Fig. 7)."""
    rows, held = _under_way(record)
    return float((rows["given_v"] * held).sum() / held.sum()) if held.sum() > 0 else None


def last_decisions(record: Record) -> IntArray:
    """Row of the last decision of each robot that has made one, by robot."""
    robots = record.updates["robot"]
    _, from_end = np.unique(robots[::-1], return_index=True)
    return (len(robots) - 1 - from_end).astype(np.int64)


def _episode(record: Record, run: Rows) -> Episode:
    a, b, step = int(run["a"][0]), int(run["b"][0]), int(run["step"][0])
    return Episode(
        a, b, b < record.robots, step, step * record.dt, len(run),
        float(run["depth"].max()), float(run["impulse"][0]), float(run["impulse"].sum()),
    )  # fmt: skip


def _nearest(record: Record, value: str, step: str, other: str) -> Moment | None:
    rows = record.extremes
    if not len(rows) or not (rows[step] >= 0).any():
        return None
    who = int(np.argmin(rows[value]))
    row = rows[who]
    at = int(row[step])
    return Moment(float(row[value]), at, at * record.dt, who, int(row[other]))


def _largest_error(record: Record, rows: Rows) -> Moment | None:
    errors = np.abs(rows["formation_error"])
    if record.robots < 2 or not np.isfinite(errors).any():
        return None
    found = _at(record, rows[int(np.nanargmax(errors))], "formation_error")
    return Moment(abs(found.value), found.step, found.time, found.a)


def _at(record: Record, row: np.void, value: str) -> Moment:
    step = int(row["step"])
    return Moment(float(row[value]), step, step * record.dt, int(row["robot"]))


def _under_way(record: Record) -> tuple[Rows, FloatArray]:
    """Decisions of robots that have not arrived, and the steps that each held within the run."""
    rows = record.updates[record.updates["mode"] != Mode.ARRIVED]
    until = np.minimum(rows["next_step"], record.steps_run)
    return rows, np.maximum(until - rows["step"], 0).astype(np.float64)
