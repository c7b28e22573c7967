"""In which values two worlds differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from typing import Any

import yaml

from physim.world.model import World

ABSENT, NONE = "default", "none"
"""Stand for a value, and for an entry of a list, that one of the worlds does not give."""


def differences(a: World, b: World) -> dict[str, tuple[str, str]]:
    """Values of two worlds that differ, as text, by their dotted keys: of ``a``, then of ``b``.

    Where a part of another name stands in a place, its settings are not counted.
    """
    first, second = (dict(_values(yaml.safe_load(world.to_yaml()))) for world in (a, b))
    places = (
        {place for key in first for place in _places(key)},
        {place for key in second for place in _places(key)},
    )
    pairs = {
        key: (_told(first, places[0], key), _told(second, places[1], key))
        for key in {**first, **second}
    }
    found = {key: pair for key, pair in pairs.items() if pair[0] != pair[1]}
    others = {key.removesuffix(".type") for key in found if key.endswith(".type")}
    return {
        key: pair
        for key, pair in found.items()
        if others.isdisjoint(_places(key.removesuffix(".type").rpartition(".")[0]))
    }


def _places(key: str) -> Iterator[str]:
    """The key and every part of the world that it stands in, from the inside out."""
    while key:
        yield key
        key = key.rpartition(".")[0]


def _told(values: Mapping[str, str], places: Set[str], key: str) -> str:
    """A value as text, or why there is none: the entry of its list is missing, or it alone is."""
    if key in values:
        return values[key]
    entry = next((place for place in _places(key) if place.rpartition(".")[2].isdigit()), None)
    return ABSENT if entry is None or entry in places else NONE


def _values(value: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Every plain value in a world with its dotted key."""
    parts = value.items() if isinstance(value, Mapping) else enumerate(value)
    for name, part in parts:
        dotted = f"{key}.{name}" if key else str(name)
        if isinstance(part, Mapping | list):
            yield from _values(part, dotted)
        else:
            yield dotted, str(part)
