"""What a run is: its time, the parts it names (controller, sensing, filters, disturbances), when
robots have arrived, the material in contact, and what the run must satisfy.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    WithJsonSchema,
    field_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from physim.world.base import Model
from physim.world.kinds import (
    Distance,
    Flag,
    FrozenMapping,
    Label,
    Length,
    Number,
    Whole,
    thawed,
)

MOST_STAGES = 20
DEFAULT_RANGE = 10.0
"""[m] sensing range in a world that does not give one (paper: 10 m)"""


def _settings(value: Any) -> FrozenMapping:
    if not isinstance(value, Mapping):
        raise PydanticCustomError("mapping_type", "must be a mapping")
    if "type" in value:
        raise PydanticCustomError("settings", "must not hold type, which names the part itself")
    # by name: two files that give the same settings are one world, of one digest
    return FrozenMapping(
        {key: value[key] for key in sorted(value, key=str) if value[key] is not None}
    )


class Choice(Model):
    """One registered part of a run by name and its settings, which that part itself checks.

    In a world file both stand in one mapping: ``{type: NAME, KEY: VALUE, …}``. A setting of None is
    left out, as ``--set KEY=null`` leaves it out.
    """

    type: Label = Field(description="name under which it is registered")
    settings: Annotated[
        FrozenMapping,
        BeforeValidator(_settings),
        WithJsonSchema({"type": "object"}),
    ] = Field(default_factory=FrozenMapping, description="its settings")

    model_config = ConfigDict(arbitrary_types_allowed=True, json_schema_extra={"description": ""})

    @field_serializer("settings")
    def _plain_settings(self, settings: FrozenMapping) -> dict[str, Any]:
        return dict(thawed(settings))


def nested_choice(value: Any) -> Any:
    """Part the flat mapping of the file into the type and the settings."""
    if isinstance(value, Choice):
        return value
    if not isinstance(value, Mapping):
        message = "must be a mapping of type and settings, as {type: NAME}"
        raise PydanticCustomError("choice", message)
    settings = {key: item for key, item in value.items() if key != "type"}
    return {**({"type": value["type"]} if "type" in value else {}), "settings": settings}


def _listed(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return value
    raise PydanticCustomError("choices", "must be a list, as [{type: NAME, KEY: VALUE}]")


Choices = Annotated[
    tuple[Annotated[Choice, BeforeValidator(nested_choice)], ...],
    Field(max_length=MOST_STAGES),
    BeforeValidator(_listed),
]


class Sensing(Model):
    """What robots perceive of one another and of the walls."""

    range: Length | None = Field(
        default=None,
        description="[m] distance within which robots sense other robots and walls; when absent, "
        f"formation.range, or {DEFAULT_RANGE:g} without a formation",
    )
    stages: Choices = Field(default=(), description="parts that change what is sensed, in order")


class ControllerChoice(Choice):
    """A controller by name and its settings, which the controller itself checks.

    In a world file both stand in one mapping: ``{type: mode_switching, look_ahead: 2.0}``.
    """

    type: Label = Field(default="mode_switching", description="name of a registered controller")


class OwnController(Choice):
    """The controller of one robot or group, in place of the world's; as a `ControllerChoice`.

    Its type is always written: settings without one might be meant for the world's controller.
    """


OfRobots = Annotated[
    Annotated[OwnController, BeforeValidator(nested_choice)] | None,
    Field(
        description="controller of this robot or group, as {type: NAME, KEY: VALUE}, instead of "
        "the world's; settings of the world's controller do not apply to it"
    ),
]


class DriveChoice(Choice):
    """What moves a robot, by name, and its settings, which the drive itself checks."""

    @model_validator(mode="before")
    @classmethod
    def _of_a_word(cls, value: Any) -> Any:
        return {"type": value} if isinstance(value, str) else nested_choice(value)


OfDrive = Annotated[
    DriveChoice | None,
    Field(
        description="what moves it: the name of a drive, or {type: NAME, KEY: VALUE}; a unicycle "
        "that follows every command at once when absent"
    ),
]


class Time(Model):
    """Grid of physics steps: sample k is at time ``k * step``."""

    step: Annotated[Number, Field(ge=1e-6, le=0.5)] = Field(description="[s] one physics step")
    duration: Annotated[Number, Field(gt=0.0, le=1.0e8)] = Field(
        description="[s] length of the run, a whole number of steps"
    )
    record_every: Annotated[Whole, Field(ge=1, le=1_000_000)] = Field(
        default=1, description="[steps] steps from one recorded sample to the next"
    )

    @property
    def steps(self) -> int:
        """Number of physics steps of the run."""
        return round(self.duration / self.step)


class Arrival(Model):
    """When a robot counts as arrived: at its stop station, and standing for 0.5 s.

    It is no farther beside the stop station than at its start, or half its width if that is more.
    It stands where it moves by no more than 1 cm, or a twentieth of its radius if that is less.
    """

    tolerance: Distance = Field(
        default=0.1,
        description="[m] a robot that stands has arrived if it is this near its stop station along "
        "its path, before or past it",
    )


class Physics(Model):
    """Material of all bodies in contact."""

    friction: Annotated[Number, Field(ge=0.0, le=100.0)] = Field(
        default=0.0, description="[-] Coulomb friction coefficient"
    )
    elasticity: Annotated[Number, Field(ge=0.0, le=1.0)] = Field(
        default=0.0,
        description="[-] coefficient of restitution, 0 to 1; it changes impulse and energy of an "
        "impact, but robots do not bounce, because they follow their commands again at once",
    )


Signed = Annotated[Number, Field(ge=-1.0e6, le=1.0e6)]


class Expectation(Model):
    """What a run must satisfy; a run that does not ends with exit code 1."""

    contacts: Annotated[Whole, Field(ge=0)] | None = Field(
        default=None, description="largest number of contacts, those between two samples included"
    )
    min_distance: Signed | None = Field(
        default=None,
        description="[m] least distance of a robot from another, from a mover and from an obstacle "
        "that can be pushed; below 0: how deep they may overlap",
    )
    min_boundary_distance: Signed | None = Field(
        default=None,
        description="[m] least distance between a robot and a boundary or obstacle; below 0: how "
        "deep they may overlap",
    )
    max_distance: Distance | None = Field(
        default=None, description="[m] greatest distance between two robots"
    )
    finished: Flag | None = Field(
        default=None,
        description="whether all robots arrive: stand at their stop stations at one time",
    )
