"""Stations and deviations of robots at the samples of a record, by the poses and the paths.

They are followed from sample to sample as the run itself followed them from step to step
(`physim.geometry.path`), whoever decided, and however often. In a coarse record robots go far
between two samples, on paths that may pass over themselves: there they are followed from the last
decision before a sample, which knows its stations.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from physim.geometry.path import Tracking
from physim.geometry.shapes import FloatArray

if TYPE_CHECKING:
    from physim.record.history import RecordedHistory


def followed(record: RecordedHistory) -> FloatArray:
    """(K, N, 3) [m] at each sample: station on the own path, deviation from it, station on s*."""
    pose, steps = record.pose, record.steps
    if not len(pose):
        return np.zeros((0, record.robots, 3))
    tracking = Tracking(record.paths, record.reference, record.shapes.radius, pose[0])
    if len(pose) > steps[-1]:
        return tracking.course(pose)
    fastest = _fastest(record)
    found = [
        _at_sample(tracking, *sample)
        for sample in zip(pose, _ways(record, fastest), *_decided(record, fastest), strict=True)
    ]
    return np.stack(found).transpose(0, 2, 1)


def _at_sample(
    tracking: Tracking, pose: FloatArray, way: FloatArray, decided: FloatArray, since: FloatArray
) -> FloatArray:
    """(3, N) stations at a sample, ``way`` (N,) [m] from the one before and ``since`` from what was
    ``decided`` (2, N); but not from there where nobody came in that time, as in a forged record."""
    before = tracking.stations
    reach = tracking.windows + 2.0 * way
    near = (np.abs(decided - before[::2]) <= reach).all(axis=0)
    known = np.stack((decided[0], before[1], decided[1]))
    tracking.seek(pose, np.where(near, known, before), np.where(near, since, way))
    return tracking.stations


def _fastest(record: RecordedHistory) -> FloatArray:
    """(N,) [m/s] as fast as robots were ever commanded to go."""
    fastest = np.zeros(record.robots)
    for rows, speed in ((record.updates, "nominal_v"), (record.commands, "applied_v")):
        np.maximum.at(fastest, rows["robot"], np.abs(rows[speed]))
    return fastest


def _ways(record: RecordedHistory, fastest: FloatArray) -> FloatArray:
    """(K, N) [m] that robots went since the sample before at most: as fast as they ever were
    commanded to, or straight from there to here where they were pushed."""
    ways = np.zeros(record.pose.shape[:2])
    straight = np.hypot(*np.diff(record.pose[:, :, :2], axis=0).transpose(2, 0, 1))
    ways[1:] = np.maximum(np.diff(record.steps)[:, None] * record.dt * fastest, straight)
    return ways


def _decided(record: RecordedHistory, fastest: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stations (K, 2, N) [m] on the own path and on s* at the last decision since the sample
    before, NaN without one; and the way (K, N) [m] since then, as the fastest robot goes, which may
    push the others."""
    known = np.full((len(record.steps), 2, record.robots), np.nan)
    since = np.zeros((len(record.steps), record.robots))
    rows = record.updates
    at = np.searchsorted(record.steps, rows["step"])
    rows, at = rows[at < len(record.steps)], at[at < len(record.steps)]
    for k, name in enumerate(("station", "reference_station")):
        known[at, k, rows["robot"]] = rows[name]
    since[at, rows["robot"]] = (
        (record.steps[at] - rows["step"]) * record.dt * fastest.max(initial=0.0)
    )
    return known, since
