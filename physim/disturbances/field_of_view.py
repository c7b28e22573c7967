"""Field of view: robots see what is in front of them."""

from __future__ import annotations

from math import pi
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from physim.disturbances.rows import moving, own_rows, unseen
from physim.parts.controller import Sensed, Snapshot
from physim.parts.stages import observer_of_row
from physim.world.scene import Scene


class FieldOfViewSettings(BaseModel):
    """Keys of ``type: field_of_view`` under ``sensing.stages``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    angle: Annotated[float, Field(ge=0.0, le=2.0 * pi)] = Field(
        default=2.0 * pi, description="[rad] whole angle, half of it to either side of the heading"
    )


class FieldOfView:
    """Hides robots whose reference points lie outside an angle about the heading."""

    Settings = FieldOfViewSettings
    on_demand = True

    def __init__(self, settings: FieldOfViewSettings | None = None) -> None:
        self.settings = settings or FieldOfViewSettings()

    def start(self, scene: Scene) -> None:
        """Nothing is remembered."""

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: Any
    ) -> tuple[Sensed, Any]:
        """Rows in which those outside are not seen, by where they really are."""
        half = 0.5 * self.settings.angle
        if half >= pi or not len(sensed.robot):
            return sensed, state
        rows, (pose, _) = own_rows(scene, sensed), moving(truth)
        who = observer_of_row(rows)
        x, y, _ = (pose[rows.robot] - pose[who]).T
        bearing = np.arctan2(y, x) - pose[who, 2]
        aside = np.abs(np.remainder(bearing + pi, 2.0 * pi) - pi)
        return unseen(rows, (aside > half) & (rows.robot != who)), state
