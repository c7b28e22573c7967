"""Rows of what is sensed, as sensing stages change them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from physim.geometry.shapes import Flags, FloatArray, IntArray, Rows3
from physim.parts.controller import Sensed, Snapshot
from physim.parts.stages import hide_rows, kept_rows, observer_of_row, with_poses
from physim.randomness import Words, purpose_key
from physim.world.scene import Scene


class Rows(NamedTuple):
    """Who sees whom, as kernels take it."""

    observers: int
    first: IntArray
    end: IntArray
    robot: IntArray
    seen: Rows3
    """(M, 3) poses as stages before left them; NaN of what is not seen"""
    truth: Rows3
    """(B, 3) poses of all bodies as they are"""


class Stage:
    """A sensing stage that is asked for rows of observers who look, and remembers nothing."""

    on_demand = True
    settings: Any

    def start(self, scene: Scene) -> Any:
        """Nothing is remembered."""

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: Any
    ) -> tuple[Sensed, Any]:
        """Rows as they are sensed; where nobody looks there are none."""
        if not len(sensed.robot):
            return sensed, state
        return self.changed(scene, truth, sensed), state

    def changed(self, scene: Scene, truth: Snapshot, sensed: Sensed) -> Sensed:
        """Rows as this stage leaves them: here, less sight of those that it hides."""
        hidden = np.empty(len(sensed.robot), np.bool_)
        self.hide(scene, truth.step, rows_of(truth, sensed), hidden)
        return unseen(sensed, hidden)

    def hide(self, scene: Scene, step: int, rows: Rows, out: Flags) -> None:
        """Write which rows (M,) are not seen."""
        raise NotImplementedError

    def key(self, scene: Scene) -> Words:
        """Key (2,) of its draws."""
        name = f"{type(self).__name__.lower()} {self.settings.stream}"
        return np.array([scene.seed, purpose_key(name)], dtype=np.uint64)


def rows_of(truth: Snapshot, sensed: Sensed) -> Rows:
    """Rows for kernels."""
    first, end, robot, pose = sensed.first, sensed.end, sensed.robot, sensed.pose
    return Rows(len(first), first, end, robot, pose, truth.moving_pose)


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
    if not np.count_nonzero(hidden):
        return rows
    pose, velocity = rows.pose.copy(), rows.velocity.copy()
    hide_rows(len(hidden), hidden, pose, velocity)
    rows = rows._replace(pose=pose, velocity=velocity)
    return without(rows, hidden & np.isinf(rows.heard))


def without(rows: Sensed, gone: Flags) -> Sensed:
    """Rows less some, ``gone`` (M,)."""
    if not np.count_nonzero(gone):
        return rows
    end = np.cumsum(np.bincount(observer_of_row(rows)[~gone], minlength=len(rows.first)))
    first = np.concatenate(([0], end[:-1]))
    return kept_rows(rows, ~gone)._replace(first=first, end=end)
