"""When a robot counts as arrived."""

from __future__ import annotations

from pydantic import Field

from physim.world.base import Model
from physim.world.kinds import Distance


class Arrival(Model):
    """When a robot counts as arrived: at its stop station, and standing for 0.5 s."""

    tolerance: Distance = Field(
        default=0.1,
        description="[m] along its path by which a robot that stands may be short of its stop "
        "station",
    )
