"""Faults that lie between several values of a world: counts, names, times.

The values are sound, each by itself.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from physim.errors import Fault, Location, nearest
from physim.tolerances import LENGTH, WHOLE_STEPS
from physim.world.faults import describe
from physim.world.group import NUMBER, RobotGroup
from physim.world.kinds import Point
from physim.world.mover import mover_faults
from physim.world.road import RandomCorridor, RandomRoad
from physim.world.robot import Offset, Robot, Start

if TYPE_CHECKING:
    from physim.world.model import World

MOST_STEPS = 100_000_000
ROOM_IN_BENDS = 1.0
"""[m] by which the radius of a bend exceeds half the width, so that no wall folds over"""
WALL_NAMES = re.compile(r"(?:left|right) wall|(?:start|end) cap|(?:boundary|obstacle) [0-9]+")
"""Names of boundaries and obstacles, which no robot may have"""


def rule_faults(world: World) -> list[Fault]:
    """Every fault between values of a world."""
    rules = (
        _time, _walls, _names, _robots, _formation, _neighbours, _distinct, _expected, _road,
        mover_faults,
    )  # fmt: skip
    return [fault for rule in rules for fault in rule(world)]


def _time(world: World) -> Iterator[Fault]:
    step, duration = world.time.step, world.time.duration
    ratio = duration / step
    steps = round(ratio)
    if step > duration:
        message = f"{step!r} s is longer than the duration, {duration!r} s; at most that is allowed"
        yield Fault(("time", "step"), message)
    elif steps > MOST_STEPS:
        message = f"{steps} steps of {step!r} s; at most {MOST_STEPS} are allowed"
        yield Fault(("time", "duration"), message)
    elif abs(ratio - steps) > WHOLE_STEPS * max(1.0, ratio):
        below, above = int(ratio) * step, (int(ratio) + 1) * step
        message = f"{duration!r} s is not a whole number of steps of {step!r} s"
        yield Fault(("time", "duration"), f"{message}; nearest are {below:.12g} and {above:.12g}")


def _walls(world: World) -> Iterator[Fault]:
    corridor = world.corridor
    if corridor is None and world.boundaries is None:
        yield Fault((), "neither corridor nor boundaries; a world needs one of them")
    elif corridor is None and world.reference_path is None:
        yield Fault(("reference_path",), "missing; a world with boundaries must give it [m]")
    elif corridor is not None and world.boundaries is not None:
        yield Fault(("boundaries",), "given beside corridor; a world has one of them, not both")
    if corridor is None or isinstance(corridor, RandomCorridor):
        return
    if isinstance(corridor.width, tuple) and len(corridor.width) != len(corridor.centreline):
        yield Fault(
            ("corridor", "width"),
            f"{len(corridor.width)} widths for {len(corridor.centreline)} points of the "
            "centreline; give one number, or one per point",
        )


def _robot_names(world: World) -> Iterator[tuple[int, str]]:
    """Number of the entry and name of each robot, one by one."""
    number = 0
    for e, entry in enumerate(world.robots):
        for _ in range(entry.count if isinstance(entry, RobotGroup) else 1):
            number += 1
            is_group = isinstance(entry, RobotGroup)
            yield e, entry.name.replace(NUMBER, str(number)) if is_group else entry.name


def _names(world: World) -> Iterator[Fault]:
    first: dict[str, int] = {}
    faults: dict[int, Fault] = {}  # of a group the first
    for e, name in _robot_names(world):
        message = ""
        if name in first:
            message = f"is the name of robots[{first[name]}] too; names must differ"
        elif WALL_NAMES.fullmatch(name):
            message = "names a wall in reports; give the robot another name"
        if message:
            faults.setdefault(e, Fault(("robots", e, "name"), f"{describe(name)} {message}"))
        first.setdefault(name, e)
    yield from faults.values()
    names = {name: f"robots[{e}]" for name, e in first.items()}
    for k, mover in enumerate(world.movers):
        where, name = ("movers", k, "name"), mover.name
        if name in names:
            message = f"is the name of {names[name]} too; names must differ"
            yield Fault(where, f"{describe(name)} {message}")
        elif WALL_NAMES.fullmatch(name):
            message = "names a wall in reports; give the mover another name"
            yield Fault(where, f"{describe(name)} {message}")
        names.setdefault(name, f"movers[{k}]")


def _robots(world: World) -> Iterator[Fault]:
    """Every robot has one place, one footprint and one path, and speeds that it can follow."""
    starts: list[tuple[Location, Start | None]] = [((), world.start)]
    for e, entry in enumerate(world.robots):
        where: Location = ("robots", e)
        pose = entry.pose if isinstance(entry, Robot) else None
        starts.append((where, entry.start))
        if pose is not None and entry.start is not None:
            yield Fault((*where, "start"), "given beside pose; a robot has one of them")
        elif pose is None and entry.start is None and world.start is None:
            region = "a start region, here or for the whole world"
            if isinstance(entry, RobotGroup):
                yield Fault((*where, "start"), f"missing; needed: {region}")
            else:
                message = "missing; needed: [m, m, rad] start x, y and heading, or"
                yield Fault((*where, "pose"), f"{message} {region}")
        if isinstance(entry, RobotGroup):
            for key in ("footprint", "path"):
                one, several = getattr(entry, key), getattr(entry, f"{key}s")
                if one is not None and several is not None:
                    message = f"given beside {key}; a group has one of them, not both"
                    yield Fault((*where, f"{key}s"), message)
                elif one is None and several is None:
                    message = f"missing; needed: {key}, or a list of {key}s"
                    yield Fault((*where, key), message)
        limit = entry.limits.omega
        for k, omega in enumerate(entry.omegas or ()):
            if abs(omega) > limit:  # it could never be followed
                message = f"{omega!r} rad/s is beyond limits.omega = {limit!r} of this robot"
                yield Fault((*where, "omegas", k), message)
    for where, start in starts:
        if start is not None and start.spread != 1.0 and start.abreast is None:
            message = "has no effect without abreast; add abreast, or leave it out"
            yield Fault((*where, "start", "spread"), message)


def _formation(world: World) -> Iterator[Fault]:
    if world.formation is None:
        return
    low, high = world.formation.limits
    if low > high:
        message = f"least speed {low!r} m/s above the greatest, {high!r}; write [least, greatest]"
        yield Fault(("formation", "limits"), message)
    leads, where = world.formation.spacing, ("formation", "spacing")
    if isinstance(leads, str):
        return
    if len(leads) != (count := world.robot_count):
        message = f"{len(leads)} leads for {count} robots"
        yield Fault(where, f"{message}; give one lead [m] per robot, or the word initial")
    elif leads[0] != 0.0:
        message = f"{leads[0]!r} m; the lead of the first robot is 0 by definition"
        yield Fault((*where, 0), message)


def _neighbours(world: World) -> Iterator[Fault]:
    pairs = world.formation.neighbours if world.formation is not None else ()
    if isinstance(pairs, str):
        return
    names = [name for _, name in _robot_names(world)]
    known, seen = set(names), set()
    for k, pair in enumerate(pairs):
        where: Location = ("formation", "neighbours", k)
        for m, name in enumerate(pair):
            if name not in known:
                there = ", ".join(names[:5]) + (", …" if len(names) > 5 else "")
                message = f"no robot has the name {describe(name)}; there are {there}"
                yield Fault((*where, m), message + nearest(name, names))
        if pair[0] == pair[1]:
            yield Fault(where, f"{describe(pair[0])} cannot be its own neighbour")
        elif frozenset(pair) in seen:
            yield Fault(where, "this pair is given twice")
        seen.add(frozenset(pair))


def _distinct(world: World) -> Iterator[Fault]:
    """Two neighbours at one place leave a polyline without direction there."""
    corridor, lines = world.corridor, list[tuple[Location, Sequence[Point]]]()
    if corridor is not None and not isinstance(corridor, RandomCorridor):
        lines.append((("corridor", "centreline"), corridor.centreline))
    if world.reference_path is not None:
        lines.append((("reference_path",), world.reference_path))
    lines += [(("boundaries", i), line) for i, line in enumerate(world.boundaries or ())]
    for where, line in (*lines, *_paths(world)):
        for k, (a, b) in enumerate(pairwise(line), start=1):
            if math.dist(a, b) <= LENGTH:
                yield Fault((*where, k), "repeats the point before it; leave one of them out")


def _paths(world: World) -> Iterator[tuple[Location, Sequence[Point]]]:
    """Paths of robots that are written as waypoints."""
    for e, entry in enumerate(world.robots):
        several = (entry.paths or ()) if isinstance(entry, RobotGroup) else ()
        places: list[Location] = [("paths", k) for k in range(len(several))]
        for place, path in zip([("path",), *places], [entry.path, *several], strict=True):
            if path is not None and not isinstance(path, Offset):
                yield ("robots", e, *place), path


def _expected(world: World) -> Iterator[Fault]:
    """Bounds of one distance that no run can keep both."""
    least, most = (getattr(world.expect, key, None) for key in ("min_distance", "max_distance"))
    if least is not None and most is not None and least > most:
        message = f"{least!r} m is more than max_distance, {most!r} m; no distance is both"
        yield Fault(("expect", "min_distance"), message)


def _road(world: World) -> Iterator[Fault]:
    """Faults of a road that the seed draws, and of what cannot stand beside one."""
    corridor = world.corridor
    if not isinstance(corridor, RandomCorridor):
        return
    for fault in _of_road(corridor.random):
        yield Fault(("corridor", "random", *fault.location), fault.message)
    if world.reference_path is not None:
        message = "given beside corridor.random, which draws its own; leave it out"
        yield Fault(("reference_path",), message)
    if world.obstacles:
        message = "given beside corridor.random, which draws its own (clutter); leave them out"
        yield Fault(("obstacles",), message)
    for where, _ in _paths(world):
        message = "waypoints on a road that the seed draws; give {offset} from the middle of its"
        yield Fault(where, f"{message} passage, left positive")


def _of_road(road: RandomRoad) -> Iterator[Fault]:
    wrong = False
    for key in ("bends", "turns", "radii", "width", "sizes"):
        span = getattr(road, key)
        if isinstance(span, tuple) and span[0] > span[1]:
            wrong = True
            message = f"least {span[0]!r} above the greatest, {span[1]!r}; write [least, greatest]"
            yield Fault((key,), message)
    if wrong:
        return
    narrowest, width = road.widths
    radius, between = road.bend_radii[0], road.length - 2.0 * road.ends
    if road.passage is not None and road.passage > narrowest:
        message = f"{road.passage!r} m is wider than the road, which may be {narrowest!r} m wide"
        yield Fault(("passage",), message)
    if radius < (least := 0.5 * width + ROOM_IN_BENDS):
        default = ", as no radii are given" if road.radii is None else ""
        message = (
            f"bends have a radius from {radius:.6g} m on{default}; a road {width:.6g} m wide needs "
            f"at least {least:.6g} m: half its width and {ROOM_IN_BENDS:g} m"
        )
        yield Fault(("width" if road.radii is None else "radii",), message)
    needed = road.most_bends * radius * road.turns[0]
    if between < 0.0:
        message = f"{road.length!r} m is shorter than its two ends of {road.ends!r} m"
        yield Fault(("length",), message)
    elif needed > between:
        message = (
            f"{road.most_bends} bends of {radius:.6g} m radius and {road.turns[0]:.6g} rad take at "
            f"least {needed:.6g} m; the road has {between:.6g} m between its ends"
        )
        yield Fault(("bends",), message)
