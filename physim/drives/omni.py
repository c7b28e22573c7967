"""An omnidirectional robot: it goes ahead, sideways and turns, all at once and on its own."""

from __future__ import annotations

from math import inf
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from physim.geometry.shapes import FloatArray
from physim.parts.drive import Most, towards

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class OmniSettings(BaseModel):
    """Keys under ``drive:`` for ``type: omni``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    lateral: Annotated[float, Field(gt=0.0, le=1000.0)] | None = Field(
        default=None,
        description="[m/s] greatest speed sideways, in either direction; limits.v when absent",
    )
    acceleration: Positive | None = Field(
        default=None,
        description="[m/s²] greatest change of the velocity, seen from the robot, in a second; at "
        "once when absent",
    )
    turn_acceleration: Positive | None = Field(
        default=None,
        description="[rad/s²] greatest change of omega in a second; at once when absent",
    )


class Omni:
    """Goes in every direction, whichever way it faces, and turns meanwhile."""

    Settings = OmniSettings

    def __init__(self, settings: OmniSettings | None = None) -> None:
        own = self.settings = settings or OmniSettings()
        self._acceleration = inf if own.acceleration is None else own.acceleration
        self._turning = inf if own.turn_acceleration is None else own.turn_acceleration

    def most(self, v: float, omega: float) -> Most:
        """The limits, and the greatest speed sideways."""
        lateral = self.settings.lateral
        return Most(v, omega, v if lateral is None else lateral, acceleration=self._acceleration)

    def follow(self, command: FloatArray, state: FloatArray, dt: float) -> FloatArray:
        """The velocity goes straight towards the one wanted, no faster than it can."""
        out, most = np.zeros((len(command), 4)), self._acceleration * dt
        change = command[:, ::2] - state[:, :3:2]
        length = np.hypot(*change.T)
        share = np.where(length > most, most / np.where(length > 0.0, length, 1.0), 1.0)[:, None]
        out[:, :3:2] = np.where(share < 1.0, state[:, :3:2] + share * change, command[:, ::2])
        out[:, 1] = towards(command[:, 1], state[:, 1], self._turning * dt)
        return out

    def reach(self, state: FloatArray, time: float) -> FloatArray:
        """The present speeds, and what the accelerations add to either side."""
        v, omega, *_ = state.T
        dv, domega, curvature = (
            self._acceleration * time,
            self._turning * time,
            np.full(len(v), inf),
        )
        return np.column_stack(
            (v - dv, v + dv, omega - domega, omega + domega, -curvature, curvature)
        )
