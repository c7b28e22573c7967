"""Robots: shape, path and limits, where they start, and the formation that they keep."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, Tag

from physim.escaping import escaped
from physim.world.base import Model
from physim.world.kinds import (
    MOST_ROBOTS,
    Angle,
    Distance,
    Label,
    Length,
    Number,
    Point,
    Polygon,
    Polyline,
    Pose,
    Sequence,
    Whole,
    either,
)
from physim.world.run import OfDrive, OfRobots

StartHeading = Annotated[
    Annotated[Literal["random", "along"], Tag("<word>")] | Annotated[Angle, Tag("<value>")],
    either("<word>", "<value>"),
]


class Start(Model):
    """Region in which robots are placed by the seed, whole footprints inside, none touching."""

    region: Polygon = Field(
        description="[m] corners [x, y] of the region in which whole footprints lie at the start"
    )
    heading: StartHeading = Field(
        default="random",
        description="[rad] heading, counter-clockwise from the x axis; or the word random; or the "
        "word along: the direction of the reference path there",
    )
    min_gap: Distance = Field(
        default=0.3,
        description="[m] least distance at the start to other robots, boundaries and obstacles",
    )
    abreast: Annotated[Whole, Field(ge=1, le=1000)] | None = Field(
        default=None,
        description="number of robots in each row across the reference path; robots stand in their "
        "order, the first row in front; when absent, anywhere in the region",
    )
    spread: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=1.0,
        description="[-] with abreast: part of its cell in which a robot is placed, from 0 (in the "
        "middle: even rows and columns) to 1 (anywhere in the cell)",
    )


class Box(Model):
    """Rectangle centred on the reference point, its length along the heading."""

    length: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(
        description="[m] size along the heading"
    )
    width: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(
        description="[m] size across the heading"
    )

    @property
    def corners(self) -> tuple[Point, ...]:
        """The four corners [m], robot's frame, counter-clockwise."""
        x, y = 0.5 * self.length, 0.5 * self.width
        return ((-x, -y), (x, -y), (x, y), (-x, y))


class Offset(Model):
    """Path that runs beside the reference path."""

    offset: Annotated[Number, Field(ge=-1.0e6, le=1.0e6)] = Field(
        description="[m] distance from the reference path, left positive"
    )


class Limits(Model):
    """Largest commands that a robot can follow."""

    v: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(
        default=1.5, description="[m/s] largest forward or backward speed"
    )
    omega: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(
        default=1.6, description="[rad/s] largest rotational speed, in either direction"
    )


Footprint = Annotated[
    Annotated[Polygon, Tag("<list>")] | Annotated[Box, Tag("<mapping>")],
    either("<list>", "<mapping>"),
]
RobotPath = Annotated[
    Annotated[Polyline, Tag("<list>")] | Annotated[Offset, Tag("<mapping>")],
    either("<list>", "<mapping>"),
]
Mass = Annotated[
    Annotated[Number, Field(gt=0.0, le=1.0e9)] | None,
    Field(
        description="[kg] mass of one robot; 100 kg/m² times the area of its footprint when absent"
    ),
]
Multiples = Annotated[
    Annotated[
        tuple[Annotated[Number, Field(ge=-1.0, le=1.0)], ...],
        Field(min_length=1, max_length=1000),
        Sequence,
    ]
    | None,
    Field(
        description="[-] forward speeds to choose from, as multiples of nu, between -1 and 1, "
        "instead of the controller's"
    ),
]
Speeds = Annotated[
    Annotated[tuple[Number, ...], Field(min_length=1, max_length=1000), Sequence] | None,
    Field(description="[rad/s] rotational speeds to choose from, instead of the controller's"),
]


def outline_of(footprint: Box | tuple[Point, ...]) -> tuple[Point, ...]:
    """Corners of a footprint [m], robot's frame, as written (a box counter-clockwise)."""
    return footprint.corners if isinstance(footprint, Box) else footprint


class Robot(Model):
    """One robot: its shape, where it starts, which path it follows and what it can do."""

    name: Label = Field(description="label, different for every robot")
    footprint: Footprint = Field(
        description="[m] {length, width} centred on the reference point, or corners [x, y] in the "
        "robot's frame (x forward), nonconvex too; a circle is written as a polygon"
    )
    pose: Pose | None = Field(
        default=None,
        description="[m, m, rad] start x, y and heading (counter-clockwise from the x axis, or the "
        "word random); without a pose, a start region is needed",
    )
    start: Start | None = Field(
        default=None,
        description="region in which the seed places the robot, instead of a pose; without both, "
        "the world's start",
    )
    path: RobotPath = Field(
        description="[m] waypoints [x, y], or {offset} from the reference path, left positive"
    )
    limits: Limits = Field(default=Limits(), description="largest commands of this robot")
    drive: OfDrive = None
    mass: Mass = None
    speeds: Multiples = None
    omegas: Speeds = None
    controller: OfRobots = None

    def __repr__(self) -> str:
        """Name and start in brief; its attributes hold all of it."""
        start = "placed by the seed" if self.pose is None else f"pose {list(self.pose)}"
        return f'<Robot "{escaped(self.name)}": {start}>'

    @property
    def outline(self) -> tuple[Point, ...]:
        """Corners of the footprint [m], robot's frame, as written (a box counter-clockwise)."""
        return outline_of(self.footprint)


class Formation(Model):
    """Speed control that keeps the robots at wanted distances along the reference path, (7)."""

    gain: Annotated[Number, Field(ge=0.0, le=1000.0)] = Field(
        default=0.05, description="[1/s] gain of the speed control, alpha of equation (7)"
    )
    speed: Annotated[Number, Field(gt=0.0, le=1000.0)] = Field(
        default=1.0, description="[m/s] steady speed of the formation, nu_0"
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
            Field(max_length=MOST_ROBOTS),
            Sequence,
            Tag("<list>"),
        ],
        either("<word>", "<list>"),
    ] = Field(
        default="initial",
        description="[m] desired lead of each robot over the first robot along the reference "
        "path (0 for the first); or the word initial: the leads at the start",
    )
    range: Length = Field(
        default=10.0,
        description="[m] distance along the reference path within which robots are neighbours; "
        "also the sensing range, unless sensing.range is given",
    )
    neighbours: Annotated[
        Annotated[Literal["range", "all"], Tag("<word>")]
        | Annotated[
            tuple[Annotated[tuple[Label, Label], Sequence], ...],
            Field(max_length=100_000),
            Sequence,
            Tag("<list>"),
        ],
        either("<word>", "<list>"),
    ] = Field(
        default="range",
        description="robots that keep their distance to each other: those within range, all, or "
        "pairs of names",
    )
