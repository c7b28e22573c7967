"""JSON Schema (draft 2020-12) of a world file, made from the models, for editors to complete.

It checks keys, kinds and bounds; what lies between several values (either corridor or boundaries,
leads as many as robots) and all geometry is left to reading.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from physim.errors import ControllerError
from physim.parts.registry import (
    CONTROLLER,
    STAGES,
    Kind,
    find_part,
    part_names,
    settings_model,
    shipped_parts,
)
from physim.world import Choice, ControllerChoice, World

FILE = "world.schema.json"
"""Name of the schema where it stands beside worlds."""

Schema = dict[str, Any]

_BOUNDS = {
    "ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum",
}  # fmt: skip
_LENGTHS = {"minLength": "minItems", "maxLength": "maxItems"}
_NAMED = ("properties", "$defs")
"""Keys that hold schemas by names, which may be those of keys of a schema"""


class _Generator(GenerateJsonSchema):
    """Without null: a key that is left out has no value, and one without a value is refused."""

    def nullable_schema(self, schema: Any) -> Schema:
        return self.generate_inner(schema["schema"])

    def field_title_should_be_set(self, _schema: Any) -> bool:
        return False


def schema_text() -> str:
    """Text of the schema file, with every registered controller and stage."""
    return _text(world_schema())


def shipped_schema_text() -> str:
    """Text of the schema that is shipped: with what comes with physim alone."""
    return _text(world_schema(shipped_parts))


def _text(schema: Schema) -> str:
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def world_schema(names: Callable[[Kind], Iterable[str]] = part_names) -> Schema:
    """Schema of a world file, as `json.dumps` takes it.

    ``names`` says which controllers and stages of a kind are in it; one that cannot be imported
    may be named, and its settings are not checked.
    """
    schema = _mended(World.model_json_schema(schema_generator=_Generator))
    models = schema["$defs"]
    models[_name(CONTROLLER)] = _choice(CONTROLLER, names, ControllerChoice)
    del models[Choice.__name__]
    for kind in STAGES:
        models[_name(kind)] = _choice(kind, names, Choice)
        holder = models["Sensing"] if len(kind.key) > 1 else schema
        holder["properties"][kind.key[-1]]["items"] = {"$ref": f"#/$defs/{_name(kind)}"}
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "physim world"}
    return {**head, **schema, "title": "physim world"}


def _mended(raw: Any) -> Any:
    """Bounds and lengths by the names of the standard, which pydantic gives those of fields."""
    if isinstance(raw, list):
        return [_mended(one) for one in raw]
    if not isinstance(raw, dict):
        return raw
    names = _BOUNDS | (_LENGTHS if raw.get("type") == "array" else {})
    return {
        names.get(key, key): {name: _mended(one) for name, one in value.items()}
        if key in _NAMED
        else _mended(value)
        for key, value in raw.items()
        if key != "default" or not (value is None or isinstance(value, dict))
    }


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
            then = _mended(settings.model_json_schema(True, inner, _Generator))
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
