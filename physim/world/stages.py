"""What stands between the world and its robots: sensing, filters, disturbances, each by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, WithJsonSchema, field_serializer
from pydantic_core import PydanticCustomError

from physim.world.base import Model
from physim.world.frozen import FrozenMapping, thawed
from physim.world.kinds import Label, Length, at_most

MOST_STAGES = 20


class Choice(Model):
    """One registered part of a run by name and its settings, which that part itself checks.

    In a world file both stand in one mapping: ``{type: NAME, KEY: VALUE, …}``.
    """

    type: Label = Field(description="name under which it is registered")
    settings: Annotated[
        FrozenMapping,
        BeforeValidator(lambda value: _settings(value)),
        WithJsonSchema({"type": "object"}),
    ] = Field(default_factory=FrozenMapping, description="its settings")

    model_config = ConfigDict(arbitrary_types_allowed=True)

    @field_serializer("settings")
    def _plain_settings(self, settings: FrozenMapping) -> dict[str, Any]:
        return dict(thawed(settings))


def _settings(value: Any) -> FrozenMapping:
    if not isinstance(value, Mapping):
        raise PydanticCustomError("mapping_type", "must be a mapping")
    return FrozenMapping(value)


def nested_choice(value: Any) -> Any:
    """Part the flat mapping of the file into the type and the settings."""
    if not isinstance(value, Mapping):
        return value
    settings = {key: item for key, item in value.items() if key != "type"}
    return {**({"type": value["type"]} if "type" in value else {}), "settings": settings}


Choices = Annotated[
    tuple[Annotated[Choice, BeforeValidator(nested_choice)], ...], at_most(MOST_STAGES)
]


class Sensing(Model):
    """What robots perceive of one another and of the walls."""

    range: Length | None = Field(
        default=None,
        description="[m] within which robots see and consider others and walls; "
        "formation.range when absent, 10 without a formation",
    )
    stages: Choices = Field(
        default=(), description="what changes what is sensed, by name, one after the other"
    )
