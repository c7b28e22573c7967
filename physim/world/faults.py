"""pydantic's errors in our own words: what was given, what is allowed, what may be meant.

The model or field that stands at a location is found by following the annotations.
"""

from __future__ import annotations

import re
import types
import unicodedata
from collections.abc import Mapping
from math import pi
from types import MappingProxyType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic.fields import FieldInfo

from physim.errors import Fault, Location, nearest
from physim.escaping import escaped

LONGEST_VALUE = 40
"""Characters of a given value that a message repeats."""
MOST_TRANSLATED = 500
"""Mistakes of one world that are put into words."""
SETTINGS: tuple[Location, ...] = (
    ("controller",), ("sensing", "stages"), ("filters",), ("disturbances",)
)  # fmt: skip
"""Where parts are named by type and settings, which stand in one mapping in a file."""
SCALES = MappingProxyType(
    {
        "[m]": {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0},
        "[s]": {"s": 1.0, "sec": 1.0, "ms": 0.001, "min": 60.0, "h": 3600.0},
        "[m/s]": {"m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001, "km/h": 1.0 / 3.6},
        "[rad]": {"rad": 1.0, "deg": pi / 180.0, "°": pi / 180.0},
        "[rad/s]": {"rad/s": 1.0, "deg/s": pi / 180.0, "°/s": pi / 180.0},
        "[kg]": {"kg": 1.0, "g": 0.001, "t": 1000.0},
    }
)
"""What a number with another unit is worth in that of a key, as its description begins."""
MINUSES = dict.fromkeys(map(ord, "\N{MINUS SIGN}\N{EN DASH}\N{HYPHEN}\N{NON-BREAKING HYPHEN}"), "-")
"""Signs that look like a minus, as programs for texts and files of print have them"""
_NUMBER = re.compile(r"([+-]?[0-9.,][0-9.,_]*(?:e[+-]?[0-9]+)?)\s*([a-z°/]*)", re.IGNORECASE)

_NEEDED = {
    "float_type": "must be a number",
    "float_parsing": "must be a number",
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
    fields = (one.model_fields for one in _models_at(model, location[:-1]))
    return next((found[location[-1]] for found in fields if location[-1] in found), None)


def _models_at(model: type[BaseModel], location: Location) -> list[type[BaseModel]]:
    """Models whose keys may stand at a location."""
    here: list[Any] = [model]
    for part in location:
        if _is_tag(part):
            here = [one for option in here for one in _options(option, part)]
        else:
            inner = [one for option in here for one in _inner(option, part)]
            here = inner[:1]
    options = [option for one in here for option in _options(one)]
    return [one for one in options if isinstance(one, type) and issubclass(one, BaseModel)]


def _is_tag(part: str | int) -> bool:
    """Whether a part of a location chooses among alternatives of a value; no author wrote it."""
    return isinstance(part, str) and part[:1] == "<" and part[-1:] == ">"


def _inner(annotation: Any, part: str | int) -> list[Any]:
    """Annotations one key or index further in."""
    found = []
    for option in _options(annotation):
        if isinstance(option, type) and issubclass(option, BaseModel):
            field = option.model_fields.get(str(part))
            found += [field.annotation] if field is not None else []
        elif get_origin(option) is tuple and isinstance(part, int):
            items = get_args(option)
            is_list = len(items) == 2 and items[1] is Ellipsis
            found += items[:1] if is_list else items[part : part + 1]
    return found


def _options(annotation: Any, tag: str | int | None = None) -> list[Any]:
    """Alternatives of an annotation without ``Annotated``; only those of ``tag`` if given."""
    origin = get_origin(annotation)
    if origin is Annotated:
        inner, *notes = get_args(annotation)
        tags = [note.tag for note in notes if isinstance(note, Tag)]
        if tag is not None and tags:
            return [inner] if tag in tags else []
        return _options(inner, tag)
    if origin is Union or origin is types.UnionType:
        return [found for member in get_args(annotation) for found in _options(member, tag)]
    return [annotation]


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
        else:
            faults.append(Fault(location, _message(model, raw, dict(details))))
    return faults + [fault for fault in missing if fault.location not in corrected]


def _plain(location: Location) -> Location:
    """Location as the author sees it: without the tags that distinguish alternatives."""
    parts = tuple(part for part in location if not _is_tag(part))
    for place in SETTINGS:
        if parts[: len(place)] == place:
            end = len(place) + (place != ("controller",))  # of a list one entry
            return parts[:end] + parts[end:][parts[end : end + 1] == ("settings",) :]
    return parts


def _of_key(model: type[BaseModel], raw: Location) -> tuple[Fault, list[str]]:
    """Fault of a key that its model does not have, and the keys that are not missed beside it."""
    holder, given = raw[:-1], str(raw[-1])
    here = _models_at(model, holder)[:1]
    others = _models_at(model, holder[:-1]) if holder and _is_tag(holder[-1]) else here
    allowed, every = ([key for one in some for key in one.model_fields] for some in (here, others))
    known: Mapping[str, str] = getattr(here[0], "advice", {}) if here else {}
    if advice := known.get(given.lower(), ""):
        return unknown_key(_plain(raw), allowed, f"; {advice}"), allowed
    if inner := [k for k in allowed if field_at(model, (*holder, k, given)) is not None]:
        meant = " or ".join(f'"{key}.{given}"' for key in inner)
        return unknown_key(_plain(raw), allowed, f"; did you mean {meant}?"), []
    near = nearest(given.lower(), allowed) or nearest(given.lower(), every)
    if near and not any(f'"{key}"' in near for key in allowed):  # of another kind of entry
        return unknown_key(_plain(raw), allowed, near), allowed
    return unknown_key(_plain(raw), allowed), [k for k in allowed if nearest(given.lower(), [k])]


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
    choice = f"must be: {needed}" if needed and _is_tag(location[-1]) else ""
    if kind == "missing":
        return "missing; one more number is needed here" + (f": {needed}" if needed else "")
    if kind in _NEEDED:
        hint = _hint(_unit(model, location), kind, given)
        return f"{choice or _NEEDED[kind]}; given {describe(given)}{hint}"
    if kind == "literal_error":
        words = re.findall(r"'([^']*)'", context["expected"])
        hint = nearest(str(given)[:100].lower(), words)
        if isinstance(given, str) and not hint:
            hint = _of_text(given, _unit(model, location))
        if not choice and _is_tag(location[-1]):
            choice = f"must be a number or the word {' or '.join(words)}"
        choice = choice or f"must be {context['expected'].replace(chr(39), '')}"
        return f"{choice}; given {describe(given)}{hint}"
    if kind in _BOUNDS:
        sign, key = _BOUNDS[kind]
        hint = ""
        if kind == "less_than_equal" and _unit(model, location) == "[m]":
            is_coordinate = isinstance(location[-1], int)
            origin = ", or subtract an origin from all points of a map" if is_coordinate else ""
            hint = f"; {in_metres(given)}{origin}" if isinstance(given, int | float) else ""
        return f"must be {sign} {context[key]:.15g}; given {describe(given)}{hint}"
    if kind == "value_error":  # a rule between values, in the words of the model
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
    """``[m]``: unit of the key that a value stands in, as its description begins."""
    while location and (isinstance(location[-1], int) or _is_tag(location[-1])):
        location = location[:-1]
    field = field_at(model, location)
    return ((field.description if field is not None else "") or "").partition(" ")[0]


def _hint(unit: str, kind: str, given: Any) -> str:
    if kind == "string_type" and isinstance(given, int | float):
        return "; put it in quotes to make it a text"
    if _NEEDED[kind] == "must be a list" and isinstance(given, str) and "," in given:
        return f"; write [{describe(given)[1:-1]}]"
    is_number = _NEEDED[kind].endswith("number")
    return _of_text(given, unit) if is_number and isinstance(given, str) else ""


def _of_text(given: str, unit: str) -> str:
    """What to write for a text that holds a number; ``unit`` is the key's."""
    text = unicodedata.normalize("NFKC", given).translate(MINUSES).strip()
    if text.lower().lstrip("+-.") in ("nan", "inf", "infinity"):
        return "; it must be finite"
    found = _NUMBER.fullmatch(text)
    if found is None:
        return ""
    try:
        value = float(found[1].replace(",", "."))
    except ValueError:
        return ", which is no number; correct it"
    scale = SCALES.get(unit, {}).get(found[2].lower()) if found[2] else 1.0
    if scale is None:
        return "; units are not written, each key has its own"
    what = "numbers stand without quotes, in the signs of a keyboard"
    if found[2] or "," in found[1]:
        what = "units are not written" if found[2] else "decimals take a point"
    return f"; {what}: write {value * scale:.15g}"


def in_metres(length: float) -> str:
    """What to write where a length is likely none in metres."""
    return (
        f"lengths are in metres: if centimetres are meant, write {length / 100.0:.6g}, if "
        f"millimetres, {length / 1000.0:.6g}"
    )
