"""Passes of shrinking: what counts as a simpler world. Shorter runs, fewer robots and things,
straighter walls, rounder numbers.

A pass yields trees, worlds as their files say them; where one is taken, the state has it when the
pass goes on. A proposal may be no world at all: who takes it checks that.

A run may start later, from where all robots were then. A robot has no inertia: it moves as it is
told from the first step on, so where it was is all that a start needs of its motion. What else a
run carries along begins anew: modes and what controllers remember, commands held, the states of
stages, noise by its step. So a later start is another run, taken like any simpler world only where
it fails in the same way; where the failure needs what came before, none is.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import ceil, floor, pi, remainder
from typing import Any, Protocol

import numpy as np
import yaml

from physim.campaigns.falsify.evaluate import Judged, Moment
from physim.campaigns.falsify.space import TURN
from physim.campaigns.falsify.starts import starts_of
from physim.errors import WorldError
from physim.world import World
from physim.world.layout.scene_builder import build_scene
from physim.world.robot import Limits

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


MARGIN, MOST = 1.5, 0.9
"""[-] of the time that was left until the contact, and of that of the contact: the new run takes as
long, so that the same failure may come a little later and the run is shorter all the same"""
TENTH = 0.1
"""[s] to which times are rounded up"""
OPTIONAL = (
    "formation", "sensing", "filters", "disturbances", "arrival", "physics", "reference_path",
)  # fmt: skip
"""Keys of a world without which it may fail likewise."""
OPTIONAL_OF_ROBOT = ("limits", "mass")
CHOICES = ("speeds", "omegas")
"""Sets to choose from, which stay: rounded they offer fewer choices, left out perhaps more."""
OF_NO_ROBOT = (*CHOICES, "dwell_times")
"""Lists of a controller that have as many things as there are robots by chance alone"""
DECIMALS = (0, 1, 2, 3)
"""To which numbers are rounded, the roundest first."""
ROUNDED = (
    "corridor", "boundaries", "reference_path", "robots", "formation", "controller", "obstacles",
    "sensing", "arrival", "physics",
)  # fmt: skip
"""Keys of a world whose numbers are rounded; the time is not."""
KEPT = ("footprint", *CHOICES)
"""Keys whose numbers stay as they are: a robot has the shape and the choices that it has."""


def shorter(state: State) -> Iterator[Tree]:
    """End at the first contact: at the next tenth of a second, or at its very step."""
    tree, touched = state.tree, state.judged.touched
    if touched is None:
        return
    step, duration = tree["time"]["step"], tree["time"]["duration"]
    tenth = round(ceil(touched.time / TENTH - 1e-9) * TENTH, 1)
    exact = round(max(1, round(touched.time / step)) * step, 10)
    for end in (exact, tenth):
        if touched.time - 0.5 * step <= end < duration - 0.5 * step:
            yield replaced(tree, {("time", "duration"): end})
            if state.tree is not tree:
                return


def later(state: State) -> Iterator[Tree]:
    """Start as shortly before the first contact as can be, then earlier ones.

    Starts keep the distances that starts of the search do: what begins all but in contact tells
    nobody anything.
    """
    tree: Tree = {}
    while state.tree is not tree:
        tree = state.tree
        try:
            world = World(**tree)
            starts = starts_of(world)
        except WorldError:  # as where robots stand closer than a start may be judged
            return
        for moment in state.judged.before:
            poses = np.array(moment.poses)
            if len(tree["robots"]) == len(poses) and starts.fit(poses):
                yield _from(state, world, moment)
            if state.tree is not tree:
                break


def _from(state: State, world: World, moment: Moment) -> Tree:
    """The tree of a world in which robots start where they were at a moment."""
    touched = state.judged.touched
    assert touched is not None
    tree = copy.deepcopy(state.tree)
    step = tree["time"]["step"]
    end = min(MARGIN * (touched.time - moment.time), MOST * touched.time)
    tree["time"]["duration"] = round(max(1, ceil(end / step - 1e-9)) * step, 10)
    tree.pop("start", None)
    for robot, (x, y, heading) in zip(tree["robots"], moment.poses, strict=True):
        robot.pop("start", None)
        robot["pose"] = [x, y, remainder(heading, 2.0 * pi)]
    if world.formation is not None and world.formation.spacing == "initial":
        tree["formation"]["spacing"] = build_scene(world).formation.lead.tolist()
    return tree


def fewer_robots(state: State) -> Iterator[Tree]:
    """Leave out all that did not touch; then robots in groups and one by one."""
    robots = state.tree["robots"]
    names = () if state.judged.touched is None else state.judged.touched.pair
    touched = [k for k, robot in enumerate(robots) if robot["name"] in names]
    if 0 < len(touched) < len(robots):
        yield with_robots(state.tree, touched)
    yield from fewer(state, ("robots",), 1, with_robots)


def with_robots(tree: Tree, kept: Sequence[int]) -> Tree:
    """Return a world with some of its robots only, in their formation.

    A setting of the controller that lists as many things as there are robots keeps theirs, but for
    speeds to choose from and their times.
    """
    changed = copy.deepcopy(tree)
    robots = changed["robots"]
    changed["robots"] = [robots[k] for k in kept]
    for key, value in changed.get("controller", {}).items():
        if isinstance(value, list) and len(value) == len(robots) and key not in OF_NO_ROBOT:
            changed["controller"][key] = [value[k] for k in kept]
    formation = changed.get("formation")
    if formation is not None:
        spacing, pairs = formation.get("spacing"), formation.get("neighbours")
        if isinstance(spacing, list):
            formation["spacing"] = [spacing[k] - spacing[kept[0]] for k in kept]
        if isinstance(pairs, list):
            names = {robot["name"] for robot in changed["robots"]}
            formation["neighbours"] = [pair for pair in pairs if names.issuperset(pair)]
    return changed


def fewer_things(state: State) -> Iterator[Tree]:
    """Leave out what need not be given: obstacles, formation, stages, settings, limits."""
    if state.tree.get("obstacles"):
        yield from fewer(state, ("obstacles",), 0)
    if state.tree.get("boundaries"):
        yield from fewer(state, ("boundaries",), 1)
    places: list[Place] = [(key,) for key in OPTIONAL]
    settings = [key for key in state.tree.get("controller", {}) if key not in ("type", *CHOICES)]
    places += [("controller", key) for key in settings]
    robots = range(len(state.tree["robots"]))
    places += [("robots", k, key) for k in robots for key in OPTIONAL_OF_ROBOT]
    for place in places:
        if place[-1] in at(state.tree, place[:-1]) and not _loosens(state.tree, place):
            changed = copy.deepcopy(state.tree)
            del at(changed, place[:-1])[place[-1]]
            yield changed


def _loosens(tree: Tree, place: Place) -> bool:
    """Whether a robot without what stands at a place could move faster than with it."""
    usual = Limits()
    given = at(tree, place) if place[-1] == "limits" else {}
    return any(number < getattr(usual, key) for key, number in given.items())


def straighter(state: State) -> Iterator[Tree]:
    """Give roads one width, and walls and paths fewer points."""
    corridor = state.tree.get("corridor")
    if corridor is not None and "centreline" in corridor:  # not one that the seed draws
        if isinstance(width := corridor["width"], list):
            middle, tree = round(sum(width) / len(width), 1), state.tree
            for one in dict.fromkeys((round(max(width), 1), middle, round(min(width), 1))):
                yield replaced(tree, {("corridor", "width"): one})
                if state.tree is not tree:
                    break
        yield from fewer(state, ("corridor", "centreline"), 2, _with_centreline)
    places: list[Place] = [("reference_path",)] if state.tree.get("reference_path") else []
    for key in ("boundaries", "obstacles"):
        places += [(key, k) for k in range(len(state.tree.get(key) or []))]
    paths = enumerate(robot.get("path") for robot in state.tree["robots"])  # a group has several
    places += [("robots", k, "path") for k, path in paths if isinstance(path, list)]
    for place in places:
        yield from fewer(state, place, 2)


def _with_centreline(tree: Tree, kept: Sequence[int]) -> Tree:
    """Return a world with some points of its centreline only, each with its width."""
    corridor = tree["corridor"]
    lists = {key: corridor[key] for key in ("centreline", "width")}
    return replaced(
        tree,
        {
            ("corridor", key): [given[k] for k in kept]
            for key, given in lists.items()
            if isinstance(given, list)
        },
    )


def fewer(
    state: State,
    place: Place,
    least: int,
    make: Callable[[Tree, Sequence[int]], Tree] | None = None,
) -> Iterator[Tree]:
    """Leave out things of the list at a place: all but ``least``, then halves, quarters, … of them.

    At least ``least`` stay. ``make`` gives the tree with only some of them, where it takes more
    than leaving them out of the list.
    """

    def made(kept: Sequence[int]) -> Tree:
        things = at(state.tree, place)
        return (
            make(state.tree, kept)
            if make
            else replaced(state.tree, {place: [things[k] for k in kept]})
        )

    def count() -> int:
        return len(at(state.tree, place))

    if count() > least:
        yield made(range(least))
    size = (count() + 1) // 2
    while size >= 1 and count() > least:
        end = count()
        while end > 0:  # from the end: most roads and paths go on beyond where it fails
            start = max(0, end - size)
            kept = [k for k in range(count()) if not start <= k < end]
            if len(kept) >= least:
                yield made(kept)
            end = start
        size //= 2


def rounder(state: State) -> Iterator[Tree]:
    """Propose rounder numbers; headings that are nearly 0 may become so, too.

    All numbers at once; those of one key of the world; of one robot; of one key of one; each.
    Farther off another failure would be told, and not the one that was found.
    """
    places = list(_numbers(state.tree, ()))
    groups: dict[Place, list[Place]] = {}
    for depth in (0, 1, 2, 3):
        for place in places:
            if len(place) > depth:
                groups.setdefault(place[:depth], []).append(place)
    for group in groups.values():
        if len(group) > 1:
            yield from _rounded(state, group)
    for place in places:
        if place[-2:] == ("pose", 2) and 0.0 < abs(at(state.tree, place)) <= TURN:
            yield replaced(state.tree, {place: 0.0})
        yield from _rounded(state, [place])


def _rounded(state: State, places: list[Place]) -> Iterator[Tree]:
    """Round these numbers as far as can be; nothing where they are that round already."""
    for decimals in DECIMALS:
        tree, found = state.tree, {}
        for place in places:
            number = at(tree, place)
            rounded = round(number, decimals) + 0.0  # no -0.0
            if "limits" in place and rounded > number:  # no robot may come to move faster
                rounded = floor(number * 10**decimals) / 10**decimals or number
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
