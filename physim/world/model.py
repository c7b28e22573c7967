"""A world as its author writes it: the keys of the world file, with units, bounds and defaults.

Schema, hover text and comments of a saved world come from the descriptions; these begin with units.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    WithJsonSchema,
    field_serializer,
)
from pydantic_core import PydanticCustomError

from physim.errors import Fault
from physim.world.base import Model
from physim.world.frozen import FrozenMapping, thawed
from physim.world.kinds import (
    Flag,
    Label,
    Number,
    Point,
    Polygon,
    Polyline,
    Pose,
    Sequence,
    Text,
    Whole,
    at_most,
    plain,
)

MOST_ROBOTS = 10_000
MOST_WALLS = 10_000
MOST_SEED = 10**15

Length = Annotated[Number, Field(gt=0.0, le=1.0e6)]
Distance = Annotated[Number, Field(ge=0.0, le=1.0e6)]
Speeds = Annotated[tuple[Number, ...], at_most(1000), Field(min_length=1)]


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
        default=1.6, description="[rad/s] largest rotational speed, either way"
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
    pose: Pose = Field(
        description="[m, m, rad] start x, y and heading (counter-clockwise from the x axis); "
        "the heading may be the word random"
    )
    path: RobotPath = Field(
        description="[m] waypoints [x, y], or {offset} from the reference path, left positive"
    )
    limits: Limits = Field(default=Limits(), description="largest commands of this robot")
    mass: Annotated[Number, Field(gt=0.0, le=1.0e9)] | None = Field(
        default=None, description="[kg] 100 kg/m² times the area of the footprint when absent"
    )
    speeds: Speeds | None = Field(
        default=None,
        description="[-] forward speeds to choose from, as multiples of nu, between -1 and 1, "
        "instead of the controller's",
    )
    omegas: Speeds | None = Field(
        default=None, description="[rad/s] rotational speeds to choose from, likewise"
    )

    @property
    def outline(self) -> tuple[Point, ...]:
        """Corners of the footprint [m], robot's frame, as written (a box counter-clockwise)."""
        return self.footprint.corners if isinstance(self.footprint, Box) else self.footprint


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
        description="[m] along the reference path within which robots see and consider others",
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


class ControllerChoice(Model):
    """A controller by name and its settings, which the controller itself checks.

    In a world file both stand in one mapping: ``{type: mode_switching, look_ahead: 2.0}``.
    """

    type: Label = Field(default="mode_switching", description="name of a registered controller")
    settings: Annotated[
        FrozenMapping,
        BeforeValidator(lambda value: _settings(value)),
        WithJsonSchema({"type": "object"}),
    ] = Field(default_factory=FrozenMapping, description="settings of that controller")

    model_config = ConfigDict(arbitrary_types_allowed=True)

    @field_serializer("settings")
    def _plain_settings(self, settings: FrozenMapping) -> dict[str, Any]:
        return dict(thawed(settings))


def _settings(value: Any) -> FrozenMapping:
    if not isinstance(value, Mapping):
        raise PydanticCustomError("mapping_type", "must be a mapping")
    return FrozenMapping(value)


def _nested_choice(value: Any) -> Any:
    """Part the flat mapping of the file into the type and the settings."""
    if not isinstance(value, Mapping):
        return value
    settings = {key: item for key, item in value.items() if key != "type"}
    return {**({"type": value["type"]} if "type" in value else {}), "settings": settings}


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


class Physics(Model):
    """Material of all bodies in contact."""

    friction: Annotated[Number, Field(ge=0.0, le=100.0)] = Field(
        default=0.0, description="[-] Coulomb friction coefficient"
    )
    elasticity: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.0, description="[-] 0: no bounce, 1: elastic"
    )


class World(Model):
    """Everything that its author says about a run. Lengths [m], times [s], angles [rad].

    Raises `physim.errors.WorldError`, with every fault found, when made with bad values.
    """

    name: Label = Field(description="label of the world")
    description: Text = Field(default="", description="what the world shows, in a sentence")
    seed: Annotated[Whole, Field(ge=0, le=MOST_SEED)] = Field(
        default=0, description="start of every random stream"
    )
    time: Time = Field(description="step and duration")
    corridor: Corridor | None = Field(
        default=None, description="a road by centreline and width (or give boundaries)"
    )
    boundaries: Annotated[tuple[Polyline, ...], at_most(MOST_WALLS), Field(min_length=1)] | None = (
        Field(default=None, description="[m] polylines as drawn (or give a corridor)")
    )
    reference_path: Polyline | None = Field(
        default=None, description="[m] path of the formation; the centreline when absent"
    )
    robots: Annotated[tuple[Robot, ...], at_most(MOST_ROBOTS), Field(min_length=1)] = Field(
        description="list of robots, in the order of their ids"
    )
    formation: Formation | None = Field(
        default=None, description="formation control; without it every robot goes at 1 m/s"
    )
    controller: Annotated[ControllerChoice, BeforeValidator(_nested_choice)] = Field(
        default=ControllerChoice(), description="who decides, and its settings"
    )
    obstacles: Annotated[tuple[Polygon, ...], at_most(MOST_WALLS)] = Field(
        default=(), description="[m] closed, solid polygons"
    )
    expect: Expectation | None = Field(default=None, description="what the run must show")
    physics: Physics = Field(default=Physics(), description="material in contact")

    @classmethod
    def cross_faults(cls, data: Mapping[str, Any]) -> list[Fault]:
        """Faults between several values: counts, names, times; see `physim.world.rules`."""
        from physim.world.rules import cross_faults

        return cross_faults(data)

    @property
    def reference(self) -> tuple[Point, ...]:
        """Points of the reference path [m]: the centreline where none is given."""
        if self.reference_path is not None:
            return self.reference_path
        return self.corridor.centreline if self.corridor is not None else ()

    @property
    def stem(self) -> str:
        """The name as part of a file name: letters of any script, digits, ``_`` and ``-`` only."""
        return re.sub(r"[^\w-]+", "_", self.name).strip("_") or "world"

    def changed(self, **changes: Any) -> World:
        """Return this world with some values replaced; checked like a new one (WorldError)."""
        values = {key: getattr(self, key) for key in type(self).model_fields}
        return World(**{**values, **changes})

    def to_yaml(self) -> str:
        """Write the world as YAML text, units as comments; loads back equal."""
        from physim.world.yaml_text import yaml_text

        return yaml_text(self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the world to a file, whole or not at all; PhysimError when it cannot be written."""
        from physim.world.yaml_text import write_atomically

        write_atomically(Path(path), self.to_yaml())
