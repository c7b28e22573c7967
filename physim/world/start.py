"""Where robots without a pose start: a region in which the seed places them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from physim.world.base import Model
from physim.world.kinds import Distance, Polygon, Whole, is_word

StartHeading = Annotated[
    Annotated[float, Tag("<value>"), Field(strict=True, allow_inf_nan=False, ge=-1000.0, le=1000.0)]
    | Annotated[Literal["random", "along"], Tag("<word>")],
    Discriminator(is_word),
]


class Start(Model):
    """Region in which robots are placed by the seed, whole footprints inside, none touching."""

    region: Polygon = Field(
        description="[m] corners [x, y] of the region that holds the whole footprints at the start"
    )
    heading: StartHeading = Field(
        default="random",
        description="[rad] counter-clockwise from the x axis; or the word random; or along: that "
        "of the reference path there",
    )
    min_gap: Distance = Field(
        default=0.3,
        description="[m] least distance at the start to other robots, boundaries and obstacles",
    )
    abreast: Annotated[Whole, Field(ge=1, le=1000)] | None = Field(
        default=None,
        description="robots in a row: they stand in rows across the reference path, in their "
        "order, the first row foremost; anywhere in the region when absent",
    )
