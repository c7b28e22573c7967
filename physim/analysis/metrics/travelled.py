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

from physim.analysis.metrics.held import Held
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
    held = Held(record)
    off = record.pose[:, :, 2] - _turned(record, held, record.steps)
    turned = _turned(record, held, steps) + _between(record, off, steps)
    return _along_commands(record, held, steps, off), turned


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
        at = np.arange(first, last + 1)
        total = _note(found, steps, at, total + np.cumsum(chord / np.sinc(half / np.pi), axis=0))
    return found


def _turned(record: Record, held: Held, steps: IntArray) -> FloatArray:
    """What the applied commands turn (K, N) [rad] from the start to each of some steps."""
    found, total = np.zeros((len(steps), record.robots)), np.zeros(record.robots)
    for at, applied in held.stretches(steps):
        turn = applied[:, :, 1] * (record.dt * np.diff(at))[:, None]
        total = _note(found, steps, at, total + np.cumsum(turn, axis=0))
    return found


def _along_commands(record: Record, held: Held, steps: IntArray, off: FloatArray) -> FloatArray:
    """Distance (K, N) [m] by the applied commands and what the samples show otherwise.

    ``off`` (M, N) [rad] is by how much headings at samples differ from what is commanded: between
    two changes robots move on arcs (1).
    """
    shape = (record.robots, 6)
    total, turn = np.zeros(shape), np.zeros(record.robots)
    found, samples = np.zeros((len(steps), *shape)), np.zeros((record.samples, *shape))
    touched = record.contacts["step"]
    ends = touched - 1, touched, touched + 1
    for at, applied in held.stretches(steps, record.steps, *ends):
        count = np.diff(at)[:, None]
        turned = turn + np.cumsum(applied[:, :, 1] * (record.dt * count), axis=0)
        heading = np.concatenate((turn[None], turned)) + _between(record, off, at)
        turn = turned[-1]
        half = np.diff(heading, axis=0) / 2.0
        middle, way = heading[:-1] + half, applied[:, :, 0] * (record.dt * count)
        share = np.sinc(half / np.pi)
        cos, sin = share * np.cos(middle), share * np.sin(middle)
        touching = count * _touching(record, at)
        parts = way, way * cos, way * sin, count * cos, count * sin, touching
        course = total + np.cumsum(np.stack(parts, axis=-1), axis=0)
        _note(samples, record.steps, at, course)
        total = _note(found, steps, at, course)
    passed = np.diff(samples, axis=0)
    otherwise = np.diff(record.pose[:, :, :2], axis=0) - passed[:, :, 1:3]
    mean = passed[:, :, 3:5] / np.diff(record.steps)[:, None, None]
    along = (otherwise * mean).sum(axis=2)
    along /= np.maximum(np.square(mean).sum(axis=2), LEAST_ALONG**2)
    pushed = np.concatenate((np.zeros((1, record.robots)), np.cumsum(along, axis=0)))
    row = _interval(record, steps)
    share = (found[:, :, 5] - samples[row, :, 5]) / passed[row, :, 5]
    return np.asarray(found[:, :, 0] + pushed[row] + share * along[row])


def _touching(record: Record, at: IntArray) -> FloatArray:
    """(K, N) 1 where robots touch at an end of the steps from one of ``at`` (K + 1,) to the next,
    else `FREE`; steps with contact are among them."""
    rows = record.contacts_over(int(at[0]), int(at[-1]) + 1)
    found = np.full((len(at) - 1, record.robots), FREE)
    for body in (rows["a"], rows["b"]):
        for step in (rows["step"] - 1, rows["step"]):
            mine = (body < record.robots) & (step >= at[0]) & (step < at[-1])
            found[np.searchsorted(at, step[mine]), body[mine]] = 1.0
    return found


def _note(found: FloatArray, steps: IntArray, at: IntArray, course: FloatArray) -> FloatArray:
    """Put the rows of a course, at ``at[1:]``, at their ``steps``; its last row."""
    here = (steps > at[0]) & (steps <= at[-1])
    found[here] = course[np.searchsorted(at, steps[here]) - 1]
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
