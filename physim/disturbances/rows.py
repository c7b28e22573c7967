"""Rows of what is sensed, as sensing stages change them."""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.geometry.shapes import Flags, FloatArray, Rows3
from physim.parts.controller import Sensed, Snapshot
from physim.parts.stages import kept_rows, observer_of_row, with_poses
from physim.world.scene import Scene


def moving(truth: Snapshot) -> tuple[FloatArray, FloatArray]:
    """Poses and velocities (B, 3) of all bodies that rows are about."""
    return truth.moving_pose, truth.moving_velocity


def moved(scene: Scene, rows: Sensed, pose: FloatArray) -> Sensed:
    """Rows with other poses (M, 3); stations of what was not told follow them."""
    untold = np.isinf(rows.heard)
    if np.count_nonzero(untold):
        station = with_poses(scene, rows, pose).reference_station
        station = np.where(untold, station, rows.reference_station)
        rows = rows._replace(reference_station=station)
    return rows._replace(pose=pose)


def unseen(rows: Sensed, hidden: Flags) -> Sensed:
    """Rows of which some, ``hidden`` (M,), are not seen; without those not told of either."""
    pose, velocity = rows.pose.copy(), rows.velocity.copy()
    untold = hide_rows(len(hidden), hidden, rows.heard, pose, velocity)
    rows = rows._replace(pose=pose, velocity=velocity)
    return without(rows, hidden & np.isinf(rows.heard)) if untold else rows


@compiled
def hide_rows(many: int, hidden: Flags, heard: FloatArray, pose: Rows3, velocity: Rows3) -> int:
    """Make hidden ones of so many rows unseen; how many of them are not told of either."""
    count = 0
    for row in range(many):
        if hidden[row]:
            for m in range(3):
                pose[row, m], velocity[row, m] = np.nan, np.nan
            count += not heard[row] < np.inf
    return count


def without(rows: Sensed, gone: Flags) -> Sensed:
    """Rows less some, ``gone`` (M,)."""
    if not np.count_nonzero(gone):
        return rows
    end = np.cumsum(np.bincount(observer_of_row(rows)[~gone], minlength=len(rows.first)))
    first = np.concatenate(([0], end[:-1]))
    return kept_rows(rows, ~gone)._replace(first=first, end=end)
