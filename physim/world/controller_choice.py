"""Which controller decides, by name, and its settings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, WithJsonSchema, field_serializer
from pydantic_core import PydanticCustomError

from physim.world.base import Model
from physim.world.frozen import FrozenMapping, thawed
from physim.world.kinds import Label


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


def nested_choice(value: Any) -> Any:
    """Part the flat mapping of the file into the type and the settings."""
    if not isinstance(value, Mapping):
        return value
    settings = {key: item for key, item in value.items() if key != "type"}
    return {**({"type": value["type"]} if "type" in value else {}), "settings": settings}
