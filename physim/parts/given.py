"""What a part given from Python as an object was made with, as far as the object tells.

Known are the arguments of its constructor that it keeps under their names, the keys of its
``settings`` (or of whatever it keeps that is of its class ``Settings``), and class attributes of
which it has another value of its own. What is kept under no such name, or is no plain short value
(numbers, texts, and lists and tables of them), is named as not known. A change that leaves no such
trace, as of a private attribute, cannot be told.
"""

from __future__ import annotations

import inspect
import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

LONGEST = 300
"""Signs of a value as JSON; a longer one counts as not known."""
DECLARED = frozenset(("modes", "rules", "columns"))
"""Attributes that a record holds as such."""
UNKNOWN = object()


@dataclass(frozen=True)
class GivenSettings:
    """What of an object differs from its defaults."""

    settings: Mapping[str, Any]
    """plain values by name"""
    not_known: tuple[str, ...] = ()
    """names of what may differ and cannot be told"""

    def told(self, name: str) -> str:
        """The value of a setting, in words."""
        if name in self.not_known:
            return "not known"
        return str(self.settings[name]) if name in self.settings else "by default"


def given_settings(part: object) -> GivenSettings:
    """Settings of a part that differ from their defaults; nothing that its code does is raised."""
    known: dict[str, Any] = {}
    not_known: list[str] = []
    for name, value, default in _found(part):
        plain = _plain(value)
        if plain is UNKNOWN:
            if value is UNKNOWN or value is not default:
                not_known.append(name)
        elif not _same(plain, _plain(default)):
            known[name] = plain
    return GivenSettings(known, tuple(not_known))


def _found(part: object) -> Iterator[tuple[str, Any, Any]]:
    """Name, value and default of all that a part is known to be set by."""
    settings = _settings(part)
    own = list(_arguments(part))
    if settings is not None:
        yield from _arguments(settings)
        first = hasattr(type(part), "Settings")  # such a class is made as cls(settings)
        own = [one for one in own[first:] if one[0] != "settings"]
    yield from own
    seen = {name for name, *_ in own} | DECLARED
    for name, value in getattr(part, "__dict__", {}).items():
        default = getattr(type(part), name, UNKNOWN)
        public = not name.startswith("_") and name not in seen and value is not settings
        if public and _plain(default) is not UNKNOWN:
            yield name, value, default


def _settings(part: object) -> Any | None:
    """The object with a part's settings, a model or a dataclass; None where it keeps none."""
    from pydantic import BaseModel

    kept = _kept(part, "settings")
    if isinstance(kept, BaseModel) or (is_dataclass(kept) and not isinstance(kept, type)):
        return kept
    model = getattr(type(part), "Settings", None)
    if not isinstance(model, type):
        return None
    values = getattr(part, "__dict__", {}).values()
    return next((value for value in values if isinstance(value, model)), None)


def _arguments(made: object) -> Iterator[tuple[str, Any, Any]]:
    """Name, value kept and default of each argument of the constructor that made an object."""
    try:
        arguments = inspect.signature(type(made)).parameters.values()
    except (TypeError, ValueError):  # not written in Python
        return
    for one in arguments:
        open_ended = one.kind in (one.VAR_POSITIONAL, one.VAR_KEYWORD)
        value = UNKNOWN if open_ended else _kept(made, one.name)
        default = UNKNOWN if one.default is one.empty else one.default
        yield one.name, value, _from_factory(type(made), one.name, default)


def _from_factory(owner: type, name: str, default: Any) -> Any:
    """Default of a field; made anew where a model or a dataclass says how."""
    for fields in ("model_fields", "__dataclass_fields__"):
        field = getattr(owner, fields, {}).get(name)
        factory = getattr(field, "default_factory", None)
        if callable(factory):
            try:
                return factory()
            except Exception:
                return UNKNOWN
    return default


def _kept(part: object, name: str) -> Any:
    try:
        return getattr(part, name, UNKNOWN)
    except KeyboardInterrupt:
        raise
    except BaseException:  # a property of the user's
        return UNKNOWN


def _plain(value: Any) -> Any:
    """A value as JSON has it; UNKNOWN for one that it does not have, or that is long."""
    try:
        plain = json.loads(json.dumps(value, default=_simpler, allow_nan=True))
        text = json.dumps(plain)
    except (TypeError, ValueError, RecursionError):
        return UNKNOWN
    return plain if len(text) <= LONGEST else UNKNOWN


def _same(one: Any, other: Any) -> bool:
    """Whether two plain values are equal; what is not a number equals itself."""
    if one is UNKNOWN or other is UNKNOWN:
        return False
    return bool(one == other) or json.dumps(one) == json.dumps(other)


def _simpler(value: Any) -> Any:
    """One step towards JSON. Raises TypeError for what has no plain form."""
    from pydantic import BaseModel

    if isinstance(value, BaseModel):
        return value.model_dump()
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.ndarray | np.generic) and value.size <= LONGEST:
        return value.tolist()
    raise TypeError
