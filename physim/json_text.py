"""JSON read and written.

Anybody may have written what is read: whatever is wrong with it is a ValueError in plain words.
"""

from __future__ import annotations

import json
import math
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

from pydantic_core import from_json

MOST_BYTES = 20_000_000
"""Bytes of a file that is read"""


def parse_json(text: str | bytes) -> Any:
    """Value of a JSON text. Raises ValueError."""
    try:
        return from_json(text)
    except ValueError as error:
        told = str(error).replace("recursion limit exceeded", "nested too deep")
        raise ValueError(f"no JSON that can be read: {told}") from None


def file_json(path: Path) -> Any:
    """Value of a file. Raises ValueError, also for one that is too large, and OSError."""
    with open(path, "rb") as file:
        data = file.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise ValueError(f"more than {MOST_BYTES / 1e6:.0f} MB")
    return parse_json(data)


def plain(value: Any, *, infinite: bool = False, named: tuple[type, ...] = ()) -> Any:
    """A value in types that JSON knows.

    Data classes and named tuples are objects by field, what has a ``to_dict`` gives it, and what
    is of a type in ``named`` is its name. NaN is None; so is infinity, or, where ``infinite``
    ones are told, the text "inf" or "-inf".
    """

    def inner(one: Any) -> Any:
        return plain(one, infinite=infinite, named=named)

    if named and isinstance(value, named):
        return str(vars(value)["name"])
    if hasattr(value, "to_dict"):
        return inner(value.to_dict())
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: inner(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return inner(value._asdict())
    if isinstance(value, dict):
        return {str(key): inner(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [inner(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return f"{value}" if infinite and not math.isnan(value) else None
    return value


def json_text(tree: Any) -> str:
    """Text of a file, indented, with an end of line; values as `plain` makes them."""
    return json.dumps(plain(tree), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
