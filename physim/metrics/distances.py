"""Distances and collision times (11): their extremes, and those of all pairs over time (Fig. 6)."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import shapely

from physim.geometry.shapes import FloatArray, IntArray
from physim.metrics.values import Moment, Series
from physim.record import Record

MOST_DISTANCES = 100_000
"""Distances that `pair_distances` works out."""


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
    times = record.column("collision_time")
    times = np.where(np.isnan(times), np.inf, times)
    if not np.isfinite(times).any():
        return None
    return _at(record, record.updates[int(np.argmin(times))], "collision_time")


def collision_times(record: Record) -> Series | None:
    """Least collision time (11) [s] at each step with decisions, over all robots (Figs. 3, 6).

    Time (K,) of the steps, values (K,); inf where the decisions saw no collision coming. None where
    the controller reports no collision times.
    """
    rows = record.updates
    if np.isnan(record.column("collision_time")).all():
        return None
    steps, place = np.unique(rows["step"], return_inverse=True)
    least = np.full(len(steps), np.inf)
    np.fmin.at(least, place, rows["collision_time"])
    return Series(steps * record.dt, least)


def pair_distances(record: Record, most: int = MOST_DISTANCES) -> tuple[Series, IntArray]:
    """Distances (11) [m] of every pair of robots over time (Figs. 3, 6): 0 where they touch.

    Time (K,), values (K, P) and the pairs (P, 2), robots a < b. Samples are evenly spread over
    the recorded ones, so that there are at most about ``most`` distances, and two times at least:
    the shortest ones are `shortest_distance`'s, not theirs.
    """
    pairs = np.array(list(combinations(range(record.robots), 2)), dtype=np.int64).reshape(-1, 2)
    count = min(record.samples, max(2, most // max(1, len(pairs))))
    rows = np.unique(np.linspace(0, record.samples - 1, count).round().astype(np.int64))
    if not record.samples or not len(pairs):
        return Series(np.zeros(0), np.zeros((0, len(pairs)))), pairs
    shapes = np.stack([placed(record, i, record.pose[rows, i]) for i in range(record.robots)])
    found = shapely.distance(shapes[pairs[:, 0]], shapes[pairs[:, 1]])
    return Series(record.time[rows], np.asarray(found.T)), pairs


def placed(record: Record, robot: int, pose: FloatArray) -> FloatArray:
    """Shape of a robot at poses (K, 3), as shapely geometries (K,), world frame."""
    cos, sin = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    turn = np.stack([np.stack([cos, sin], -1), np.stack([-sin, cos], -1)], axis=1)
    parts = [shapely.polygons(part @ turn + pose[:, None, :2]) for part in record.footprints[robot]]
    whole = parts[0] if len(parts) == 1 else shapely.multipolygons(np.stack(parts, axis=-1))
    return np.asarray(whole)


def _nearest(record: Record, value: str, step: str, other: str) -> Moment | None:
    rows = record.extremes
    if not len(rows) or not (rows[step] >= 0).any():
        return None
    who = int(np.argmin(rows[value]))
    row = rows[who]
    at = int(row[step])
    return Moment(float(row[value]), at, at * record.dt, who, int(row[other]))


def _at(record: Record, row: np.void, value: str) -> Moment:
    step = int(row["step"])
    return Moment(float(row[value]), step, step * record.dt, int(row["robot"]))
