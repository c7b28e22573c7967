"""JSON that anybody may have written: whatever is wrong with it is a ValueError in plain words."""

from __future__ import annotations

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


__all__ = ["file_json", "parse_json"]
