"""A robot that goes ahead and back and turns on the spot, equation (1): the drive of the paper.

Without accelerations it follows every command at once.
"""

from __future__ import annotations

from math import inf
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from physim.geometry.shapes import FloatArray
from physim.parts.drive import Most, towards

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class UnicycleSettings(BaseModel):
    """Keys under ``drive:`` for ``type: unicycle``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    acceleration: Positive | None = Field(
        default=None,
        description="[m/s²] greatest change of v in a second, speeding up and braking; at once "
        "when absent",
    )
    turn_acceleration: Positive | None = Field(
        default=None,
        description="[rad/s²] greatest change of omega in a second; at once when absent",
    )


class Unicycle:
    """Goes ahead and back, and turns on the spot, with limited accelerations."""

    Settings = UnicycleSettings

    def __init__(self, settings: UnicycleSettings | None = None) -> None:
        self.settings = settings or UnicycleSettings()
        self._rates = np.array([
            inf if rate is None else rate
            for rate in (self.settings.acceleration, self.settings.turn_acceleration)
        ])  # fmt: skip

    def most(self, v: float, omega: float) -> Most:
        """The limits."""
        return Most(v, omega, acceleration=float(self._rates[0]))

    def follow(self, command: FloatArray, state: FloatArray, dt: float) -> FloatArray:
        """Both speeds change by no more than the accelerations allow."""
        out = np.zeros((len(command), 4))
        out[:, :2] = towards(command[:, :2], state[:, :2], self._rates * dt)
        return out

    def reach(self, state: FloatArray, time: float) -> FloatArray:
        """The present speeds, and what the accelerations add to either side."""
        (v, omega, *_), (dv, domega) = state.T, self._rates * time
        curvature = np.full(len(v), inf)
        return np.column_stack(
            (v - dv, v + dv, omega - domega, omega + domega, -curvature, curvature)
        )
