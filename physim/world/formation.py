"""Formation control: speeds, wanted leads, and who keeps distance to whom."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from physim.world.base import Model
from physim.world.kinds import MOST_ROBOTS, Label, Length, Number, Sequence, at_most


def _word_or_list(value: Any) -> str:
    return "<word>" if isinstance(value, str) else "<list>"


class Formation(Model):
    """Speed control that keeps the robots at wanted distances along the reference path, (7)."""

    gain: Annotated[Number, Field(ge=0.0, le=1000.0)] = Field(
        default=0.05, description="[1/s] alpha of equation (7)"
    )
    speed: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(
        default=1.0, description="[m/s] nu_0, steady speed of the cluster"
    )
    limits: Annotated[
        tuple[
            Annotated[Number, Field(ge=0.0, le=1000.0)], Annotated[Number, Field(gt=0.0, le=1000.0)]
        ],
        Sequence,
    ] = Field(default=(0.8, 1.3), description="[m/s] least and greatest speed that (7) may give")
    spacing: Annotated[
        Annotated[Literal["initial"], Tag("<word>")]
        | Annotated[
            tuple[Annotated[Number, Field(ge=-1.0e6, le=1.0e6)], ...],
            at_most(MOST_ROBOTS),
            Tag("<list>"),
        ],
        Discriminator(_word_or_list),
    ] = Field(
        default="initial",
        description="[m] wanted lead of each robot over the first along the reference path, "
        "the first being 0; or the word initial: as they start",
    )
    range: Length = Field(
        default=10.0,
        description="[m] along the reference path within which robots are formation neighbours; "
        "also the range of sight, unless sensing.range says otherwise",
    )
    neighbours: Annotated[
        Annotated[Literal["range", "all"], Tag("<word>")]
        | Annotated[
            tuple[Annotated[tuple[Label, Label], Sequence], ...],
            at_most(100_000),
            Tag("<list>"),
        ],
        Discriminator(_word_or_list),
    ] = Field(
        default="range",
        description="who keeps distance to whom: those within range, all, or pairs of names",
    )
