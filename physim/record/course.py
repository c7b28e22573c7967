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
from physim.geometry.shapes import FloatArray, read_only

if TYPE_CHECKING:
    from physim.record.reader import Record


def followed(record: Record) -> FloatArray:
    """(K, N, 3) [m] at each sample: station on the own path, deviation from it, station on s*."""
    pose = record.pose
    if not len(pose):
        return np.zeros((0, record.robots, 3))
    tracking = Tracking(
        record.paths, record.reference, record.shapes.radius[: record.robots], pose[0]
    )
    if record.begun_at:  # the nearest point of the path may lie on another branch of it
        tracking.stations = read_only(record.begun_along.T.copy())
    if len(pose) > record.steps_made:
        return tracking.course(pose)
    found = []
    for here, way, decided, since in zip(pose, *_ways(record), strict=True):
        before = tracking.stations
        known = np.stack((decided[0], before[1], decided[1]))
        is_known = np.isfinite(decided).all(axis=0)
        tracking.seek(here, np.where(is_known, known, before), np.where(is_known, since, way))
        found.append(tracking.stations)
    return np.stack(found).transpose(0, 2, 1)


def _ways(record: Record) -> tuple[FloatArray, FloatArray, FloatArray]:
    """How far robots may have gone, and where they were: for each sample

    the way (K, N) [m] since the sample before at most: as fast as they ever were commanded to go,
    or straight where they were pushed; stations (K, 2, N) [m] on the own path and on s* at the last
    decision since the sample before, NaN without one; and the way (K, N) [m] since that decision,
    as the fastest robot goes, which may push the others.
    """
    fastest = np.zeros(record.robots)
    for rows, speed in ((record.updates, "nominal_v"), (record.commands, "applied_v")):
        np.maximum.at(fastest, rows["robot"], np.abs(rows[speed]))
    ways = np.zeros(record.pose.shape[:2])
    straight = np.hypot(*np.diff(record.pose[:, :, :2], axis=0).transpose(2, 0, 1))
    ways[1:] = np.maximum(np.diff(record.steps)[:, None] * record.dt * fastest, straight)
    stations = np.full((len(record.steps), 2, record.robots), np.nan)
    since = np.zeros((len(record.steps), record.robots))
    rows = record.updates
    at = np.searchsorted(record.steps, rows["step"])
    rows, at = rows[at < len(record.steps)], at[at < len(record.steps)]
    for k, name in enumerate(("station", "reference_station")):
        stations[at, k, rows["robot"]] = rows[name]
    since[at, rows["robot"]] = (
        (record.steps[at] - rows["step"]) * record.dt * fastest.max(initial=0.0)
    )
    return ways, stations, since


__all__ = ["followed"]
