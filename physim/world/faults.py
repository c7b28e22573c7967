"""pydantic's errors in our own words: what was given, what is allowed, what may be meant."""

from __future__ import annotations

import re
import types
from collections.abc import Mapping
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic.fields import FieldInfo

from physim.errors import Fault, Location, nearest
from physim.escaping import escaped

LONGEST_VALUE = 40
"""Characters of a given value that a message repeats."""
MOST_TRANSLATED = 500
"""Mistakes of one world that are put into words."""

_NEEDED = {
    **dict.fromkeys(("float_type", "float_parsing"), "must be a number"),
    **dict.fromkeys(("int_type", "int_from_float", "int_parsing"), "must be a whole number"),
    "int_parsing_size": "must be a whole number of reasonable size",
    "finite_number": "must be a finite number",
    **dict.fromkeys(("bool_type", "bool_parsing"), "must be true or false"),
    "string_type": "must be a text",
    "string_unicode": "must be valid Unicode text",
    **dict.fromkeys(("sequence", "list_type", "tuple_type"), "must be a list"),
    **dict.fromkeys(
        ("dict_type", "mapping_type", "model_type", "model_attributes_type"),
        "must be a mapping of keys to values",
    ),
    "string_too_short": "must not be empty",
}
_BOUNDS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}


def field_at(model: type[BaseModel], location: Location) -> FieldInfo | None:
    """Return the field of that name at ``location``, with its description, or None.

    A location as pydantic gives it may hold tags (``<list>``) that choose among alternatives.
    """
    if not location or not isinstance(location[-1], str):
        return None
    return _fields(model, location[:-1]).get(location[-1])


def _fields(annotation: Any, location: Location) -> dict[str, FieldInfo]:
    """Fields of the model that stands at a location, those of all where there are alternatives."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        tags = [note.tag for note in inner[1:] if isinstance(note, Tag)]
        if tags and location and _is_tag(location[0]):
            return _fields(inner[0], location[1:]) if location[0] in tags else {}
        return _fields(inner[0], location)
    if origin is Union or origin is types.UnionType:
        found = [_fields(one, location) for one in inner]
    elif origin is tuple and location and isinstance(location[0], int):
        found = [_fields(one, location[1:]) for one in inner]
    elif isinstance(annotation, type) and issubclass(annotation, BaseModel):
        if not location:
            return dict(annotation.model_fields)
        field = annotation.model_fields.get(str(location[0]))
        found = [] if field is None else [_fields(field.annotation, location[1:])]
    else:
        found = []
    return {key: field for fields in reversed(found) for key, field in fields.items()}


def _is_tag(part: str | int) -> bool:
    """Whether a part of a location chooses among alternatives of a value; no author wrote it."""
    return isinstance(part, str) and part[:1] == "<" and part[-1:] == ">"


def describe(value: Any) -> str:
    """Write a given value briefly on one line, as a message shows it."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "an empty list" if not value else f"a list of {len(value)}"
    if isinstance(value, str):
        text = escaped(value[: LONGEST_VALUE + 1])
        return '"' + (text if len(text) <= LONGEST_VALUE else text[:LONGEST_VALUE] + "…") + '"'
    if isinstance(value, int) and abs(value) >= 10**LONGEST_VALUE:
        return "an integer of more than 40 digits"
    if isinstance(value, int | float):
        return repr(value)
    return f"a Python {type(value).__name__}"


def faults_of(error: ValidationError, model: type[BaseModel]) -> list[Fault]:
    """One fault per mistake of ``error``, which arose when making a ``model``.

    A missing key that is evidently a misspelt one is reported once, as the misspelt key.
    """
    faults: list[Fault] = []
    corrected: set[Location] = set()
    missing: list[Fault] = []
    for details in error.errors(include_url=False)[:MOST_TRANSLATED]:
        raw: Location = details["loc"]
        location = _plain(raw)
        if details["type"] == "extra_forbidden":
            fault, not_missed = _of_key(model, raw)
            faults.append(fault)
            corrected |= {(*location[:-1], key) for key in not_missed}
        elif details["type"] == "missing" and not isinstance(location[-1], int):
            field = field_at(model, raw)
            needed = field.description if field is not None else None
            what = f"needed: {needed}" if needed else "it has no default"
            missing.append(Fault(location, f"missing; {what}"))
        elif details["type"] != "too_short" or _is_short(details["input"], details["ctx"]):
            faults.append(Fault(location, _message(model, raw, dict(details))))
    return faults + [fault for fault in missing if fault.location not in corrected]


def _is_short(given: Any, context: Mapping[str, Any]) -> bool:
    """Whether a list is too short as it was given, not only without the entries refused in it."""
    return not isinstance(given, list | tuple) or len(given) < context["min_length"]


def _plain(location: Location) -> Location:
    """Location as the author sees it: without the tags that distinguish alternatives."""
    return tuple(part for part in location if not _is_tag(part))


def _of_key(model: type[BaseModel], raw: Location) -> tuple[Fault, list[str]]:
    """Fault of a key that its model does not have, and the keys that are not missed beside it."""
    holder, given = raw[:-1], str(raw[-1])
    allowed, location = list(_fields(model, holder)), _plain(raw)
    is_choice = bool(holder) and _is_tag(holder[-1])
    every = list(_fields(model, holder[:-1])) if is_choice else allowed
    if inner := [k for k in allowed if field_at(model, (*holder, k, given)) is not None]:
        meant = " or ".join(f'"{key}.{given}"' for key in inner)
        return unknown_key(location, allowed, f"; did you mean {meant}?"), []
    if nearest(given.lower(), allowed):
        near = [key for key in allowed if nearest(given.lower(), [key])]
        return unknown_key(location, allowed), near
    advice = nearest(given.lower(), every)  # a key of another kind of entry
    if is_choice and not advice and (field := field_at(model, holder[:-1])):
        advice = f"; needed: {field.description}"
    return unknown_key(location, allowed, advice), allowed if advice else []


def unknown_key(location: Location, allowed: list[str], advice: str = "") -> Fault:
    """Fault of a key that does not exist: the allowed ones, and advice or the nearest of them."""
    choices = f"; allowed: {', '.join(allowed)}" if allowed else ""
    advice = advice or nearest(str(location[-1]).lower(), allowed)
    return Fault(location, f"unknown key{choices}{advice}", of_key=True)


def _message(model: type[BaseModel], location: Location, details: Mapping[str, Any]) -> str:
    """Say in one line what is wrong with a value, what is allowed, and what may be meant."""
    given, context, kind = details.get("input"), details.get("ctx", {}), str(details["type"])
    of_value = field_at(model, location[:-1]) if location else None
    needed = (of_value.description or "") if of_value is not None else ""
    choice = f"needs {needed}" if needed and _is_tag(location[-1]) else ""
    if kind == "missing":
        return "missing; one more number is needed here" + (f": {needed}" if needed else "")
    if kind in _NEEDED:
        said, hint = choice or _NEEDED[kind], ""
        if kind == "string_type" and isinstance(given, int | float):
            hint = "; put it in quotes to make it a text"
        elif _NEEDED[kind].endswith("number") and isinstance(given, str):
            hint = _as_number(given, _unit(model, location))
        return f"{said}; given {describe(given)}{hint}"
    if kind == "literal_error":
        words = re.findall(r"'([^']*)'", context["expected"])
        hint = nearest(str(given)[:100].lower(), words) or _as_number(
            str(given), _unit(model, location)
        )
        if not choice and _is_tag(location[-1]):
            choice = f"must be a number or the word {' or '.join(words)}"
        choice = choice or f"must be {context['expected'].replace(chr(39), '')}"
        return f"{choice}; given {describe(given)}{hint}"
    if kind in _BOUNDS:
        sign, key = _BOUNDS[kind]
        least = f"{context[key]:.15g}{_unit(model, location)}"
        return f"must be {sign} {least}; given {describe(given)}"
    if kind == "value_error":  # of a validator of the user's, in its own words
        return str(context.get("error", details["msg"]))
    if kind == "too_short":
        entries = "entry" if context["min_length"] == 1 else "entries"
        least = f"{context['min_length']} {entries}"
        return f"must have at least {least}; given {context['actual_length']}"
    if kind == "too_long":
        most = f"{context['max_length']} entries"
        return f"must have at most {most}; given {context['actual_length'] or 'more'}"
    if kind == "string_too_long":
        return f"must have at most {context['max_length']} characters; given {len(str(given))}"
    return f"{details['msg']}; given {describe(given)}"


def _unit(model: type[BaseModel], location: Location) -> str:
    """`` [m]``: unit of the key that a value stands in, as its description begins."""
    while location and (isinstance(location[-1], int) or _is_tag(location[-1])):
        location = location[:-1]
    field = field_at(model, location)
    found = re.match(r"\[[^],]+\]", (field.description or "") if field is not None else "")
    return f" {found[0]}" if found else ""


def _as_number(given: str, unit: str) -> str:
    """How a number is written, where a text begins like one."""
    looks_so = re.match(r"\s*\W?[.,]?\d", given)
    return f"; write a bare number{unit}, as 1.5 without quotes" if looks_so else ""


def in_metres(length: float) -> str:
    """What to write where a length is likely none in metres."""
    return (
        f"lengths are in metres: if centimetres are meant, write {length / 100.0:.6g}, if "
        f"millimetres, {length / 1000.0:.6g}"
    )
