"""A corridor that the seed draws: what is asked of the road, its width, its bends and obstacles.

The road itself is drawn by `physim.world.layout.road`, when a world is laid out.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import Annotated, Any, Literal

from pydantic import Field, Tag

from physim.world.base import Model
from physim.world.kinds import Length, Number, Sequence, Whole, either

LONGEST_ROAD = 5_000.0
"""[m]"""
MOST_BENDS = 200
MOST_CLUTTER = 50.0
"""Obstacles per 100 m"""
MARGIN = 0.3
"""[m] to either side of the widest robot in a passage that no world states"""

Metres = Annotated[Number, Field(gt=0.0, le=1000.0)]
Count = Annotated[Whole, Field(ge=0, le=MOST_BENDS)]
Turn = Annotated[Number, Field(gt=0.0, le=pi)]
Shape = Literal["box", "bar", "round", "triangle"]


class RandomRoad(Model):
    """Road that the seed draws, with obstacles beside a passage that is kept clear."""

    length: Annotated[Number, Field(gt=0.0, le=LONGEST_ROAD)] = Field(
        description="[m] length of the centreline, which begins at (0, 0) along the x axis"
    )
    bends: Annotated[
        Annotated[tuple[Count, Count], Sequence, Tag("<list>")] | Annotated[Count, Tag("<value>")],
        either("<list>", "<value>"),
    ] = Field(default=3, description="number of bends: a whole one, or the least and the greatest")
    turns: Annotated[tuple[Turn, Turn], Sequence] = Field(
        default=(0.35, 1.57),
        description="[rad] least and greatest turn of a bend, to either side",
    )
    radii: Annotated[tuple[Metres, Metres], Sequence] | None = Field(
        default=None,
        description="[m] least and greatest radius of a bend, in the middle of the road; once and "
        "twice the greatest width when absent",
    )
    width: Annotated[
        Annotated[tuple[Metres, Metres], Sequence, Tag("<list>")]
        | Annotated[Metres, Tag("<value>")],
        either("<list>", "<value>"),
    ] = Field(description="[m] full width: one number, or the least and the greatest")
    clutter: Annotated[Number, Field(ge=0.0, le=MOST_CLUTTER)] = Field(
        default=0.0, description="obstacles per 100 m of road between its ends"
    )
    sizes: Annotated[tuple[Metres, Metres], Sequence] = Field(
        default=(0.6, 2.0),
        description="[m] least and greatest size of an obstacle: diameter of the circle round it",
    )
    shapes: Annotated[tuple[Shape, ...], Field(min_length=1, max_length=100), Sequence] = Field(
        default=("box", "bar", "round", "triangle"),
        description="shapes of obstacles, of which the seed draws one for each: box, bar, round or "
        "triangle",
    )
    passage: Length | None = Field(
        default=None,
        description="[m] clear width, guaranteed along the whole reference path; when absent, what "
        f"every robot needs to turn round on its path, and {MARGIN} m more to either side",
    )
    ends: Metres = Field(
        default=15.0,
        description="[m] first and last stretch, where robots start and stop: straight, of the "
        "greatest width and without obstacles",
    )

    @property
    def least_bends(self) -> int:
        """Least number of bends."""
        return self.bends[0] if isinstance(self.bends, tuple) else self.bends

    @property
    def most_bends(self) -> int:
        """Greatest number of bends."""
        return self.bends[1] if isinstance(self.bends, tuple) else self.bends

    @property
    def widths(self) -> tuple[float, float]:
        """[m] Least and greatest width."""
        return self.width if isinstance(self.width, tuple) else (self.width, self.width)

    @property
    def bend_radii(self) -> tuple[float, float]:
        """[m] Least and greatest radius of the centreline in a bend."""
        width = self.widths[1]
        return (width, 2.0 * width) if self.radii is None else self.radii


class RandomCorridor(Model):
    """Road drawn by the seed, closed by caps beyond both ends."""

    random: RandomRoad = Field(description="what the seed draws; instead of centreline and width")
    end_margin: Length = Field(
        default=3.0,
        description="[m] distance from either end of the road to the cap that closes it",
    )


def is_random_corridor(value: Any) -> bool:
    """Whether a corridor, as read or as a model, is one that the seed draws."""
    if not isinstance(value, Mapping):
        return isinstance(value, RandomCorridor)
    return "random" in value
