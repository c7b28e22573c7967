"""Rows of what is sensed, as sensing stages change them."""

from __future__ import annotations

import numpy as np

from physim.geometry.shapes import Flags, FloatArray
from physim.parts.controller import Sensed, Snapshot
from physim.parts.stages import for_each, kept_rows, observer_of_row, with_poses
from physim.world.scene import Scene


def own_rows(scene: Scene, sensed: Sensed) -> Sensed:
    """Rows that belong to one observer each, in the order of observers, which may use them."""
    is_apart = int((sensed.end - sensed.first).sum()) == len(sensed.robot)
    return sensed if is_apart else for_each(sensed, scene)


def moving(truth: Snapshot) -> tuple[FloatArray, FloatArray]:
    """Poses and velocities (B, 3) of all bodies that rows are about."""
    return truth.pose, truth.velocity


def moved(scene: Scene, rows: Sensed, pose: FloatArray) -> Sensed:
    """Rows with other poses (M, 3); stations of what was not told follow them."""
    untold = np.isinf(rows.heard)
    if untold.any():
        station = with_poses(scene, rows, pose).reference_station
        station = np.where(untold, station, rows.reference_station)
        rows = rows._replace(reference_station=station)
    return rows._replace(pose=pose)


def unseen(rows: Sensed, hidden: Flags) -> Sensed:
    """Rows of which some, ``hidden`` (M,), are not seen; without those not told of either."""
    if not hidden.any():
        return rows
    pose, velocity = rows.pose.copy(), rows.velocity.copy()
    pose[hidden], velocity[hidden] = np.nan, np.nan
    return without(rows._replace(pose=pose, velocity=velocity), hidden & np.isinf(rows.heard))


def without(rows: Sensed, gone: Flags) -> Sensed:
    """Rows less some, ``gone`` (M,)."""
    if not gone.any():
        return rows
    end = np.cumsum(np.bincount(observer_of_row(rows)[~gone], minlength=len(rows.first)))
    first = np.concatenate(([0], end[:-1]))
    return kept_rows(rows, ~gone)._replace(first=first, end=end)
