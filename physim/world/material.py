"""Material of all bodies in contact."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from physim.world.base import Model
from physim.world.kinds import Number


class Physics(Model):
    """Material of all bodies in contact."""

    friction: Annotated[Number, Field(ge=0.0, le=100.0)] = Field(
        default=0.0, description="[-] Coulomb friction coefficient"
    )
    elasticity: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.0, description="[-] 0: no bounce, 1: elastic"
    )
