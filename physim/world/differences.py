"""In which values two worlds differ."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import yaml

from physim.world.model import World

STAGE = re.compile(r"(sensing\.stages|filters|disturbances)\.\d+\.type")
Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""The one in C takes a tenth of the time."""


def differences(a: World, b: World) -> dict[str, tuple[str, str]]:
    """Values of two worlds that differ, as text, by their dotted keys: of ``a``, then of ``b``.

    A key that a world leaves out has its ``default`` there, an entry of a list is ``none``. Where a
    part of another name stands in a place, its settings are not counted.
    """
    first, second = (dict(_values(yaml.load(world.to_yaml(), Loader=Loader))) for world in (a, b))
    pairs = {}
    for key in {**first, **second}:
        absent = "none" if any(part.isdigit() for part in key.split(".")) else "default"
        pairs[key] = first.get(key, absent), second.get(key, absent)
    found = {key: pair for key, pair in pairs.items() if pair[0] != pair[1]}
    others = tuple(key.removesuffix("type") for key in found if key.endswith(".type"))
    return {k: pair for k, pair in found.items() if k.endswith(".type") or not k.startswith(others)}


def stages_apart(
    found: Mapping[str, tuple[str, str]],
) -> tuple[dict[str, tuple[str, str]], list[tuple[str, str]]]:
    """What is left of differences without the stages that only one of two worlds has.

    And these in words, for each world: ``with noise, messages`` and ``without noise, messages``.
    """
    lists: dict[str, list[str]] = {}
    for key in found:
        if stage := STAGE.fullmatch(key):
            lists.setdefault(stage[1], []).append(key)
    rest, words = dict(found), []
    for keys in lists.values():
        first, second = zip(*(found[key] for key in keys), strict=True)
        for mine, other in ((first, second), (second, first)):
            if set(other) == {"none"}:
                pair = f"with {', '.join(mine)}", f"without {', '.join(mine)}"
                words.append(pair if mine is first else pair[::-1])
                rest = {key: values for key, values in rest.items() if key not in keys}
    return rest, words


def key_in_words(key: str) -> str:
    """``formation gain``, ``duration``, ``sensing stage 1 deviation``: a dotted key in words."""
    words: list[str] = []
    for part in key.removeprefix("time.").removesuffix(".type").split("."):
        if part.isdigit():  # an entry of robots may be many robots
            words[-1] = "robots entry" if words[-1] == "robots" else words[-1].removesuffix("s")
            part = str(int(part) + 1)
        words.append(part.replace("_", " "))
    return " ".join(words)


def _values(value: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Every plain value in a world with its dotted key."""
    parts = value.items() if isinstance(value, Mapping) else enumerate(value)
    for name, part in parts:
        dotted = f"{key}.{name}" if key else str(name)
        if isinstance(part, Mapping | list):
            yield from _values(part, dotted)
        else:
            yield dotted, str(part)
