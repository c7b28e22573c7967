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
    settings, kind = getattr(part, "settings", None), type(part)
    values: dict[str, Any] = {}
    if isinstance(settings, BaseModel):
        values = settings.model_dump(exclude_defaults=True)
    elif is_dataclass(settings) and not isinstance(settings, type):
        values = _simpler(settings)
    elif hasattr(kind, "Settings"):  # kept under another name
        values = {"settings": object()}
    kept = getattr(part, "__dict__", {}).items()
    values |= {name: one for name, one in kept if name[0] != "_" and name not in APART}
    if not hasattr(kind, "Settings") and kind.__init__ is not object.__init__:
        for name in inspect.signature(kind).parameters:
            if name not in APART:
                values.setdefault(name, object())
    known: dict[str, Any] = {}
    for name, value in values.items():
        try:
            text = json.dumps(value, default=_simpler)
        except (TypeError, ValueError, RecursionError):
            continue
        if len(text) <= LONGEST:
            known[name] = json.loads(text)
    return GivenSettings(known, tuple(name for name in values if name not in known))


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
