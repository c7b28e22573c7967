"""Missed detections: now and then a robot does not see another that it could see."""

from __future__ import annotations

from typing import Any

import numpy as np

from physim.disturbances.losses import Losses, put_lost
from physim.disturbances.rows import own_rows, unseen
from physim.parts.controller import Sensed, Snapshot
from physim.parts.stages import observer_of_row
from physim.world.scene import Scene


class MissedSettings(Losses):
    """Keys of ``type: missed`` under ``sensing.stages``; each detection holds for an interval."""


class Missed:
    """Hides robots by chance, detection by detection or for several in a row."""

    Settings = MissedSettings
    on_demand = True

    def __init__(self, settings: MissedSettings | None = None) -> None:
        self.settings = settings or MissedSettings()

    def start(self, scene: Scene) -> None:
        """Nothing is remembered."""

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: Any
    ) -> tuple[Sensed, Any]:
        """Rows in which some are not seen."""
        s = self.settings
        if not s.probability or not len(sensed.robot):
            return sensed, state
        rows, key = own_rows(scene, sensed), s.key(scene.seed, "missed")
        lost = np.empty(len(rows.robot), np.bool_)
        slot, who = sensed.step // s.slot_steps(scene.dt), observer_of_row(rows)
        put_lost(key, s.chance, slot, len(lost), who, rows.robot, lost)
        return unseen(rows, lost), state
