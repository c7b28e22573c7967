"""JSON Schema of a world file, made from the models, for completion and hover text in editors.

It is of draft 7, which YAML editors understand, and holds no references: the text that an editor
shows for a key is that of the key, with its unit and default. It checks keys, kinds and bounds;
what lies between several values (either corridor or boundaries, leads as many as robots) and all
geometry is left to reading.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from typing import Any

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

_KEPT = (
    "type", "const", "enum", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum",
    "minLength", "maxLength", "minItems", "maxItems", "required", "additionalProperties",
)  # fmt: skip
_RENAMED = {
    "ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum",
}  # fmt: skip


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
    raw = World.model_json_schema()
    schema = _plain(raw, raw["$defs"])
    for kind in (CONTROLLER, *STAGES):
        holder = schema
        for key in kind.key[:-1]:
            holder = holder["properties"][key]
        keys, last = holder["properties"], kind.key[-1]
        if kind is CONTROLLER:
            keys[last] = _choice(keys[last], kind, names, ControllerChoice)
        else:
            keys[last]["items"] = _choice(keys[last]["items"], kind, names, Choice)
    head = {"$schema": "http://json-schema.org/draft-07/schema#", "title": "physim world"}
    return {**head, **schema}


def _plain(raw: Schema, models: Schema) -> Schema:
    """Schema without references, null and titles, tuples as draft 7 writes them."""
    if "$ref" in raw:
        rest = {key: value for key, value in raw.items() if key != "$ref"}
        return _plain({**models[raw["$ref"].rpartition("/")[2]], **rest}, models)
    given = raw.get("anyOf") or raw.get("oneOf") or []
    options = [option for option in given if option.get("type") != "null"]
    if len(options) == 1:
        rest = {key: value for key, value in raw.items() if key not in ("anyOf", "oneOf")}
        return _plain({**options[0], **rest}, models)
    text = _described(raw)
    schema: Schema = {"description": text} if text else {}
    schema |= {key: raw[key] for key in _KEPT if key in raw}
    schema |= {key: raw[bound] for bound, key in _RENAMED.items() if bound in raw}
    if options:
        schema["oneOf"] = [_plain(option, models) for option in options]
    if "properties" in raw:
        schema["properties"] = {k: _plain(v, models) for k, v in raw["properties"].items()}
    if raw.get("type") == "array":
        _array(schema, raw, models)
    return schema


def _array(schema: Schema, raw: Schema, models: Schema) -> None:
    if "prefixItems" in raw:
        schema["items"] = [_plain(item, models) for item in raw["prefixItems"]]
        schema["additionalItems"] = False
    elif "items" in raw:
        schema["items"] = _plain(raw["items"], models)
    for length, items in (("minLength", "minItems"), ("maxLength", "maxItems")):
        if length in schema:
            schema[items] = schema.pop(length)


def _described(raw: Schema) -> str:
    """Meaning, unit and default of a key, as an editor shows it."""
    text = str(raw.get("description", ""))
    default = raw.get("default")
    if default in (None, "", [], ()) or isinstance(default, dict):
        return text
    usual = default if isinstance(default, str) else json.dumps(default)
    return f"{text}. Default: {usual}"


def _choice(
    plain: Schema, kind: Kind, names: Callable[[Kind], Iterable[str]], model: type[Choice]
) -> Schema:
    """Schema of a part that is named by its type, on which its keys depend."""
    field = model.model_fields["type"]
    listed = list(names(kind))
    rules = []
    for name in listed:
        chosen: Schema = {"properties": {"type": {"const": name}}}
        if name != field.default:
            chosen["required"] = ["type"]  # without a type the condition would hold, too
        keys = _settings(kind, name)
        if keys is not None:
            then = {"properties": {"type": True, **keys}, "additionalProperties": False}
            rules.append({"if": chosen, "then": then})
    described = plain.get("description") or f"one {kind.word}"
    schema: Schema = {
        "description": f"{described}; its keys are those of its type",
        "type": "object",
        "properties": {"type": {**plain["properties"]["type"], "enum": listed}},
    }
    if field.is_required():
        schema["required"] = ["type"]
    return {**schema, "allOf": rules} if rules else schema


def _settings(kind: Kind, name: str) -> Schema | None:
    """Keys of a part's settings; None where they cannot be found out."""
    from physim.errors import ControllerError

    try:
        model = settings_model(find_part(kind, name))
    except ControllerError:
        return None
    if model is None:
        return {}
    raw = model.model_json_schema()
    keys: Schema = _plain(raw, raw.get("$defs", {})).get("properties", {})
    return keys
