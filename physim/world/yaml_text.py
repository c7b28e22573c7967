"""Write a world as YAML text: every key, units as comments, numbers that read back equal."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from physim.errors import PhysimError
from physim.world.kinds import thawed
from physim.world.model import World
from physim.world.run import Choice

LINE = 100
"""Columns after which a list is broken."""

ABSENT = ("description", "obstacles", "movers", "sensing", "filters", "disturbances", "stages")
"""Keys that are left out where they are empty."""

FLOWING = ("footprints", "paths", "obstacles")
"""Lists of shapes, written in brackets."""

_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(?:[ -][A-Za-z0-9_]+)*")
_NOT_PLAIN = {"y", "n", "yes", "no", "on", "off", "true", "false", "null", "nan", "inf"}


def yaml_text(world: World) -> str:
    """Text of the world file of ``world``: ends in a newline, ASCII but for printable text."""
    return "\n".join(_block(world, 0)) + "\n"


def _block(model: BaseModel, indent: int) -> Iterator[str]:
    """Lines of a model as a block mapping."""
    space = " " * indent
    for key, unit in _keys(type(model)):
        value = getattr(model, key)
        if value is None or (key in ABSENT and not value):
            continue
        if isinstance(value, Choice):
            yield f"{space}{key}:"
            yield from _choice(value, indent + 2)
        elif isinstance(value, BaseModel):
            lines = list(_block(value, indent + 2))
            if lines or key not in ABSENT:
                yield from [f"{space}{key}:", *lines] if lines else [f"{space}{key}: {{}}"]
        elif (
            key not in FLOWING
            and isinstance(value, tuple)
            and isinstance(next(iter(value), None), BaseModel)
        ):
            yield f"{space}{key}:"
            for item in value:
                write = _choice if isinstance(item, Choice) else _block
                first, *others = write(item, indent + 4)
                yield f"{space}  - {first.strip()}"
                yield from others
        else:
            yield from _entry(f"{space}{key}", value, unit)


def _choice(choice: Choice, indent: int) -> Iterator[str]:
    """Lines of a part by name: type and settings in one mapping.

    Settings beside no type are those of whatever runs, and stay so.
    """
    is_named = "type" in choice.model_fields_set or not choice.settings
    named = {"type": choice.type} if is_named else {}
    for name, setting in (named | thawed(choice.settings)).items():
        yield from _entry(f"{' ' * indent}{_scalar_text(name)}", setting, "")


@functools.cache
def _keys(kind: type[BaseModel]) -> tuple[tuple[str, str], ...]:
    """Keys of a model and the comments with their units, looked up once a model."""
    fields = kind.model_fields.items()
    return tuple((key, _unit(field.description or "")) for key, field in fields)


def _unit(description: str) -> str:
    found = re.match(r"\[[^\]]+\]", description)
    return f"  # {found[0]}" if found else ""


def _entry(head: str, value: Any, unit: str) -> Iterator[str]:
    """``key: value  # [unit]``, long lists broken over several lines."""
    if isinstance(value, list | tuple):
        yield from _flow_list(f"{head}: ", [_flow(item) for item in value], unit)
    else:
        yield f"{head}: {_flow(value)}{unit}"


def _flow_list(head: str, pieces: Sequence[str], comment: str) -> Iterator[str]:
    """Lines of ``head[piece, piece]comment``, the list broken beyond `LINE` columns."""
    whole = f"{head}[{', '.join(pieces)}]{comment}"
    if len(whole) <= LINE:
        yield whole
        return
    yield f"{head}[{comment}"
    space = " " * (len(head) - len(head.lstrip()))
    line = f"{space} "
    for piece in pieces:
        if line.strip() and len(line) + len(piece) + 2 > LINE:
            yield line
            line = f"{space} "
        line += f" {piece},"
    yield line
    yield f"{space}]"


def _flow(value: Any) -> str:
    """Write a value on one line, as YAML's flow style."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return _float(value)
    if isinstance(value, int):
        return int.__repr__(value)
    if isinstance(value, str):
        return _scalar_text(value)
    if isinstance(value, BaseModel):
        return _flow({key: getattr(value, key) for key, _ in _keys(type(value))})
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_scalar_text(k)}: {_flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_flow(item) for item in value) + "]"
    raise PhysimError(f"a value of type {type(value).__name__} cannot stand in a world file")


def _float(value: float) -> str:
    """Shortest text that reads back equal, with the dot that YAML 1.1 wants (repr has the sign)."""
    text = float.__repr__(value)
    mantissa, e, exponent = text.partition("e")
    if not e:
        return text
    dot = "" if "." in mantissa else ".0"
    return f"{mantissa}{dot}e{exponent}"


def _scalar_text(text: str) -> str:
    """Plain where no reader could take it for something else, else in double quotes."""
    if _PLAIN.fullmatch(text) and text.lower() not in _NOT_PLAIN:
        return text
    return '"' + "".join(_escaped(character) for character in text) + '"'


def _escaped(character: str) -> str:
    if character in '"\\':
        return "\\" + character
    if character.isprintable():
        return character
    code = ord(character)
    if code <= 0xFF:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"
