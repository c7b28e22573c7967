"""pydantic's errors in our own words: what was given, what is allowed, what may be meant.

The model or field that stands at a location is found by following the annotations.
"""

from __future__ import annotations

import re
import types
import unicodedata
from collections.abc import Callable, Mapping
from math import pi
from types import MappingProxyType
from typing import Annotated, Any, Union, cast, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic.fields import FieldInfo

from physim.errors import Fault, Location, nearest
from physim.escaping import escaped


def model_at(model: type[BaseModel], location: Location) -> type[BaseModel] | None:
    """Return the model whose keys may stand at ``location``, or None.

    A location as pydantic gives it may hold tags (``<list>``) that choose among alternatives.
    """
    found = _walk(model, location)
    for option in _options(found):
        if isinstance(option, type) and issubclass(option, BaseModel):
            return option
    return None


def field_at(model: type[BaseModel], location: Location) -> FieldInfo | None:
    """Return the field of that name at ``location``, with its description, or None."""
    if not location or not isinstance(location[-1], str):
        return None
    fields = (getattr(one, "model_fields", {}) for one in _options(_walk(model, location[:-1])))
    return next((found[location[-1]] for found in fields if location[-1] in found), None)


def _is_tag(part: str | int) -> bool:
    """Whether a part of a location chooses among alternatives of a value; no author wrote it."""
    return isinstance(part, str) and part[:1] == "<" and part[-1:] == ">"


def _walk(model: type[BaseModel], location: Location) -> Any:
    here: Any = model
    for part in location:
        here = _step(here, part)
    return here


def _step(here: Any, part: str | int) -> Any:
    """Annotation one key, index or tag further in; None when there is nothing."""
    if _is_tag(part):
        return next(iter(_options(here, tag=part)), None)
    for option in _options(here):
        if isinstance(option, type) and issubclass(option, BaseModel):
            field = option.model_fields.get(str(part))
            if field is not None:
                return field.annotation
        if get_origin(option) is tuple and isinstance(part, int):
            items = get_args(option)
            if len(items) == 2 and items[1] is Ellipsis:
                return items[0]
            return items[part] if part < len(items) else None
    return None


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


LONGEST_VALUE = 40
"""Characters of a given value that a message repeats."""

MOST_TRANSLATED = 500
"""Mistakes of one world that are put into words."""

SETTINGS: tuple[Location, ...] = (
    ("controller",), ("sensing", "stages"), ("filters",), ("disturbances",)
)  # fmt: skip
"""Where parts are named by type and settings, which stand in one mapping in a file."""

LISTS = ("sequence", "list_type", "tuple_type")
LOOKS_NUMERIC = re.compile(r"[-+]?[0-9.][0-9._eE+-]*")


WITH_UNIT = re.compile(r"\s*([+-]?\d+(?:\.\d*)?)\s*([a-z°/]+)\s*", re.IGNORECASE)
"""Number and unit in one text, as in "6 m"."""
DECIMAL_COMMA = re.compile(r"\s*([+-]?\d+),(\d+)\s*")
"""Number as written in many languages, as in "6,5"."""
NUMBER = re.compile(r"[+-]?\d+(?:\.\d*)?(?:e[+-]?\d+)?", re.IGNORECASE)
MINUSES = dict.fromkeys(map(ord, "\N{MINUS SIGN}\N{EN DASH}\N{HYPHEN}\N{NON-BREAKING HYPHEN}"), "-")
"""Signs that look like a minus, as programs for texts and files of print have them"""
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
        return '"' + _short(_one_line(value)) + '"'
    if isinstance(value, int) and abs(value) >= 10**LONGEST_VALUE:
        return "an integer of more than 40 digits"
    if isinstance(value, int | float):
        return repr(value)
    return f"a Python {type(value).__name__}"


def _one_line(text: str) -> str:
    return escaped(text[: LONGEST_VALUE + 1])


def _short(text: str) -> str:
    return text if len(text) <= LONGEST_VALUE else text[:LONGEST_VALUE] + "…"


def faults_of(error: ValidationError, model: type[BaseModel]) -> list[Fault]:
    """One fault per mistake of ``error``, which arose when making a ``model``.

    A missing key that is evidently a misspelt one is reported once, as the misspelt key.
    """
    faults: list[Fault] = []
    corrected: set[Location] = set()
    missing: list[Fault] = []
    for details in error.errors(include_url=False)[:MOST_TRANSLATED]:
        raw: Location = details["loc"]
        location = plain_location(raw)
        if details["type"] == "extra_forbidden":
            holder = model_at(model, raw[:-1])
            allowed, advice = keys_of(holder), _advice(holder, location[-1])
            faults.append(unknown_key(location, allowed, advice))
            corrected |= {
                (*location[:-1], key) for key in allowed if advice or _meant(location[-1], key)
            }
        elif details["type"] == "missing" and not isinstance(location[-1], int):
            missing.append(Fault(location, _missing(model, raw)))
        else:
            choice = _choice(model, raw)
            what = message(cast(Mapping[str, Any], details), choice)
            faults.append(Fault(location, what + _other_units(model, raw, details)))
    return faults + [fault for fault in missing if fault.location not in corrected]


def plain_location(location: Location) -> Location:
    """Location as the author sees it: without the tags that distinguish alternatives."""
    parts = tuple(part for part in location if not _is_tag(part))
    for place in SETTINGS:
        if parts[: len(place)] == place:
            end = len(place) + (place != ("controller",))  # of a list one entry
            return parts[:end] + parts[end:][parts[end : end + 1] == ("settings",) :]
    return parts


def unknown_key(location: Location, allowed: list[str], advice: str = "") -> Fault:
    """Fault of a key that does not exist: the allowed ones, and the nearest of them or advice."""
    given = str(location[-1])
    choices = f"; allowed: {', '.join(allowed)}" if allowed else ""
    more = f"; {advice}" if advice else nearest(given.lower(), allowed)
    return Fault(location, f"unknown key{choices}{more}", of_key=True)


def _advice(model: type[BaseModel] | None, key: str | int) -> str:
    """What a model's ``advice`` says to who gives it a key that it does not have."""
    known: Mapping[str, str] = getattr(model, "advice", {})
    return known.get(str(key).lower(), "")


def keys_of(model: type[BaseModel] | None) -> list[str]:
    """Keys that a model takes."""
    return list(model.model_fields) if model is not None else []


def _meant(given: str | int, key: str) -> bool:
    return nearest(str(given).lower(), [key]) != ""


def _missing(model: type[BaseModel], location: Location) -> str:
    field = field_at(model, location)
    needed = None if field is None else field.description
    return f"missing; needed: {needed}" if needed else "missing; it has no default"


def _other_units(model: type[BaseModel], location: Location, details: Mapping[str, Any]) -> str:
    """What to write for a number with a unit or a comma, and for a length too large for metres."""
    is_coordinate = bool(location) and isinstance(location[-1], int)
    while location and (isinstance(location[-1], int) or _is_tag(location[-1])):
        location = location[:-1]
    field = field_at(model, location)
    unit, _, meaning = ((field.description if field is not None else "") or "").partition(" ")
    given, kind = details.get("input"), details["type"]
    if kind == "less_than_equal":
        if unit == "[-]":
            return f" ({meaning})"
        if unit != "[m]" or given is None:
            return ""
        origin = ", or subtract an origin from all points of a map" if is_coordinate else ""
        return f"; {in_metres(given)}{origin}"
    return _of_text(given, unit) if isinstance(given, str) and kind not in LISTS else ""


def _of_text(given: str, unit: str) -> str:
    """What to write for a text that is a number with a unit or a comma; ``unit`` is the key's."""
    plain = unicodedata.normalize("NFKC", given).translate(MINUSES)
    if plain != given and NUMBER.fullmatch(plain):
        return f"; write it with the signs of a keyboard: {plain}"
    if comma := DECIMAL_COMMA.fullmatch(given):
        return f"; decimals take a point: {comma[1]}.{comma[2]}"
    found = WITH_UNIT.fullmatch(given)
    if found is None:
        return ""
    scale = SCALES.get(unit, {}).get(found[2].lower())
    if scale is None:
        return "; units are not written, each key has its own"
    return f"; units are not written: {float(found[1]) * scale:.6g} is meant"


def in_metres(length: float) -> str:
    """What to write where a length is likely none in metres."""
    return (
        f"lengths are in metres: if centimetres are meant, write {length / 100.0:.6g}, if "
        f"millimetres, {length / 1000.0:.6g}"
    )


def _choice(model: type[BaseModel], location: Location) -> str:
    """What a value of several kinds may be, where none of them was given."""
    if not location or not _is_tag(location[-1]):
        return ""
    field = field_at(model, location[:-1])
    return f"must be: {field.description}" if field is not None else ""


def message(details: Mapping[str, Any], needed: str = "") -> str:
    """Say in one line what is wrong with a value and what is allowed (``needed``, if known)."""
    given = details.get("input")
    context = details.get("ctx", {})
    kind = str(details["type"])
    if kind in _NEEDED:
        return f"{needed or _NEEDED[kind]}; given {describe(given)}{_hint(kind, given)}"
    if kind == "literal_error":
        words = re.findall(r"'([^']*)'", context["expected"])
        near = nearest(str(given)[:100].lower(), words)
        return f"{needed or _words(words, details)}; given {describe(given)}{near}"
    if kind in _BOUNDS:
        sign, key = _BOUNDS[kind]
        return f"must be {sign} {context[key]:.15g}; given {describe(given)}"
    if kind == "value_error":  # a rule between values, in the words of the model
        return str(context.get("error", details["msg"]))
    if kind in _SPECIAL:
        return _SPECIAL[kind](context, given)
    return f"{details['msg']}; given {describe(given)}"


def _words(words: list[str], details: Mapping[str, Any]) -> str:
    """What may be given where one of some words may; beside a number if there are tags."""
    if details["loc"] and _is_tag(details["loc"][-1]):
        return f"must be a number or the word {' or '.join(words)}"
    return f"must be {details['ctx']['expected'].replace(chr(39), '')}"


def _hint(kind: str, given: Any) -> str:
    if kind == "string_type" and isinstance(given, int | float):
        return "; put it in quotes to make it a text"
    if kind in LISTS and isinstance(given, str) and "," in given:
        return f"; write [{_short(_one_line(given))}]"
    if isinstance(given, str) and kind in ("float_type", "int_type"):
        if LOOKS_NUMERIC.fullmatch(given):
            quoted = ", which is a text; write the number without quotes"
            return quoted if _is_number(given) else ", which is no number; correct it"
        if given.strip().lower().lstrip("+-.") in ("nan", "inf", "infinity"):
            return "; it must be finite"
    return ""


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


_NEEDED = {
    "float_type": "must be a number",
    "float_parsing": "must be a number",
    **dict.fromkeys(("int_type", "int_from_float", "int_parsing"), "must be a whole number"),
    "int_parsing_size": "must be a whole number of reasonable size",
    "finite_number": "must be a finite number",
    "bool_type": "must be true or false",
    "bool_parsing": "must be true or false",
    "string_type": "must be a text",
    "string_unicode": "must be valid Unicode text",
    **dict.fromkeys(LISTS, "must be a list"),
    "dict_type": "must be a mapping of keys to values",
    "mapping_type": "must be a mapping of keys to values",
    "model_type": "must be a mapping of keys to values",
    "model_attributes_type": "must be a mapping of keys to values",
    "string_too_short": "must not be empty",
}

_BOUNDS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}

_SPECIAL: dict[str, Callable[[Mapping[str, Any], Any], str]] = {
    "missing": lambda context, given: "missing; one more number is needed here",
    "too_short": lambda context, given: (
        f"must have at least {context['min_length']} "
        f"{'entry' if context['min_length'] == 1 else 'entries'}; given {context['actual_length']}"
    ),
    "too_long": lambda context, given: (
        f"must have at most {context['max_length']} entries; given "
        f"{context['actual_length'] or 'more'}"
    ),
    "string_too_long": lambda context, given: (
        f"must have at most {context['max_length']} characters; given {len(given)}"
    ),
}
