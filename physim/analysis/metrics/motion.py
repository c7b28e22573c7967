"""How robots moved: deviation from their paths, averaged speeds, and formation (Figs. 1, 2, 7).

Formation errors and formation energy follow (7) to (10). A run has formation errors when its
world has a formation and more than one robot.
"""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from physim.analysis.metrics.metric import Each, Moment, Series, section
from physim.analysis.metrics.progress import (
    GRID,
    active_samples,
    active_steps,
    blocks,
    check_positive,
    ratio,
    samples_over_time,
    spacing,
)
from physim.errors import RecordError
from physim.geometry.shapes import FloatArray
from physim.record import Record
from physim.world import Formation

WINDOW = 10.0
"""[s] window of averaged speeds (paper)"""
MOST_PAIRS = 30_000_000
"""Pairs of robots and moments that `formation_energy` looks at, about: bounds its time."""


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

    Values (K, N) [m], left of the path positive; exact at the samples, linear between. Every
    0.1 s, or every ``every`` [s]: `deviation_peak` may lie between.
    """
    return samples_over_time(record, record.course[:, :, 1], every)


def deviation_peak(record: Record) -> Moment | None:
    """Deviation of greatest size at any sample, with its sign [m] (Figs. 1b, 2c, 7d).

    Over the whole run, so also of a robot that has gone past the end of its path or was pushed off
    it at its stop. None in a record without samples.
    """
    return extreme(record, record.course[:, :, 1])


def deviation_rms(record: Record) -> Each | None:
    """Root of the mean square deviation over the active time [m], of all robots and of each.

    From each sample of a robot that is not at its stop station to the next, or to its stop;
    deviations are linear between samples.
    """
    away, ends = active_samples(record)[:-1], active_steps(record)
    begins, spans = record.steps[:-1, None], np.diff(record.steps)[:, None]
    steps = np.where((begins < ends) & (ends < begins + spans), ends - begins, spans) * away
    return _root_mean_square(record.course[:, :, 1], steps, spans)


def _root_mean_square(values: FloatArray, steps: Any, spans: Any) -> Each | None:
    """Of values (K, N) at samples and linear between them, over so many ``steps`` (K - 1, N) of the
    ``spans`` (K - 1, 1) from each to the next: of all robots and of each."""
    first = values[:-1]
    last = first + (values[1:] - first) * (steps / spans)
    square = steps * (first * first + first * last + last * last) / 3.0
    mean = ratio(square.sum(axis=0), (steps * np.ones(first.shape)).sum(axis=0))
    if mean is None:
        return None
    return Each(sqrt(mean.value), tuple(None if x is None else sqrt(x) for x in mean.robots))


def mean_speed(record: Record) -> float | None:
    """Mean applied forward speed over time of all active robots [m/s] (Fig. 7).

    From the first command of each on. None where none was recorded.
    """
    ends, begins = active_steps(record), np.full(record.robots, record.steps_run)
    for rows in (record.updates, record.commands):
        np.minimum.at(begins, rows["robot"], rows["step"])
    distance = total = 0.0
    for first, last in blocks(record):
        steps = np.arange(first, last)[:, None]
        counts = (steps >= begins) & (steps < ends)
        distance += float(record.commands_over("applied", first, last)[counts, 0].sum())
        total += float(counts.sum())
    return distance / total if total > 0 else None


def command_changes(record: Record, column: int) -> float | None:
    """Sum of the changes of a number of the nominal commands, by size, per second of active time.

    ``column`` 0: v [m/s^2], 1: omega [rad/s^2]; of a mean robot. What a drive, a disturbance or the
    physics makes of the commands has no say. None where no robot was active, and of a judged log.
    """
    if record.judged:
        return None
    ends, sums, before = active_steps(record), np.zeros(record.robots), None
    for first, last in blocks(record):
        values = record.commands_over("nominal", first, last)[:, :, column]
        changes = np.abs(np.diff(values, axis=0, prepend=values[:1] if before is None else before))
        sums += (changes * (np.arange(first, last)[:, None] < ends)).sum(axis=0)
        before = values[-1:]
    found = ratio(sums, (ends - record.begun_at) * record.dt)
    return None if found is None else found.value


def averaged_speeds(record: Record, window: float = WINDOW, every: float = GRID) -> AveragedSpeeds:
    """Speeds averaged over ``window`` [s] about each moment (Figs. 1c, 7b, 7c).

    As the samples show the robots to have moved: chords between samples, lengthened to arcs, along
    the heading in their middle; of a record with samples far apart they are approximate. Defined
    where the whole window lies before the robot is at its stop station, and samples are no farther
    apart than it is long. Raises PhysimError for a window or spacing that is not positive.
    """
    check_positive("window", window)
    start, end, every = record.begun, record.steps_run * record.dt, spacing(record, every)
    sampled = record.samples > 1 and record.record_every * record.dt <= window
    whole_windows = sampled and end - start >= window - 1e-9
    count = int((end - start - window) / every + 1e-9) + 1 if whole_windows else 0
    begins: FloatArray = start + every * np.arange(float(count))
    found = np.full((2, count, record.robots), np.nan)
    arrival = np.minimum(active_steps(record) * record.dt, end) + 1e-9
    for i in range(record.robots if count else 0):
        whole = begins[begins + window <= arrival[i]]
        step, half = np.diff(record.pose[:, i, :2], axis=0).T, np.diff(record.pose[:, i, 2]) / 2.0
        middle = record.pose[:-1, i, 2] + half
        arc = np.sinc(np.minimum(np.abs(half) / np.pi, 0.5))  # beyond half a turn no chord tells
        along = (step[0] * np.cos(middle) + step[1] * np.sin(middle)) / arc
        for k, course in enumerate((np.append(0.0, np.cumsum(along)), record.pose[:, i, 2])):
            first, last = (np.interp(at, record.time, course) for at in (whole, whole + window))
            found[k, : len(whole), i] = (last - first) / window
    return AveragedSpeeds(begins + window / 2.0, *found)


def formation_error_rms(record: Record, errors: FloatArray | None) -> Each | None:
    """Root of the mean square of formation errors (K, N) over time [m], of all robots and of each.

    They are linear between samples.
    """
    if errors is None or not len(errors):
        return None
    spans = np.diff(record.steps)[:, None]
    return _root_mean_square(errors, spans, spans)


def formation_errors(record: Record, every: float = GRID) -> Series | None:
    """Formation error of each robot over time, (10): values (K, N) [m].

    Positive for a robot that is behind its place. Exact at the samples and linear between them.
    None in a run without formation.
    """
    errors = sampled_errors(record)
    return None if errors is None else samples_over_time(record, errors, every)


def sampled_errors(record: Record) -> FloatArray | None:
    """Formation errors of all robots at the samples, (10): (K, N) [m]; see `formation_errors`."""
    lead = desired_leads(record)
    station = record.course[:, :, 2]
    return None if lead is None else np.asarray(station.mean(axis=1)[:, None] - station + lead)


def formation_energy(record: Record) -> Series | None:
    """Formation energy W at the samples, (9): values (K,) [m^2].

    Pairs are those of N_i: within the world's ``formation.range`` along s* at that moment, all, or
    listed. With many robots at every second, third … sample, and at the last one. None in a run
    without formation, or without samples.
    """
    found = _stations(record)
    if found is None:
        return None
    lead, (pairs, reach) = desired_leads(record), _neighbours(record)
    energy = np.empty(len(found.time))
    for k, s in enumerate(found.values):
        centre = s - lead  # the formation's, as each robot's station and place give it
        errors = np.square(centre[:, None] - centre)
        near = np.abs(s[:, None] - s) <= reach if pairs is None else pairs
        energy[k] = 0.5 * (errors * near).sum()  # (9)
    return Series(found.time, energy)


def formation_parts(record: Record) -> Series | None:
    """How many parts a formation is in over time: values (K,), 1 where all are connected.

    Parts are robots that chains of neighbours connect, at the moments of `formation_energy`.
    Between parts (7) keeps no distance, and W of (9) counts no error. None in a run without
    formation, or without samples.
    """
    found = _stations(record)
    if found is None:
        return None
    pairs, reach = _neighbours(record)
    if pairs is None:
        gaps = np.diff(np.sort(found.values, axis=1), axis=1)
        return Series(found.time, 1.0 + (gaps > reach).sum(axis=1))
    from scipy.sparse.csgraph import connected_components  # which takes long to import

    count, _ = connected_components(pairs, directed=False)
    return Series(found.time, np.full(len(found.time), float(count)))


def _stations(record: Record) -> Series | None:
    """Stations (K, N) [m] on s* of a run with a formation, at samples that bound the time."""
    if desired_leads(record) is None or not record.samples:
        return None
    every = -(-record.samples * record.robots**2 // MOST_PAIRS)
    rows = np.append(np.arange(0, record.samples - 1, every), record.samples - 1)
    return Series(record.time[rows], record.course[rows, :, 2])


def desired_leads(record: Record) -> FloatArray | None:
    """Desired place of each robot on s* less the robots' mean place, (N,) [m], left of (7).

    None in a run without formation, or of a single robot.
    """
    has_one = section(record, "formation", Formation) is not None
    return record.lead - record.lead.mean() if has_one and record.robots > 1 else None


def _neighbours(record: Record) -> tuple[FloatArray | None, float]:
    """(N, N) 1 where j is in N_i; None when neighbours are those within range, and that range [m].

    Raises RecordError where the world inside has something else there.
    """
    plan, names = section(record, "formation", Formation) or Formation(), record.names
    if plan.neighbours == "range":
        return None, plan.range
    if plan.neighbours == "all":
        return np.ones((len(names), len(names))), plan.range
    listed = np.zeros((len(names), len(names)))
    for pair in plan.neighbours:
        if not set(pair) <= set(names):
            raise RecordError(
                f"world of {record.where}: formation.neighbours: no pair of names of its robots"
            )
        i, j = map(names.index, pair)
        listed[i, j] = listed[j, i] = 1.0
    return listed, plan.range


def extreme(record: Record, values: FloatArray, first: int = 0) -> Moment | None:
    """Value of greatest size among values (K, N) at the samples, with its sign, from one on."""
    if not record.samples:
        return None
    k, robot = np.unravel_index(int(np.argmax(np.abs(values[first:]))), values[first:].shape)
    return Moment.at(record, values[first + k, robot], record.steps[first + k], robot)
