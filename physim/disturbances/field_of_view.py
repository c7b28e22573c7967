"""Field of view: robots see what is in front of them."""

from __future__ import annotations

from math import atan2, cos, isnan, pi, sin
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from physim.compiled import compiled
from physim.disturbances.rows import moving, unseen
from physim.geometry.shapes import Flags, IntArray, Rows3
from physim.parts.controller import Sensed, Snapshot
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
        self.is_off = self.settings.angle >= 2.0 * pi

    def start(self, scene: Scene) -> None:
        """Nothing is remembered."""

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: Any
    ) -> tuple[Sensed, Any]:
        """Rows in which those outside are not seen, by where they really are."""
        if not len(sensed.robot):
            return sensed, state
        hidden = np.empty(len(sensed.robot), np.bool_)
        half, (pose, _) = 0.5 * self.settings.angle, moving(truth)
        put_aside(
            half, scene.robots, pose, sensed.first, sensed.end, sensed.robot, sensed.pose, hidden
        )
        return unseen(sensed, hidden), state


@compiled
def put_aside(
    half: float,
    robots: int,
    pose: Rows3,
    first: IntArray,
    end: IntArray,
    robot: IntArray,
    seen: Rows3,
    out: Flags,
) -> None:
    """Write which of those seen stand outside an angle ``half`` to either side of the heading."""
    for i in range(robots):
        c, s = cos(pose[i, 2]), sin(pose[i, 2])
        for row in range(first[i], end[i]):
            j = robot[row]
            dx, dy = pose[j, 0] - pose[i, 0], pose[j, 1] - pose[i, 1]
            out[row] = (
                j != i
                and not isnan(seen[row, 0])
                and abs(atan2(c * dy - s * dx, c * dx + s * dy)) > half
            )
