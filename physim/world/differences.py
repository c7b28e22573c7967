"""In which values two worlds differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import yaml

from physim.world.model import World

ABSENT, NONE = "default", "none"
"""Stand for a value, and for an entry of a list, that one of the worlds does not give."""


def differences(a: World, b: World) -> dict[str, tuple[str, str]]:
    """Values of two worlds that differ, as text, by their dotted keys: of ``a``, then of ``b``.

    Where a part of another name stands in a place, its settings are not counted.
    """
    first, second = (yaml.safe_load(world.to_yaml()) for world in (a, b))
    return differing_values(first, second)


def differing_values(a: Mapping[str, Any], b: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Return `differences` of worlds as they stand in files: mappings, lists, numbers, texts."""
    first, second = dict(_values(a)), dict(_values(b))
    pairs = {key: (_told(first, key), _told(second, key)) for key in {**first, **second}}
    found = {key: pair for key, pair in pairs.items() if pair[0] != pair[1]}
    for part in [key.removesuffix("type") for key in found if key.endswith(".type")]:
        settings = [key for key in found if key.startswith(part) and key != f"{part}type"]
        for key in settings:
            del found[key]
    return found


def _told(values: Mapping[str, str], key: str) -> str:
    """A value as text, or why there is none: the entry of its list is missing, or it alone is."""
    if key in values:
        return values[key]
    parts = key.split(".")
    last = max((k for k, part in enumerate(parts) if part.isdigit()), default=-1)
    entry = ".".join(parts[: last + 1])
    is_there = any(other == entry or other.startswith(f"{entry}.") for other in values)
    return ABSENT if last < 0 or is_there else NONE


def _values(value: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Every plain value in a world with its dotted key."""
    parts = value.items() if isinstance(value, Mapping) else enumerate(value)
    for name, part in parts:
        dotted = f"{key}.{name}" if key else str(name)
        if isinstance(part, Mapping | list):
            yield from _values(part, dotted)
        else:
            yield dotted, str(part)
