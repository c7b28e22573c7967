"""Missed detections: now and then a robot does not see another that it could see."""

from __future__ import annotations

from math import isnan

from physim.compiled import compiled
from physim.disturbances.losses import Chance, Losses, last_drawn
from physim.disturbances.rows import Rows, Stage
from physim.geometry.shapes import Flags
from physim.randomness import Words
from physim.world.scene import Scene


class MissedSettings(Losses):
    """Keys of ``type: missed`` under ``sensing.stages``; each detection holds for an interval."""


class Missed(Stage):
    """Hides robots by chance, detection by detection or for several in a row."""

    Settings = MissedSettings

    def __init__(self, settings: MissedSettings | None = None) -> None:
        self.settings = settings or MissedSettings()
        self.is_off = not self.settings.probability

    def hide(self, scene: Scene, step: int, rows: Rows, out: Flags) -> None:
        """Write in which rows (M,) the detection is lost."""
        slot = step // self.settings.slot_steps(scene.dt)
        put_missed(self.key(scene), self.settings.chance, slot, rows, out)


@compiled
def put_missed(key: Words, chance: Chance, slot: int, rows: Rows, out: Flags) -> None:
    """Write of which bodies a detection is lost in a slot, among those that are seen."""
    for i in range(rows.observers):
        for row in range(rows.first[i], rows.end[i]):
            j = rows.robot[row]
            out[row] = False
            if j != i and not isnan(rows.seen[row, 0]):
                out[row] = last_drawn(key, chance, slot, i, j).is_bad
