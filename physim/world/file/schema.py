"""JSON Schema (draft 2020-12) of a world file, made from the models, for editors to complete.

It checks keys, kinds and bounds; what lies between several values (either corridor or boundaries,
leads as many as robots) and all geometry is left to reading.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema

from physim.errors import ControllerError
from physim.parts.registry import (
    CONTROLLER,
    DRIVE,
    STAGES,
    Kind,
    find_part,
    part_names,
    settings_model,
)
from physim.world import Choice, ControllerChoice, World
from physim.world.run import DriveChoice

FILE = "world.schema.json"
"""Name of the schema where it stands beside worlds."""

Schema = dict[str, Any]


class _Generator(GenerateJsonSchema):
    """Without null: a key that is left out has no value, and one without a value is refused."""

    def nullable_schema(self, schema: Any) -> Schema:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: Any) -> Schema:
        is_shown = not isinstance(schema.get("default"), None | BaseModel)
        return super().default_schema(schema) if is_shown else self.generate_inner(schema["schema"])

    def field_title_should_be_set(self, _schema: Any) -> bool:
        return False


def schema_text(names: Callable[[Kind], Iterable[str]] = part_names) -> str:
    """Text of the schema file; the one that is shipped is of `shipped_parts` alone.

    ``names`` says which controllers and stages of a kind are in it; one that cannot be imported
    may be named, and its settings are not checked.
    """
    schema = World.model_json_schema(schema_generator=_Generator)
    models = schema["$defs"]
    models[_name(CONTROLLER)] = _choice(CONTROLLER, names, ControllerChoice)
    models["OwnController"] = {
        "$ref": f"#/$defs/{_name(CONTROLLER)}",
        "description": "the controller of one robot or group; its type is always written",
        "required": ["type"],
    }
    models.pop(Choice.__name__, None)
    models[_name(DRIVE)] = _choice(DRIVE, names, DriveChoice)
    by_name = models[_name(DRIVE)]["properties"]["type"]
    models[DriveChoice.__name__] = {
        "description": "a drive by its name, or with its settings",
        "anyOf": [by_name, {"$ref": f"#/$defs/{_name(DRIVE)}"}],
    }
    for kind in STAGES:
        models[_name(kind)] = _choice(kind, names, Choice)
        holder = models["Sensing"] if len(kind.key) > 1 else schema
        holder["properties"][kind.key[-1]]["items"] = {"$ref": f"#/$defs/{_name(kind)}"}
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "physim world"}
    schema = {**head, **schema, "title": "physim world"}
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def _name(kind: Kind) -> str:
    """Name of the schema of parts of a kind."""
    return ControllerChoice.__name__ if kind is CONTROLLER else str(kind.key[-1])


def _choice(kind: Kind, names: Callable[[Kind], Iterable[str]], model: type[Choice]) -> Schema:
    """Schema of a part that is named by its type, on which its keys depend."""
    field, listed = model.model_fields["type"], list(names(kind))
    rules: list[Schema] = []
    for name in listed:
        chosen: Schema = {"properties": {"type": {"const": name}}}
        if name != field.default:
            chosen["required"] = ["type"]  # without a type the condition would hold, too
        try:
            settings = settings_model(find_part(kind, name))
        except ControllerError:
            continue
        then: Schema = {}
        if settings is not None:
            inner = f"#/$defs/{_name(kind)}/allOf/{len(rules)}/then/$defs/{{model}}"
            then = settings.model_json_schema(True, inner, _Generator)
        then["properties"] = {"type": True, **then.get("properties", {})}
        rules.append({"if": chosen, "then": {**then, "additionalProperties": False}})
    named = {"description": field.description, "type": "string", "enum": listed}
    schema: Schema = {
        "description": f"one {kind.word}; its keys are those of its type",
        "type": "object",
        "properties": {"type": named},
        "required": ["type"] if field.is_required() else [],
    }
    return {**schema, "allOf": rules} if rules else schema
