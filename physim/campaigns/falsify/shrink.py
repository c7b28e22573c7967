"""A failing world made as small as it can be while it still fails in the same way.

As Hypothesis shrinks an example: passes propose simpler worlds, the simplest first: shorter runs,
fewer robots and things, straighter walls, rounder numbers. Each is run, and taken only where its
first contact is of the same kind, two robots or a robot and a wall, with the robots in the same
modes, and where a check accepts it. Passes are repeated until none finds anything simpler, or the
runs are used up. The order is fixed and nothing is random, so the result depends on the failing
world alone.

A run may start later, from where all robots were then. A robot has no inertia: it moves as it is
told from the first step on, so where it was is all that a start needs of its motion. What else a
run carries along begins anew: modes and what controllers remember, commands held, the states of
stages, noise by its step. So a later start is another run; where the failure needs what came
before, none is taken.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, floor, pi, remainder
from typing import Any

import numpy as np
import yaml

from physim.campaigns.falsify.evaluate import Accepts, Evaluate, Judged, Moment, StoppedError
from physim.campaigns.falsify.space import TURN, starts_of
from physim.campaigns.pool import never
from physim.errors import WorldError
from physim.world import World
from physim.world.layout.scene_builder import build_scene
from physim.world.robot import Limits

Tree = dict[str, Any]
"""A world as its file says it"""
Place = tuple[str | int, ...]
"""Where in a tree something stands."""
MOST_RUNS = 500
"""Runs at most, where nothing else is asked for."""
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


def shorter(found: Shrunk) -> Iterator[Tree]:
    """End at the first contact: at the next tenth of a second, or at its very step."""
    tree, touched = found.tree, found.judged.touched
    if touched is None:
        return
    step, duration = tree["time"]["step"], tree["time"]["duration"]
    tenth = round(ceil(touched.time / TENTH - 1e-9) * TENTH, 1)
    exact = round(max(1, round(touched.time / step)) * step, 10)
    for end in (exact, tenth):
        if touched.time - 0.5 * step <= end < duration - 0.5 * step:
            yield replaced(tree, {("time", "duration"): end})
            if found.tree is not tree:
                return


def later(found: Shrunk) -> Iterator[Tree]:
    """Start as shortly before the first contact as can be, then earlier ones.

    Starts keep the distances that starts of the search do: what begins all but in contact tells
    nobody anything.
    """
    tree: Tree = {}
    while found.tree is not tree:
        tree = found.tree
        try:
            world = World(**tree)
            starts = starts_of(world)
        except WorldError:  # as where robots stand closer than a start may be judged
            return
        for moment in found.judged.before:
            poses = np.array(moment.poses)
            if len(tree["robots"]) == len(poses) and starts.fit(poses):
                yield _from(found, world, moment)
            if found.tree is not tree:
                break


def _from(found: Shrunk, world: World, moment: Moment) -> Tree:
    """The tree of a world in which robots start where they were at a moment."""
    touched = found.judged.touched
    assert touched is not None
    tree = copy.deepcopy(found.tree)
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


def fewer_robots(found: Shrunk) -> Iterator[Tree]:
    """Leave out all that did not touch; then robots in groups and one by one."""
    robots = found.tree["robots"]
    names = () if found.judged.touched is None else found.judged.touched.pair
    touched = [k for k, robot in enumerate(robots) if robot["name"] in names]
    if 0 < len(touched) < len(robots):
        yield with_robots(found.tree, touched)
    yield from fewer(found, ("robots",), 1, with_robots)


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


def fewer_things(found: Shrunk) -> Iterator[Tree]:
    """Leave out what need not be given: obstacles, movers, formation, stages, settings, limits."""
    for key in ("obstacles", "movers"):
        if found.tree.get(key):
            yield from fewer(found, (key,), 0)
    if found.tree.get("boundaries"):
        yield from fewer(found, ("boundaries",), 1)
    places: list[Place] = [(key,) for key in OPTIONAL]
    settings = [key for key in found.tree.get("controller", {}) if key not in ("type", *CHOICES)]
    places += [("controller", key) for key in settings]
    robots = range(len(found.tree["robots"]))
    places += [("robots", k, key) for k in robots for key in OPTIONAL_OF_ROBOT]
    for place in places:
        if place[-1] in at(found.tree, place[:-1]) and not _loosens(found.tree, place):
            changed = copy.deepcopy(found.tree)
            del at(changed, place[:-1])[place[-1]]
            yield changed


def _loosens(tree: Tree, place: Place) -> bool:
    """Whether a robot without what stands at a place could move faster than with it."""
    usual = Limits()
    given = at(tree, place) if place[-1] == "limits" else {}
    return any(number < getattr(usual, key) for key, number in given.items())


def straighter(found: Shrunk) -> Iterator[Tree]:
    """Give roads one width, and walls and paths fewer points."""
    corridor = found.tree.get("corridor")
    if corridor is not None and "centreline" in corridor:  # not one that the seed draws
        if isinstance(width := corridor["width"], list):
            middle, tree = round(sum(width) / len(width), 1), found.tree
            for one in dict.fromkeys((round(max(width), 1), middle, round(min(width), 1))):
                yield replaced(tree, {("corridor", "width"): one})
                if found.tree is not tree:
                    break
        yield from fewer(found, ("corridor", "centreline"), 2, _with_centreline)
    places: list[Place] = [("reference_path",)] if found.tree.get("reference_path") else []
    for key in ("boundaries", "obstacles"):
        for k, line in enumerate(found.tree.get(key) or []):
            places.append((key, k) if isinstance(line, list) else (key, k, "corners"))
    paths = enumerate(robot.get("path") for robot in found.tree["robots"])  # a group has several
    places += [("robots", k, "path") for k, path in paths if isinstance(path, list)]
    for place in places:
        yield from fewer(found, place, 2)


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
    found: Shrunk,
    place: Place,
    least: int,
    make: Callable[[Tree, Sequence[int]], Tree] | None = None,
) -> Iterator[Tree]:
    """Leave out things of the list at a place: all but ``least``, then halves, quarters, … of them.

    At least ``least`` stay. ``make`` gives the tree with only some of them, where it takes more
    than leaving them out of the list.
    """

    def made(kept: Sequence[int]) -> Tree:
        things = at(found.tree, place)
        return (
            make(found.tree, kept)
            if make
            else replaced(found.tree, {place: [things[k] for k in kept]})
        )

    def count() -> int:
        return len(at(found.tree, place))

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


def rounder(found: Shrunk) -> Iterator[Tree]:
    """Propose rounder numbers; headings that are nearly 0 may become so, too.

    All numbers at once; those of one key of the world; of one robot; of one key of one; each.
    Farther off another failure would be told, and not the one that was found.
    """
    places = list(_numbers(found.tree, ()))
    groups: dict[Place, list[Place]] = {}
    for depth in (0, 1, 2, 3):
        for place in places:
            if len(place) > depth:
                groups.setdefault(place[:depth], []).append(place)
    for group in groups.values():
        if len(group) > 1:
            yield from _rounded(found, group)
    for place in places:
        if place[-2:] == ("pose", 2) and 0.0 < abs(at(found.tree, place)) <= TURN:
            yield replaced(found.tree, {place: 0.0})
        yield from _rounded(found, [place])


def _rounded(found: Shrunk, places: list[Place]) -> Iterator[Tree]:
    """Round these numbers as far as can be; nothing where they are that round already."""
    for decimals in DECIMALS:
        tree, changed = found.tree, {}
        for place in places:
            number = at(tree, place)
            rounded = round(number, decimals) + 0.0  # no -0.0
            if "limits" in place and rounded > number:  # no robot may come to move faster
                rounded = floor(number * 10**decimals) / 10**decimals or number
            if rounded != number:
                changed[place] = rounded
        if not changed:
            return
        yield replaced(tree, changed)
        if found.tree is not tree:
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


PASSES: tuple[Callable[[Shrunk], Iterator[Tree]], ...] = (
    shorter, later, shorter, fewer_robots, fewer_things, straighter, shorter, rounder,
)  # fmt: skip
"""In the order in which they are tried: what makes runs cheap comes first."""


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
        "robots": world.robot_count,
        "duration": world.time.duration,
        "wall_points": sum(map(len, walls)),
        "obstacles": len(world.obstacles),
        "path_points": sum(
            len(robot["path"]) for robot in tree["robots"] if isinstance(robot["path"], list)
        ),
    }
