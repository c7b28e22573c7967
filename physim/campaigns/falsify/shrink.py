"""A failing world made as small as it can be while it still fails in the same way.

As Hypothesis shrinks an example: passes propose simpler worlds, the simplest first; each is run,
and taken only where its first contact is of the same kind, two robots or a robot and a wall, with
the robots in the same modes, and where a check accepts it. Passes are repeated until none finds
anything simpler, or the runs are used up. The order is fixed and nothing is random, so the result
depends on the failing world alone.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from physim.campaigns.falsify.evaluate import Accepts, Evaluate, Judged, StoppedError
from physim.campaigns.falsify.passes import (
    State,
    Tree,
    fewer_robots,
    fewer_things,
    later,
    rounder,
    shorter,
    straighter,
    tree_of,
)
from physim.campaigns.falsify.starts import starts_of
from physim.campaigns.one_run import never
from physim.errors import WorldError
from physim.world import World

MOST_RUNS = 500
"""Runs at most, where nothing else is asked for."""
PASSES: tuple[Callable[[State], Iterator[Tree]], ...] = (
    shorter, later, shorter, fewer_robots, fewer_things, straighter, shorter, rounder,
)  # fmt: skip
"""In the order in which they are tried: what makes runs cheap comes first."""


@dataclass
class Shrunk:
    """A failing world, as small as it is so far; every one taken has failed when it was run."""

    world: World
    judged: Judged
    tree: Tree
    runs: int = 0
    taken: int = 0
    """simpler worlds that failed likewise"""
    is_least: bool = False
    """no pass finds anything simpler; otherwise the runs were used up, or it was told to stop"""
    stopped: bool = False
    _gap: float = 0.0
    """[m] that starts keep, as those of the search do: what begins all but in contact tells nobody
    anything"""
    _seen: set[str] = field(default_factory=set)


def shrink(
    world: World,
    result: Judged,
    evaluate: Evaluate,
    accepts: Accepts,
    *,
    most_runs: int = MOST_RUNS,
    progress: Callable[[Shrunk], None] = lambda _: None,
    stop: Callable[[], bool] = never,
) -> Shrunk:
    """Shrink a world whose run was judged ``result``, with at most ``most_runs`` runs.

    Raises ValueError for a run in which nothing touched.
    """
    if result.touched is None:
        raise ValueError("only a world that fails can be shrunk")
    found = Shrunk(world, result, tree_of(world), _gap=_least_gap(world))
    while not found.is_least:
        before = found.taken
        for propose in PASSES:
            for tree in propose(found):
                candidate = _new(found, tree)
                if candidate is None:
                    continue
                found.stopped = stop()
                if found.stopped or found.runs >= most_runs:
                    return found
                found.runs += 1
                try:
                    run = next(iter(evaluate([candidate])))
                except StoppedError:
                    found.stopped = True
                    return found
                if _fails_alike(run, found.judged) and not accepts(candidate):
                    found.world, found.judged, found.tree = candidate, run, tree
                    found.taken += 1
                progress(found)
        found.is_least = found.taken == before
    return found


def _new(found: Shrunk, tree: Tree) -> World | None:
    """The world of a tree where it is another one that can start, which was not tried yet."""
    key = json.dumps(tree)
    if key in found._seen:
        return None
    found._seen.add(key)
    try:
        world = World(**tree)
    except WorldError:
        return None
    if world == found.world:  # what was left out says what holds anyway
        found.tree = tree
        return None
    return world if _least_gap(world) >= found._gap else None


def _least_gap(world: World) -> float:
    """The least that any robot has at its start; 0 where that cannot be told."""
    try:
        return float(starts_of(world).gap.min())
    except WorldError:
        return 0.0


def _fails_alike(result: Judged, before: Judged) -> bool:
    """Whether the first contact of a run is of the kind of that before, in the same modes."""
    one, other = result.touched, before.touched
    if one is None or other is None:
        return False
    return one.kind == other.kind and sorted(one.modes) == sorted(other.modes)


def size_of(world: World) -> dict[str, Any]:
    """How large a world is, in the terms in which it is shrunk."""
    tree = tree_of(world)
    corridor = tree.get("corridor") or {}
    walls = [corridor.get("centreline") or [], *(tree.get("boundaries") or [])]
    return {
        "robots": len(world.robots),
        "duration": world.time.duration,
        "wall_points": sum(map(len, walls)),
        "obstacles": len(world.obstacles),
        "path_points": sum(
            len(robot["path"]) for robot in tree["robots"] if isinstance(robot["path"], list)
        ),
    }
