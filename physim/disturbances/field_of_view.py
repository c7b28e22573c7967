"""Field of view: robots see what is in front of them."""

from __future__ import annotations

from math import cos, isnan, pi, sin, sqrt
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from physim.compiled import compiled
from physim.disturbances.rows import Rows, Stage
from physim.geometry.shapes import Flags
from physim.world.scene import Scene


class FieldOfViewSettings(BaseModel):
    """Keys of ``type: field_of_view`` under ``sensing.stages``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    angle: Annotated[float, Field(ge=0.0, le=2.0 * pi)] = Field(
        default=2.0 * pi, description="[rad] whole angle, half of it to either side of the heading"
    )


class FieldOfView(Stage):
    """Hides robots whose reference points lie outside an angle about the heading."""

    Settings = FieldOfViewSettings

    def __init__(self, settings: FieldOfViewSettings | None = None) -> None:
        self.settings = settings or FieldOfViewSettings()
        self.is_off = self.settings.angle >= 2.0 * pi

    def hide(self, scene: Scene, step: int, rows: Rows, out: Flags) -> None:
        """Write which rows (M,) are about bodies outside, by where they really are."""
        put_aside(0.5 * self.settings.angle, rows, out)


@compiled
def put_aside(half: float, rows: Rows, out: Flags) -> None:
    """Write which of those seen stand outside an angle ``half`` to either side of the heading."""
    pose, least = rows.truth, cos(half)
    for i in range(rows.observers):
        c, s = cos(pose[i, 2]), sin(pose[i, 2])
        for row in range(rows.first[i], rows.end[i]):
            j = rows.robot[row]
            dx, dy = pose[j, 0] - pose[i, 0], pose[j, 1] - pose[i, 1]
            ahead, far = c * dx + s * dy, sqrt(dx * dx + dy * dy)
            out[row] = ahead < least * far and j != i and not isnan(rows.seen[row, 0])
