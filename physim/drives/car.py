"""A car: the bicycle model, whose reference point is the middle of the rear axle.

There it never moves sideways. With front wheels turned by delta it follows a circle of the
curvature tan(delta) / wheelbase, so omega = v tan(delta) / wheelbase: standing, it cannot turn. A
command (v, omega) asks for a speed and for the curvature omega / v; one with v = 0 leaves the
wheels as they are.
"""

from __future__ import annotations

from math import inf, pi, tan
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from physim.geometry.shapes import FloatArray
from physim.parts.drive import Most, towards

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class CarSettings(BaseModel):
    """Keys under ``drive:`` for ``type: car``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    wheelbase: Positive = Field(
        description="[m] distance from the rear axle, whose middle is the reference point, to the "
        "front axle"
    )
    steering: Annotated[float, Field(gt=0.0, lt=pi / 2.0)] = Field(
        default=0.6, description="[rad] greatest angle of the front wheels, in either direction"
    )
    steering_rate: Positive | None = Field(
        default=None,
        description="[rad/s] greatest change of that angle in a second; at once when absent",
    )
    acceleration: Positive | None = Field(
        default=None,
        description="[m/s²] greatest change of v in a second, speeding up and braking; at once "
        "when absent",
    )


class Car:
    """Steers its front wheels and cannot turn on the spot."""

    Settings = CarSettings
    steers = True

    def __init__(self, settings: CarSettings) -> None:
        self.settings = settings
        self._rate = inf if settings.steering_rate is None else settings.steering_rate
        self._acceleration = inf if settings.acceleration is None else settings.acceleration

    def most(self, v: float, omega: float) -> Most:
        """The limits, and the curvature of the greatest angle of the wheels."""
        curvature = tan(self.settings.steering) / self.settings.wheelbase
        return Most(v, omega, curvature=curvature, acceleration=self._acceleration)

    def follow(self, command: FloatArray, state: FloatArray, dt: float) -> FloatArray:
        """Speed and wheels change by no more than they can; omega follows from both."""
        own, (wanted_v, wanted_omega, _) = self.settings, command.T
        v = towards(wanted_v, state[:, 0], self._acceleration * dt)
        goes = wanted_v != 0.0
        angle = np.arctan(own.wheelbase * wanted_omega / np.where(goes, wanted_v, 1.0))
        wanted = np.where(goes, np.clip(angle, -own.steering, own.steering), state[:, 3])
        steering = towards(wanted, state[:, 3], self._rate * dt)
        omega = v * np.tan(steering) / own.wheelbase
        omega = np.where((v == wanted_v) & (steering == wanted) & goes, wanted_omega, omega)
        return np.column_stack((v, omega, np.zeros(len(v)), steering))

    def reach(self, state: FloatArray, time: float) -> FloatArray:
        """What speed and wheels can come to, and the turn rates of both together."""
        own, v, steering = self.settings, state[:, 0], state[:, 3]
        dv, turned = self._acceleration * time, self._rate * time
        curvature = [
            np.tan(np.clip(steering + way * turned, -own.steering, own.steering)) / own.wheelbase
            for way in (-1.0, 1.0)
        ]
        speeds = v - dv, v + dv
        with np.errstate(invalid="ignore"):  # inf times 0, of wheels that stand straight
            omegas = np.array([speed * bend for speed in speeds for bend in curvature])
        low, high = np.nan_to_num(omegas).min(axis=0), np.nan_to_num(omegas).max(axis=0)
        return np.column_stack((*speeds, low, high, *curvature))
