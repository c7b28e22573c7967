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
    turned, at_samples = _turned(record, steps), _turned(record, record.steps)
    off = record.pose[:, :, 2] - at_samples
    return _along_commands(record, steps, off), turned + _between(record, off, steps)


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
        total = _note(found, steps, first, total + np.cumsum(chord / np.sinc(half / np.pi), axis=0))
    return found


def _turned(record: Record, steps: IntArray) -> FloatArray:
    """What the applied commands turn (K, N) [rad] from the start to each of some steps."""
    found, total = np.zeros((len(steps), record.robots)), np.zeros(record.robots)
    for first, last in blocks(record):
        omega = record.commands_over("applied", first, last)[:, :, 1]
        total = _note(found, steps, first, total + np.cumsum(omega * record.dt, axis=0))
    return found


def _along_commands(record: Record, steps: IntArray, off: FloatArray) -> FloatArray:
    """Distance (K, N) [m] by the applied commands and what the samples show otherwise.

    ``off`` (M, N) [rad] is by how much headings at samples differ from what is commanded.
    """
    shape = (record.robots, 6)
    total, turn = np.zeros(shape), np.zeros(record.robots)
    found, samples = np.zeros((len(steps), *shape)), np.zeros((record.samples, *shape))
    for first, last in blocks(record):
        applied = record.commands_over("applied", first, last) * record.dt
        heading = np.concatenate((turn[None], turn + np.cumsum(applied[:, :, 1], axis=0)))
        turn = heading[-1].copy()
        heading += _between(record, off, np.arange(first, last + 1))
        half = np.diff(heading, axis=0) / 2.0
        middle, way = heading[:-1] + half, applied[:, :, 0]
        chord, cos, sin = way * np.sinc(half / np.pi), np.cos(middle), np.sin(middle)
        parts = way, chord * cos, chord * sin, cos, sin, _touching(record, first, last)
        course = total + np.cumsum(np.stack(parts, axis=-1), axis=0)
        _note(samples, record.steps, first, course)
        total = _note(found, steps, first, course)
    passed = np.diff(samples, axis=0)
    otherwise = np.diff(record.pose[:, :, :2], axis=0) - passed[:, :, 1:3]
    mean = passed[:, :, 3:5] / np.diff(record.steps)[:, None, None]
    along = (otherwise * mean).sum(axis=2)
    along /= np.maximum(np.square(mean).sum(axis=2), LEAST_ALONG**2)
    pushed = np.concatenate((np.zeros((1, record.robots)), np.cumsum(along, axis=0)))
    row = _interval(record, steps)
    share = (found[:, :, 5] - samples[row, :, 5]) / passed[row, :, 5]
    return np.asarray(found[:, :, 0] + pushed[row] + share * along[row])


def _touching(record: Record, first: int, last: int) -> FloatArray:
    """(K, N) 1 for steps ``first`` to ``last - 1`` at an end of which robots touch, else `FREE`."""
    rows = record.contacts_over(first, last + 1)
    found = np.full((last - first, record.robots), FREE)
    for body in (rows["a"], rows["b"]):
        for step in (rows["step"] - 1, rows["step"]):
            mine = (body < record.robots) & (step >= first) & (step < last)
            found[step[mine] - first, body[mine]] = 1.0
    return found


def _note(found: FloatArray, steps: IntArray, first: int, course: FloatArray) -> FloatArray:
    """Put the rows of a course, after steps ``first`` on, at their ``steps``; its last row."""
    here = (steps > first) & (steps <= first + len(course))
    found[here] = course[steps[here] - first - 1]
    return np.asarray(course[-1])


def _between(record: Record, values: FloatArray, steps: IntArray) -> FloatArray:
    """Values (K, N) at some steps, linear between those (M, N) at the samples."""
    row = _interval(record, steps)
    begin, end = record.steps[row], record.steps[row + 1]
    share = np.clip((steps - begin) / (end - begin), 0.0, 1.0)[:, None]
    return np.asarray(values[row] + share * (values[row + 1] - values[row]))


def _interval(record: Record, steps: IntArray) -> IntArray:
    """(K,) the sample before each of some steps, or at it; that before the last one at the end."""
    row = np.searchsorted(record.steps, steps, side="right") - 1
    return np.clip(row, 0, record.samples - 2).astype(np.int64)
