"""What the record's world says, read for the few keys that figures depend on."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import yaml

from physim.errors import RecordError
from physim.record import Record


def world_settings(record: Record) -> Mapping[str, Any]:
    """Return the world of a record as plain values; empty where it has none.

    Raises RecordError when its text is no YAML.
    """
    try:
        world = _parsed(record.world_text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        line = " ".join(str(error).split())
        raise RecordError(f"world text of {record!r} cannot be read: {line}") from error
    return world if isinstance(world, Mapping) else {}


@functools.lru_cache(maxsize=2)
def _parsed(text: str) -> Any:
    """YAML text as plain values; by the library in C where there is one, ten times as fast."""
    return yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
