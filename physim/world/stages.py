"""What stands between the world and its robots: sensing, filters, disturbances, each by name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, WithJsonSchema, field_serializer
from pydantic_core import PydanticCustomError

from physim.world.base import Model
from physim.world.frozen import FrozenMapping, thawed
from physim.world.kinds import Label, Length, at_most

MOST_STAGES = 20
DEFAULT_RANGE = 10.0
"""[m] range of sight in a world that says nothing of it (paper: 10 m)"""
_WORD = re.compile(r"\w{1,40}")


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

    model_config = ConfigDict(arbitrary_types_allowed=True, json_schema_extra={"description": ""})

    @field_serializer("settings")
    def _plain_settings(self, settings: FrozenMapping) -> dict[str, Any]:
        return dict(thawed(settings))


def _settings(value: Any) -> FrozenMapping:
    if not isinstance(value, Mapping):
        raise PydanticCustomError("mapping_type", "must be a mapping")
    if "type" in value:
        raise PydanticCustomError("settings", "must not hold type, which names the part itself")
    return FrozenMapping(value)


def nested_choice(value: Any) -> Any:
    """Part the flat mapping of the file into the type and the settings."""
    if isinstance(value, Choice):
        return value
    if not isinstance(value, Mapping):
        name = value if isinstance(value, str) and _WORD.fullmatch(value) else "NAME"
        message = "must be a mapping of type and settings, as {type: " + name + "}"
        raise PydanticCustomError("choice", message)
    settings = {key: item for key, item in value.items() if key != "type"}
    return {**({"type": value["type"]} if "type" in value else {}), "settings": settings}


def _listed(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return value
    raise PydanticCustomError("choices", "must be a list, as [{type: NAME, KEY: VALUE}]")


Choices = Annotated[
    tuple[Annotated[Choice, BeforeValidator(nested_choice)], ...],
    at_most(MOST_STAGES),
    BeforeValidator(_listed),
]


class Sensing(Model):
    """What robots perceive of one another and of the walls."""

    range: Length | None = Field(
        default=None,
        description="[m] within which robots see and consider others and walls; "
        f"formation.range when absent, {DEFAULT_RANGE:g} without a formation",
    )
    stages: Choices = Field(
        default=(), description="what changes what is sensed, by name, one after the other"
    )
