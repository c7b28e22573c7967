"""Faults between the values of a road that the seed draws, and what cannot stand beside one.

Like `physim.world.rules` they read the values as given, and pass over what they cannot read.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from physim.errors import Fault, Location
from physim.world.kinds import plain
from physim.world.road import is_random_corridor, usual_radii

ROAD: Location = ("corridor", "random")
ROOM_IN_BENDS = 1.0
"""[m] by which the radius of a bend exceeds half the width, so that no wall folds over"""
SPANS = {"bends": "", "turns": " rad", "radii": " m", "width": " m", "sizes": " m"}
"""Keys of a least and a greatest value, with their units"""


def road_faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Every fault between values of ``data``, those of a `World`, if it has a road to be drawn."""
    corridor = value_of(data, "corridor")
    if not is_random_corridor(corridor):
        return
    yield from _own(value_of(corridor, "random"))
    yield from _beside(data)


def value_of(holder: Any, key: str) -> Any:
    """Value of a key in a mapping or a model; None when there is none."""
    value = holder.get(key) if isinstance(holder, Mapping) else getattr(holder, key, None)
    return plain(value)


def _own(road: Any) -> Iterator[Fault]:
    """Faults of the road itself."""
    spans = {key: _span(value_of(road, key)) for key in SPANS}
    reversed_ = {key for key, span in spans.items() if span is not None and span[0] > span[1]}
    for key in reversed_:
        low, high = value_of(road, key)
        unit = SPANS[key]
        yield Fault(
            (*ROAD, key),
            f"least {low!r}{unit} above the greatest, {high!r}{unit}; write [least, greatest]",
        )
    width = None if "width" in reversed_ else spans["width"]
    passage = _number(value_of(road, "passage"))
    if width is not None and passage is not None and passage > width[0]:
        yield Fault(
            (*ROAD, "passage"),
            f"{passage!r} m is wider than the road, which may be {width[0]!r} m wide; at most that "
            "is possible",
        )
    if width is not None and "radii" not in reversed_:
        yield from _radii(spans["radii"], width[1])
    if not reversed_:
        yield from _length(road, spans)


def _radii(given: tuple[float, float] | None, width: float) -> Iterator[Fault]:
    """Bends that are too tight for the width."""
    least = 0.5 * width + ROOM_IN_BENDS
    radii = usual_radii(width) if given is None else given
    if radii[0] < least:
        where, default = ("radii", "")
        if given is None:
            where, default = "width", " when no radii are given"
        yield Fault(
            (*ROAD, where),
            f"bends have a radius from {radii[0]:.6g} m on{default}, and a road {width:.6g} m wide "
            f"needs at least {least:.6g} m: half its width and {ROOM_IN_BENDS:g} m",
        )


def _length(road: Any, spans: Mapping[str, tuple[float, float] | None]) -> Iterator[Fault]:
    """Ends and bends that are longer than the road, at their shortest."""
    length, ends = _number(value_of(road, "length")), _number(value_of(road, "ends"))
    ends = 15.0 if ends is None and value_of(road, "ends") is None else ends
    if length is None or ends is None or min(length, ends) <= 0.0:
        return
    if 2.0 * ends > length:
        yield Fault(
            (*ROAD, "length"),
            f"{length!r} m is shorter than its two ends of {ends!r} m; make it longer, or ends "
            "shorter",
        )
        return
    width, turns = spans["width"], spans["turns"] or (0.35, 1.57)
    bends = spans["bends"] or (3.0, 3.0)
    radii = spans["radii"] or (usual_radii(width[1]) if width is not None else None)
    if radii is None:
        return
    needed = bends[1] * radii[0] * turns[0]
    if needed > length - 2.0 * ends:
        yield Fault(
            (*ROAD, "bends"),
            f"{bends[1]:g} bends of {radii[0]:.6g} m radius and {turns[0]:.6g} rad are "
            f"{needed:.6g} m long at least, and the road has {length - 2.0 * ends:.6g} m "
            "between its ends; give fewer bends, smaller turns or radii, or more length",
        )


def _beside(data: Mapping[str, Any]) -> Iterator[Fault]:
    """What cannot stand beside a road that is not known before it is drawn."""
    if value_of(data, "reference_path") is not None:
        yield Fault(
            ("reference_path",),
            "given beside corridor.random, which draws its own; leave it out",
        )
    if value_of(data, "obstacles"):
        yield Fault(
            ("obstacles",),
            "given beside corridor.random, which draws its own (clutter); leave them out",
        )
    robots = value_of(data, "robots")
    for i, robot in enumerate(robots if isinstance(robots, list | tuple) else ()):
        paths: list[tuple[Location, Any]] = [(("path",), value_of(robot, "path"))]
        several = value_of(robot, "paths")
        if isinstance(several, list | tuple):
            paths += [(("paths", k), path) for k, path in enumerate(several)]
        for where, path in paths:
            if isinstance(plain(path), list | tuple):
                yield Fault(
                    ("robots", i, *where),
                    "waypoints on a road that the seed draws; give {offset} from the middle of its "
                    "passage, left positive",
                )


def _number(value: Any) -> float | None:
    """A number as it is, however it came; None where it is none or none that can be meant."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if abs(value) < 1e9 else None


def _span(value: Any) -> tuple[float, float] | None:
    """Least and greatest of a value that is one number or two."""
    pair = value if isinstance(value, list | tuple) else (value, value)
    numbers = [_number(part) for part in pair]
    if len(numbers) != 2 or numbers[0] is None or numbers[1] is None:
        return None
    return numbers[0], numbers[1]
