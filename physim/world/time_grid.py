"""Grid of physics steps: how long a run lasts and how finely it is cut."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from physim.world.base import Model
from physim.world.kinds import Number, Whole


class Time(Model):
    """Grid of physics steps: sample k is at time ``k * step``."""

    step: Annotated[Number, Field(gt=0.0, le=10.0)] = Field(description="[s] one physics step")
    duration: Annotated[Number, Field(gt=0.0, le=1.0e8)] = Field(
        description="[s] length of the run, a whole number of steps"
    )
    record_every: Annotated[Whole, Field(ge=1, le=1_000_000)] = Field(
        default=1, description="[steps] from one recorded sample to the next"
    )

    @property
    def steps(self) -> int:
        """Number of physics steps of the run."""
        return round(self.duration / self.step)
