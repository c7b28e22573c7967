"""One robot: its shape, start, path and limits."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from physim.world.base import Model
from physim.world.kinds import Label, Number, Point, Polygon, Polyline, Pose, at_most, plain
from physim.world.start import Start

OMEGA_LIMIT = 1.6
"""[rad/s] of a robot whose world gives no limit"""
Multiples = Annotated[
    tuple[Annotated[Number, Field(ge=-1.0, le=1.0)], ...], at_most(1000), Field(min_length=1)
]
Speeds = Annotated[tuple[Number, ...], at_most(1000), Field(min_length=1)]


class Box(Model):
    """Rectangle centred on the reference point, its length along the heading."""

    length: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(description="[m] along the heading")
    width: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(description="[m] across the heading")

    @property
    def corners(self) -> tuple[Point, ...]:
        """The four corners [m], robot's frame, counter-clockwise."""
        x, y = 0.5 * self.length, 0.5 * self.width
        return ((-x, -y), (x, -y), (x, y), (-x, y))


class Offset(Model):
    """Path that runs beside the reference path."""

    offset: Annotated[Number, Field(ge=-1.0e6, le=1.0e6)] = Field(
        description="[m] from the reference path, left positive"
    )


class Limits(Model):
    """Largest commands that a robot can follow."""

    v: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(
        default=1.5, description="[m/s] largest forward or backward speed"
    )
    omega: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(
        default=OMEGA_LIMIT, description="[rad/s] largest rotational speed, either way"
    )


def _mapping_or_list(value: Any) -> str:
    return "<list>" if isinstance(plain(value), list | tuple) else "<mapping>"


Footprint = Annotated[
    Annotated[Box, Tag("<mapping>")] | Annotated[Polygon, Tag("<list>")],
    Discriminator(_mapping_or_list),
]
RobotPath = Annotated[
    Annotated[Offset, Tag("<mapping>")] | Annotated[Polyline, Tag("<list>")],
    Discriminator(_mapping_or_list),
]


class Robot(Model):
    """One robot: its shape, where it starts, which path it follows and what it can do."""

    name: Label = Field(description="label, different for every robot")
    footprint: Footprint = Field(
        description="[m] {length, width} centred on the reference point, or corners [x, y] in the "
        "robot's frame (x forward), nonconvex too"
    )
    pose: Pose | None = Field(
        default=None,
        description="[m, m, rad] start x, y and heading (counter-clockwise from the x axis), which "
        "may be the word random; without it a start region is needed",
    )
    start: Start | None = Field(
        default=None,
        description="region to be placed in by the seed, instead of a pose; without either, the "
        "world's start",
    )
    path: RobotPath = Field(
        description="[m] waypoints [x, y], or {offset} from the reference path, left positive"
    )
    limits: Limits = Field(default=Limits(), description="largest commands of this robot")
    mass: Annotated[Number, Field(gt=0.0, le=1.0e9)] | None = Field(
        default=None, description="[kg] 100 kg/m² times the area of the footprint when absent"
    )
    speeds: Multiples | None = Field(
        default=None,
        description="[-] forward speeds to choose from, as multiples of nu, between -1 and 1, "
        "instead of the controller's",
    )
    omegas: Speeds | None = Field(
        default=None,
        description="[rad/s] rotational speeds to choose from, instead of the controller's",
    )

    @property
    def outline(self) -> tuple[Point, ...]:
        """Corners of the footprint [m], robot's frame, as written (a box counter-clockwise)."""
        return self.footprint.corners if isinstance(self.footprint, Box) else self.footprint
