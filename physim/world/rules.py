"""Faults that lie between several values of a world: counts, names, times.

The rules read the values as they were given, valid or not, and pass over what they cannot read:
so they speak together with the faults of single values, and all arrive at once.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice, pairwise
from typing import Any

from physim.errors import Fault, nearest
from physim.tolerances import LENGTH, WHOLE_STEPS
from physim.world.faults import describe
from physim.world.group import NUMBER, RobotGroup, is_group, numbered
from physim.world.kinds import MOST_ROBOTS, plain
from physim.world.road import is_random_corridor
from physim.world.road_rules import road_faults
from physim.world.robot import OMEGA_LIMIT

MOST_STEPS = 100_000_000
PLACES = ["pose", "start"]
USUAL_NAME: str = RobotGroup.model_fields["name"].default
WALL_NAMES = re.compile(r"(?:left|right) wall|(?:start|end) cap|(?:boundary|obstacle) [0-9]+")
"""Names of boundaries and obstacles, which no robot may have"""


def cross_faults(data: Mapping[str, Any]) -> list[Fault]:
    """Every fault between values of ``data``, the raw values of a `World`."""
    rules = (
        _time, _walls, _width, _names, _starts, _spread, _shapes, _omegas, _formation, _spacing,
        _neighbours, _distinct, _expected, road_faults,
    )  # fmt: skip
    return [fault for rule in rules for fault in rule(data)]


def _get(holder: Any, key: str) -> Any:
    """Value of ``key`` in a mapping or of that attribute of a model; None when there is none."""
    if isinstance(holder, Mapping):
        return plain(holder.get(key))
    return plain(getattr(holder, key, None))


def _list(holder: Any, key: str) -> Sequence[Any] | None:
    value = _get(holder, key)
    return value if isinstance(value, list | tuple) else None


def _number(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if abs(value) < 1e300 else None


def _time(data: Mapping[str, Any]) -> Iterator[Fault]:
    step = _number(_get(_get(data, "time"), "step"))
    duration = _number(_get(_get(data, "time"), "duration"))
    if step is None or duration is None or step <= 0.0 or duration <= 0.0:
        return
    where = ("time", "duration")
    if step > duration:
        yield Fault(
            ("time", "step"),
            f"{step!r} s is longer than the duration, {duration!r} s; it must be at most that",
        )
        return
    ratio = duration / step
    steps = round(ratio) if ratio < 1e15 else MOST_STEPS + 1
    if steps > MOST_STEPS:
        yield Fault(where, f"{ratio:.4g} steps of {step!r} s; at most {MOST_STEPS} are allowed")
    elif abs(ratio - steps) > WHOLE_STEPS * max(1.0, ratio):
        below, above = int(ratio) * step, (int(ratio) + 1) * step
        yield Fault(
            where,
            f"{duration!r} s is not a whole number of steps of {step!r} s; "
            f"nearest are {below:.12g} and {above:.12g}",
        )


def _walls(data: Mapping[str, Any]) -> Iterator[Fault]:
    corridor, boundaries = _get(data, "corridor"), _get(data, "boundaries")
    if corridor is None and boundaries is None:
        if _misspelt(data, ["corridor", "boundaries"]):
            return
        yield Fault((), "neither corridor nor boundaries; a world needs one of them")
    elif corridor is not None and boundaries is not None:
        yield Fault(("boundaries",), "given beside corridor; a world has one of them, not both")
    elif corridor is None and _get(data, "reference_path") is None:
        yield Fault(("reference_path",), "missing; a world with boundaries must give it [m]")


def _width(data: Mapping[str, Any]) -> Iterator[Fault]:
    corridor = _get(data, "corridor")
    if is_random_corridor(corridor):
        return
    widths, points = _list(corridor, "width"), _list(corridor, "centreline")
    if widths is not None and points is not None and len(widths) != len(points):
        yield Fault(
            ("corridor", "width"),
            f"{len(widths)} widths for {len(points)} points of the centreline; "
            "give one number, or one per point",
        )


def _given_names(data: Mapping[str, Any]) -> Iterator[tuple[int, str | None]]:
    """Number of the entry and name of each robot, one by one; None for what is no name."""
    return islice(_all_names(data), MOST_ROBOTS)


def _all_names(data: Mapping[str, Any]) -> Iterator[tuple[int, str | None]]:
    number = 0
    for i, robot in enumerate(_list(data, "robots") or ()):
        name = _get(robot, "name")
        name = name if isinstance(name, str) else None
        if not is_group(robot):
            yield i, name
            number += 1
            continue
        pattern = USUAL_NAME if _get(robot, "name") is None else name
        count = _get(robot, "count")
        for _ in range(count if isinstance(count, int) else 0):
            yield i, None if pattern is None or NUMBER not in pattern else numbered(pattern, number)
            number += 1


def _names(data: Mapping[str, Any]) -> Iterator[Fault]:
    first: dict[str, int] = {}
    told: set[int] = set()
    for i, name in _given_names(data):
        if name is None or i in told:
            continue
        if name in first:
            told.add(i)
            yield Fault(
                ("robots", i, "name"),
                f"{describe(name)} is the name of robots[{first[name]}] too; names must differ",
            )
        first.setdefault(name, i)
        if WALL_NAMES.fullmatch(name):
            told.add(i)
            yield Fault(
                ("robots", i, "name"),
                f"{describe(name)} names a wall in reports; give the robot another name",
            )


def _starts(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Every robot has one place: a pose, or a region of its own or of the world."""
    shared = _get(data, "start") is not None or _misspelt(data, ["start"])
    for i, robot in enumerate(_list(data, "robots") or ()):
        if not isinstance(robot, Mapping) and not hasattr(robot, "pose"):
            continue
        pose = None if is_group(robot) else _get(robot, "pose")
        start = _get(robot, "start")
        if pose is not None and start is not None:
            yield Fault(("robots", i, "start"), "given beside pose; a robot has one of them")
        elif (pose, start) == (None, None) and not shared and not _misspelt(robot, PLACES):
            if is_group(robot):
                yield Fault(
                    ("robots", i, "start"),
                    "missing; needed: a start region, here or for the whole world",
                )
                continue
            yield Fault(
                ("robots", i, "pose"),
                "missing; needed: [m, m, rad] start x, y and heading, or a start region, here or "
                "for the whole world",
            )


def _spread(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Without rows there are no cells to spread within."""
    places = [
        ((), data),
        *((("robots", i), one) for i, one in enumerate(_list(data, "robots") or ())),
    ]
    for where, holder in places:
        start = _get(holder, "start")
        if _get(start, "spread") not in (None, 1.0) and _get(start, "abreast") is None:
            message = "has no effect without abreast; add abreast, or leave it out"
            yield Fault((*where, "start", "spread"), message)


def _misspelt(holder: Any, keys: list[str]) -> bool:
    """Whether a mapping holds one of ``keys`` misspelt, which is a fault of its own."""
    given = holder if isinstance(holder, Mapping) else {}
    return any(nearest(str(key).lower(), keys) for key in given if key not in keys)


def _shapes(data: Mapping[str, Any]) -> Iterator[Fault]:
    """A group has one footprint or a list of them, and likewise paths."""
    for i, group in enumerate(_list(data, "robots") or ()):
        for one in ("footprint", "path") if is_group(group) else ():
            several = f"{one}s"
            is_one, are_several = (_get(group, key) is not None for key in (one, several))
            if is_one and are_several:
                yield Fault(
                    ("robots", i, several), f"given beside {one}; a group has one of them, not both"
                )
            elif not is_one and not are_several and not _misspelt(group, [one, several]):
                yield Fault(("robots", i, one), f"missing; needed: {one}, or a list of {several}")


def _omegas(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Candidate speeds beyond the robot's own limits could never be followed."""
    for i, robot in enumerate(_list(data, "robots") or ()):
        limits = _get(robot, "limits")
        limit = _number(_get(limits, "omega")) if limits is not None else None
        limit = OMEGA_LIMIT if limit is None else limit
        for k, value in enumerate(_list(robot, "omegas") or ()):
            number = _number(value)
            if number is not None and abs(number) > limit:
                in_degrees = (
                    f"; if degrees per second are meant, write {math.radians(number):.5g}"
                    if abs(number) > 2.0 * math.pi
                    else ""
                )
                yield Fault(
                    ("robots", i, "omegas", k),
                    f"{number!r} rad/s is beyond limits.omega = {limit!r} of this robot"
                    f"{in_degrees}",
                )


def _formation(data: Mapping[str, Any]) -> Iterator[Fault]:
    limits = _list(_get(data, "formation"), "limits")
    if limits is None or len(limits) != 2:
        return
    low, high = (_number(value) for value in limits)
    if low is not None and high is not None and low > high:
        yield Fault(
            ("formation", "limits"),
            f"least speed {low!r} m/s above the greatest, {high!r}; write [least, greatest]",
        )


def _spacing(data: Mapping[str, Any]) -> Iterator[Fault]:
    leads = _list(_get(data, "formation"), "spacing")
    if leads is None or _list(data, "robots") is None:
        return
    where, robots = ("formation", "spacing"), sum(1 for _ in _given_names(data))
    if len(leads) != robots:
        yield Fault(
            where,
            f"{len(leads)} leads for {robots} robots; "
            "give one lead [m] per robot, or the word initial",
        )
    elif _number(leads[0]) not in (None, 0.0):
        yield Fault((*where, 0), f"{leads[0]!r} m; the lead of the first robot is 0 by definition")


def _neighbours(data: Mapping[str, Any]) -> Iterator[Fault]:
    pairs = _list(_get(data, "formation"), "neighbours")
    names = [name for _, name in _given_names(data) if name is not None] if pairs else []
    known, seen = set(names), set()
    if not known:
        return
    for k, pair in enumerate(pairs or ()):
        if not isinstance(pair, list | tuple) or len(pair) != 2:
            continue
        where = ("formation", "neighbours", k)
        for m, name in enumerate(pair):
            if isinstance(name, str) and name not in known:
                there = ", ".join(names[:5]) + (", …" if len(names) > 5 else "")
                near = nearest(name[:100], names)
                yield Fault(
                    (*where, m), f"no robot has the name {describe(name)}; there are {there}{near}"
                )
        if pair[0] == pair[1]:
            yield Fault(where, f"{describe(pair[0])} cannot be its own neighbour")
        elif all(isinstance(name, str) for name in pair):
            if frozenset(pair) in seen:
                yield Fault(where, "this pair is given twice")
            seen.add(frozenset(pair))


def _distinct(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Two neighbours at one place leave a polyline without direction there."""
    for where, line in _polylines(data):
        points = [_point(point) for point in line]
        for k, (a, b) in enumerate(pairwise(points), start=1):
            if a is not None and b is not None and math.dist(a, b) <= LENGTH:
                yield Fault((*where, k), "repeats the point before it; leave one of them out")


def _expected(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Bounds of one distance that no run can keep both."""
    expect = _get(data, "expect")
    least, most = (_number(_get(expect, key)) for key in ("min_distance", "max_distance"))
    if least is not None and most is not None and least > most >= 0.0:
        yield Fault(
            ("expect", "min_distance"),
            f"{least!r} m is more than max_distance, {most!r} m; no distance between two robots "
            "is both",
        )


def _point(value: Any) -> tuple[float, float] | None:
    if not isinstance(value, list | tuple) or len(value) != 2:
        return None
    x, y = _number(value[0]), _number(value[1])
    return None if x is None or y is None else (x, y)


def _polylines(data: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], Sequence[Any]]]:
    corridor = _get(data, "corridor")
    if (line := _list(corridor, "centreline")) is not None:
        yield ("corridor", "centreline"), line
    if (line := _list(data, "reference_path")) is not None:
        yield ("reference_path",), line
    for i, boundary in enumerate(_list(data, "boundaries") or ()):
        if isinstance(boundary, list | tuple):
            yield ("boundaries", i), boundary
    for i, robot in enumerate(_list(data, "robots") or ()):
        if (line := _list(robot, "path")) is not None:
            yield ("robots", i, "path"), line
        for m, line in enumerate(_list(robot, "paths") or ()):
            if isinstance(line, list | tuple):
                yield ("robots", i, "paths", m), line
