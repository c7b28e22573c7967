"""Worlds with rounder numbers: all of them at once, those of one thing, each by itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from physim.campaigns.falsify.tree import Place, State, Tree, at, replaced

DECIMALS = (0, 1, 2, 3)
"""To which numbers are rounded, the roundest first."""
ROUNDED = (
    "corridor", "boundaries", "reference_path", "robots", "formation", "controller", "obstacles",
    "sensing", "arrival", "physics",
)  # fmt: skip
"""Keys of a world whose numbers are rounded; the time is not."""
KEPT = ("footprint",)
"""Keys whose numbers stay as they are: a robot has the shape that it has."""


def rounder(state: State) -> Iterator[Tree]:
    """Propose rounder numbers; headings may become 0, too."""
    places = list(_numbers(state.tree, ()))
    for group in _groups(places):
        yield from _rounded(state, group)
    for place in places:
        if place[-2:] == ("pose", 2) and at(state.tree, place) != 0.0:
            yield replaced(state.tree, {place: 0.0})
        yield from _rounded(state, [place])


def _groups(places: list[Place]) -> list[list[Place]]:
    """All numbers; those of one key of the world; those of one robot; those of one key of one."""
    groups: dict[Place, list[Place]] = {}
    for depth in (0, 1, 2, 3):
        for place in places:
            if len(place) > depth:
                groups.setdefault(place[:depth], []).append(place)
    return [group for group in groups.values() if len(group) > 1]


def _rounded(state: State, places: list[Place]) -> Iterator[Tree]:
    """Round these numbers as far as can be; nothing where they are that round already."""
    for decimals in DECIMALS:
        tree, found = state.tree, {}
        for place in places:
            number = at(tree, place)
            rounded = round(number, decimals) + 0.0  # no -0.0
            if rounded != number:
                found[place] = rounded
        if not found:
            return
        yield replaced(tree, found)
        if state.tree is not tree:
            return


def _numbers(value: Any, place: Place) -> Iterator[Place]:
    """Where numbers with a fraction stand that may be rounded."""
    if isinstance(value, dict):
        for key, item in value.items():
            if key not in KEPT and (place or key in ROUNDED):
                yield from _numbers(item, (*place, key))
    elif isinstance(value, list):
        for k, item in enumerate(value):
            yield from _numbers(item, (*place, k))
    elif type(value) is float:
        yield place
