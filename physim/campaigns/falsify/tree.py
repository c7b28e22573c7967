"""A world as its file says it: mappings, lists and numbers, changed by copies."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any, Protocol

import yaml

from physim.campaigns.falsify.robustness import Judged
from physim.world import World

Tree = dict[str, Any]
Place = tuple[str | int, ...]
"""Where in a tree something stands."""


class State(Protocol):
    """How far shrinking is. What a pass proposes may have been taken when it goes on."""

    tree: Tree
    judged: Judged


def tree_of(world: World) -> Tree:
    """Return the tree of a world of which nothing is expected but to be free of contacts."""
    tree: Tree = yaml.safe_load(world.to_yaml())
    tree["expect"] = {"contacts": 0}
    tree.pop("description", None)  # it speaks of the world as it was
    return tree


def at(tree: Any, place: Place) -> Any:
    """Return what stands at a place."""
    for key in place:
        tree = tree[key]
    return tree


def replaced(tree: Tree, values: Mapping[Place, Any]) -> Tree:
    """Return a copy with other values at some places."""
    changed = copy.deepcopy(tree)
    for place, value in values.items():
        at(changed, place[:-1])[place[-1]] = value
    return changed


def without(tree: Tree, place: Place) -> Tree:
    """Return a copy without the key at a place."""
    changed = copy.deepcopy(tree)
    del at(changed, place[:-1])[place[-1]]
    return changed
