"""How far robots came along their heading, and how they turned, from the start to any step.

With a sample of every step: the chord between its poses, lengthened to the arc (1), and their
headings. An interval of several steps is no arc, as commands change within it: there robots move as
their applied commands say, and what the samples show otherwise, a push or a hold by a contact, is
spread evenly over the steps of the interval in which they touch something. So the distance of a
robot that is free is exact; of one that is turned much between two samples while it is pushed it
errs to either side.
"""

from __future__ import annotations

import numpy as np

from physim.analysis.metrics.held import Held, by_robot
from physim.analysis.metrics.progress import blocks
from physim.geometry.shapes import FloatArray, IntArray
from physim.record import Record

MOST_POSES = 2_000_000
"""Poses that are looked at; of more, every second, third … sample."""
FREE = 1e-6
"""Weight of a step without contact where one with contact has 1: all there is without a table"""
LEAST_ALONG = 0.5
"""Least length of a mean heading along which the push of an interval is told"""


def looked_at(record: Record, ends: tuple[FloatArray, FloatArray]) -> IntArray:
    """Steps (K,) between which courses are taken as linear: those with samples where all have one,
    else those about the ends of windows [s]."""
    if _is_fine(record):
        every = max(1, record.samples * record.robots // MOST_POSES)
        return np.append(record.steps[:-1:every], record.steps[-1])
    at = np.unique(np.concatenate(ends)) / record.dt
    steps = np.concatenate([np.floor(at + 1e-6), np.ceil(at - 1e-6)])
    return np.unique(np.minimum(steps, record.steps_run)).astype(np.int64)


def travelled(record: Record, steps: IntArray) -> tuple[FloatArray, FloatArray]:
    """Distance along the heading (K, N) [m] from the start to ``steps`` (K,), backwards negative.

    And the headings there (K, N) [rad], not wrapped.
    """
    if _is_fine(record):
        return _along_samples(record, steps), record.pose[steps, :, 2]
    held, touches = Held(record), _touches(record)
    found = np.empty((2, len(steps), record.robots))
    for robot in range(record.robots):
        mine = touches[robot]
        at, applied = held.stretches(robot, steps, record.steps, mine, mine + 1)
        found[:, :, robot] = _by_commands(record, robot, steps, at, applied, mine)
    return found[0], found[1]


def _is_fine(record: Record) -> bool:
    """Whether every step has a sample."""
    return record.samples > record.steps_run


def _along_samples(record: Record, steps: IntArray) -> FloatArray:
    """Distance (K, N) [m] by a sample of every step."""
    found, total = np.zeros((len(steps), record.robots)), np.zeros(record.robots)
    for first, last in blocks(record):
        pose = record.pose[first : last + 1]
        step, half = np.diff(pose, axis=0), np.diff(pose[:, :, 2], axis=0) / 2.0
        heading = pose[:-1, :, 2] + half
        chord = step[:, :, 0] * np.cos(heading) + step[:, :, 1] * np.sin(heading)
        course = total + np.cumsum(chord / np.sinc(half / np.pi), axis=0)
        here = (steps > first) & (steps <= last)
        found[here] = course[steps[here] - first - 1]
        total = course[-1]
    return found


def _touches(record: Record) -> list[IntArray]:
    """Steps of each robot at an end of which it touches something."""
    rows = record.contacts
    body = np.concatenate((rows["a"], rows["b"]))
    steps = np.concatenate((rows["step"], rows["step"]))[body < record.robots]
    return [
        np.unique(np.concatenate((own - 1, own)))
        for own in by_robot(steps, body[body < record.robots], record.robots)
    ]


def _by_commands(
    record: Record,
    robot: int,
    steps: IntArray,
    at: IntArray,
    applied: FloatArray,
    touches: IntArray,
) -> tuple[FloatArray, FloatArray]:
    """Distance [m] and heading [rad] (K,) of a robot at ``steps``, by commands and samples.

    ``applied`` (M, 2) are its commands between ``at`` (M + 1,), where it moves on arcs (1).
    """
    samples, pose, count = record.steps, record.pose[:, robot], np.diff(at)
    asked, seen = np.searchsorted(at, steps), np.searchsorted(at, samples)
    commanded = _course(applied[:, 1] * (record.dt * count))
    heading = commanded + np.interp(at, samples, pose[:, 2] - commanded[seen])
    half = np.diff(heading) / 2.0
    middle, share = heading[:-1] + half, np.sinc(half / np.pi)
    way = applied[:, 0] * (record.dt * count)
    cos, sin = share * np.cos(middle), share * np.sin(middle)
    distance = _course(way)
    x, y = np.diff(pose[:, :2], axis=0).T
    along = (x - _over(way * cos, seen)) * (mean_x := _over(count * cos, seen) / np.diff(samples))
    along += (y - _over(way * sin, seen)) * (mean_y := _over(count * sin, seen) / np.diff(samples))
    along /= np.maximum(mean_x**2 + mean_y**2, LEAST_ALONG**2)
    # what a step at an end of which it touches has of the push of its interval
    weight = _course(count * np.where(np.isin(at[:-1], touches), 1.0, FREE))
    row = np.clip(np.searchsorted(samples, steps, side="right") - 1, 0, len(samples) - 2)
    part = (weight[asked] - weight[seen[row]]) / (weight[seen[row + 1]] - weight[seen[row]])
    return distance[asked] + _course(along)[row] + part * along[row], heading[asked]


def _course(parts: FloatArray) -> FloatArray:
    """Sum (M + 1,) of parts (M,) from 0 on."""
    return np.concatenate(([0.0], np.cumsum(parts)))


def _over(parts: FloatArray, seen: IntArray) -> FloatArray:
    """Sum of parts (M,) over each interval between samples, whose places are ``seen``."""
    return np.diff(_course(parts)[seen])
