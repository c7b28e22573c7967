"""What a part given from Python as an object was made with, as far as the object tells.

Known is what of its ``settings``, a pydantic model or a dataclass, differs from the defaults, and
what it keeps under public names. What is no plain short value (numbers, texts, and lists and
tables of them), and arguments of its constructor that it keeps under no such name, are named as not
known.
"""

from __future__ import annotations

import inspect
import json
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np
from pydantic import BaseModel

LONGEST = 300
"""Signs of a value as JSON; a longer one counts as not known."""
APART = frozenset(("settings", "modes", "rules", "columns"))
"""Attributes that are looked at as such, or that a record holds as such."""
UNKNOWN = object()


@dataclass(frozen=True)
class GivenSettings:
    """What an object tells of itself."""

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
    """Settings of a part, those of a model or dataclass that differ from their defaults."""
    given = getattr(part, "settings", None)
    values: dict[str, Any] = {}
    if isinstance(given, BaseModel):
        values = {name: getattr(given, name) for name in given.model_dump(exclude_defaults=True)}
    elif is_dataclass(given) and not isinstance(given, type):
        values = {field.name: getattr(given, field.name) for field in fields(given)}
    elif hasattr(type(part), "Settings"):  # kept under another name
        values = {"settings": UNKNOWN}
    for name, value in getattr(part, "__dict__", {}).items():
        if not name.startswith("_") and name not in APART:
            values[name] = value
    if not hasattr(type(part), "Settings") and type(part).__init__ is not object.__init__:
        for name in inspect.signature(type(part)).parameters:
            if name not in APART:
                values.setdefault(name, UNKNOWN)
    plain = {name: _plain(value) for name, value in values.items()}
    known = {name: value for name, value in plain.items() if value is not UNKNOWN}
    return GivenSettings(known, tuple(name for name in plain if name not in known))


def _plain(value: Any) -> Any:
    """A value as JSON has it; UNKNOWN for one that it does not have, or that is long."""
    try:
        text = json.dumps(value, default=_simpler)
    except (TypeError, ValueError, RecursionError):
        return UNKNOWN
    return json.loads(text) if len(text) <= LONGEST else UNKNOWN


def _simpler(value: Any) -> Any:
    """One step towards JSON. Raises TypeError for what has no plain form."""
    if isinstance(value, BaseModel):
        return value.model_dump()
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: getattr(value, field.name) for field in fields(value)}
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.ndarray | np.generic) and value.size <= LONGEST:
        return value.tolist()
    raise TypeError
