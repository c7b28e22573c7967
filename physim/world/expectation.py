"""What a run must show."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from physim.world.base import Model
from physim.world.kinds import Distance, Flag, Whole


class Expectation(Model):
    """What a run must show; a run that does not ends with exit code 1."""

    contacts: Annotated[Whole, Field(ge=0)] | None = Field(
        default=None, description="largest number of contacts, touches between two samples included"
    )
    min_distance: Distance | None = Field(
        default=None, description="[m] least distance between two robots"
    )
    min_boundary_distance: Distance | None = Field(
        default=None, description="[m] least distance between a robot and a boundary or obstacle"
    )
    max_distance: Distance | None = Field(
        default=None, description="[m] greatest distance between two robots"
    )
    finished: Flag | None = Field(
        default=None, description="whether all robots arrive at their stop stations"
    )
