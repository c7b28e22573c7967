"""A road by its centreline and width, instead of boundaries drawn by hand."""

from __future__ import annotations

from typing import Annotated

from pydantic import Discriminator, Field, Tag

from physim.world.base import Model
from physim.world.kinds import Length, Polyline, at_most, plain


class Corridor(Model):
    """Road of given width along a centreline, closed by caps beyond both ends."""

    centreline: Polyline = Field(description="[m] middle of the corridor, points [x, y]")
    width: Annotated[
        Annotated[Length, Tag("<value>")]
        | Annotated[tuple[Length, ...], at_most(100_000), Field(min_length=2), Tag("<list>")],
        Discriminator(
            lambda value: "<list>" if isinstance(plain(value), list | tuple) else "<value>"
        ),
    ] = Field(description="[m] full width: one number, or one per point of the centreline")
    end_margin: Length = Field(
        default=3.0, description="[m] from either end of the centreline to the cap that closes it"
    )
