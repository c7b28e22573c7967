"""Missed detections: now and then a robot does not see another that it could see."""

from __future__ import annotations

from math import isnan
from typing import Any

import numpy as np

from physim.compiled import compiled
from physim.disturbances.losses import Chance, Losses, last_drawn
from physim.disturbances.rows import unseen
from physim.geometry.shapes import Flags, IntArray, Rows3
from physim.parts.controller import Sensed, Snapshot
from physim.randomness import Words, purpose_key
from physim.world.scene import Scene


class MissedSettings(Losses):
    """Keys of ``type: missed`` under ``sensing.stages``; each detection holds for an interval."""


class Missed:
    """Hides robots by chance, detection by detection or for several in a row."""

    Settings = MissedSettings
    on_demand = True

    def __init__(self, settings: MissedSettings | None = None) -> None:
        self.settings = settings or MissedSettings()
        self._chance = self.settings.chance
        self._purpose = purpose_key(f"missed {self.settings.stream}")
        self.is_off = not self.settings.probability

    def start(self, scene: Scene) -> None:
        """Nothing is remembered."""

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: Any
    ) -> tuple[Sensed, Any]:
        """Rows in which some are not seen."""
        if not len(sensed.robot):
            return sensed, state
        s, lost = self.settings, np.empty(len(sensed.robot), np.bool_)
        key = np.array([scene.seed, self._purpose], dtype=np.uint64)
        slot = sensed.step // s.slot_steps(scene.dt)
        put_missed(
            key, self._chance, slot, scene.robots, sensed.first, sensed.end, sensed.robot,
            sensed.pose, lost,
        )  # fmt: skip
        return unseen(sensed, lost), state


@compiled
def put_missed(
    key: Words,
    chance: Chance,
    slot: int,
    robots: int,
    first: IntArray,
    end: IntArray,
    robot: IntArray,
    pose: Rows3,
    out: Flags,
) -> None:
    """Write of which bodies a detection is lost in a slot, among those that are seen."""
    for i in range(robots):
        for row in range(first[i], end[i]):
            j = robot[row]
            out[row] = False
            if j != i and not isnan(pose[row, 0]):
                out[row] = last_drawn(key, chance, slot, i, j).is_bad
