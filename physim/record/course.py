"""Stations and deviations of robots at the samples of a record, by the poses and the paths alone.

They are followed from sample to sample as the run itself followed them from step to step
(`physim.geometry.tracking`), whoever decided, and however often.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from physim.geometry.shapes import FloatArray
from physim.geometry.tracking import Tracking

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
    return tracking.course(pose, _ways(record))


def _ways(record: RecordedHistory) -> FloatArray:
    """(K, N) [m] that robots went since the sample before at most: as fast as they ever were
    commanded to, or straight from there to here where they were pushed."""
    fastest = np.zeros(record.robots)
    for rows, speed in ((record.updates, "nominal_v"), (record.commands, "applied_v")):
        np.maximum.at(fastest, rows["robot"], np.abs(rows[speed]))
    ways = np.zeros(record.pose.shape[:2])
    straight = np.hypot(*np.diff(record.pose[:, :, :2], axis=0).transpose(2, 0, 1))
    ways[1:] = np.maximum(np.diff(record.steps)[:, None] * record.dt * fastest, straight)
    return ways
