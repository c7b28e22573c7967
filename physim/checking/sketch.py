"""What can be made out of a world's values, valid or not: its sound parts, as arrays.

A world with a fault in one place is no `World`; the rest of it is looked at all the same, so that
all faults arrive at once. What cannot be read stands as None, and the model says why.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import hypot
from typing import Any

import numpy as np

from physim.errors import Location
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world import Corridor, Formation, Limits
from physim.world.kinds import LARGEST_COORDINATE, MOST_CORNERS, MOST_POINTS

MOST_PARTS = 10_000
"""Robots, boundaries or obstacles; more are refused by the model and not looked at here."""


@dataclass(frozen=True)
class RobotSketch:
    """What is known of Robot ``number``."""

    number: int
    name: str
    outline: FloatArray | None
    """(n, 2) [m], robot's frame, neighbours distinct"""
    position: tuple[float, float] | None
    """[m] at the start"""
    heading: float | None
    """[rad]; None where the seed draws it, or where ``position`` is None"""
    path: FloatArray | None
    """(n, 2) [m] waypoints, neighbours distinct"""
    offset: float | None
    """[m] from the reference path, where the path is given so"""
    v: float | None
    """[m/s] limit"""
    omega: float | None
    """[rad/s] limit"""
    drawn: float | None = None
    """[rad] heading of a robot that the seed has placed in a region"""


@dataclass(frozen=True)
class Sketch:
    """What is known of a world."""

    seed: int
    step: float | None
    """[s]"""
    duration: float | None
    """[s]"""
    centreline: FloatArray | None
    width: FloatArray | None
    """(n,) [m], one per point of the centreline"""
    is_width_listed: bool
    """whether the world gives one width per point"""
    end_margin: float | None
    """[m]"""
    boundaries: tuple[FloatArray | None, ...] | None
    """as drawn; None in a world with a corridor"""
    obstacles: tuple[FloatArray | None, ...]
    reference: FloatArray | None
    reference_key: Location
    """where the reference path stands"""
    robots: tuple[RobotSketch, ...]
    regions: tuple[tuple[Location, FloatArray], ...]
    """start regions in which the seed places robots"""
    leads: FloatArray | None
    """(N,) [m] wanted lead of each robot over the first, where the world lists them"""
    is_spacing_initial: bool
    has_formation: bool
    speed: float
    """[m/s] at which the robots move when in formation, or by themselves without one"""
    is_finish_expected: bool


def sketch_of(values: Mapping[str, Any]) -> Sketch:
    """Read what can be read of the values of a world."""
    time, corridor = _mapping(values, "time"), _mapping(values, "corridor")
    centreline, at = _polyline(corridor.get("centreline"))
    reference_key: Location = ("corridor", "centreline")
    reference = centreline
    if "reference_path" in values:
        reference_key, (reference, _) = ("reference_path",), _polyline(values["reference_path"])
    drawn = values.get("boundaries")
    robots = _entries(values.get("robots"))
    names = _names(robots)
    formation = _mapping(values, "formation")
    has_formation = "formation" in values
    speed = number(formation.get("speed", _default(Formation, "speed")), 1e-9, 1000.0)
    seed = values.get("seed", 0)
    return Sketch(
        seed=seed if type(seed) is int and seed >= 0 else 0,
        step=number(time.get("step"), 1e-12, 10.0),
        duration=number(time.get("duration"), 1e-12, 1e8),
        centreline=centreline,
        width=_widths(corridor.get("width"), corridor.get("centreline"), at),
        is_width_listed=isinstance(corridor.get("width"), list),
        end_margin=number(corridor.get("end_margin", _default(Corridor, "end_margin")), 1e-9, 1e6),
        boundaries=(
            tuple(_polyline(line)[0] for line in _entries(drawn))
            if "boundaries" in values
            else None
        ),
        obstacles=tuple(_ring(ring) for ring in _entries(values.get("obstacles"))),
        reference=reference,
        reference_key=reference_key,
        robots=tuple(_robot(i, robot, names[i]) for i, robot in enumerate(robots)),
        regions=tuple(_regions(values, robots)),
        leads=_leads(formation.get("spacing"), len(robots)),
        is_spacing_initial=formation.get("spacing", "initial") == "initial",
        has_formation=has_formation,
        speed=speed if has_formation and speed is not None else 1.0,
        is_finish_expected=_mapping(values, "expect").get("finished") is True,
    )


def number(value: Any, low: float, high: float) -> float | None:
    """Return a number between bounds, or None for everything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if low <= value <= high else None


def _mapping(holder: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = holder.get(key)
    return value if isinstance(value, Mapping) else {}


def _entries(value: Any) -> list[Any]:
    return value if isinstance(value, list) and len(value) <= MOST_PARTS else []


def _default(model: Any, key: str) -> Any:
    return model.model_fields[key].default


def _points(value: Any, least: int, most: int) -> FloatArray | None:
    """Points (n, 2) [m], or None unless every entry is one."""
    if not isinstance(value, list) or not least <= len(value) <= most:
        return None
    for point in value:
        if not isinstance(point, list) or len(point) != 2:
            return None
        if any(number(c, -LARGEST_COORDINATE, LARGEST_COORDINATE) is None for c in point):
            return None
    return np.array(value, dtype=np.float64)


def _polyline(value: Any) -> tuple[FloatArray | None, list[int]]:
    """Waypoints without repeated neighbours, and the place of each in the file."""
    points = _points(value, 2, MOST_POINTS)
    if points is None:
        return None, []
    kept = [0]
    for k in range(1, len(points)):
        if hypot(*(points[k] - points[kept[-1]])) > LENGTH:
            kept.append(k)
    return (points[kept], kept) if len(kept) > 1 else (None, [])


def _ring(value: Any) -> FloatArray | None:
    points = _points(value, 3, MOST_CORNERS)
    if points is not None and len(points) > 3 and (points[0] == points[-1]).all():
        return points[:-1]
    return points


def _widths(value: Any, centreline: Any, kept: list[int]) -> FloatArray | None:
    if not kept:
        return None
    if not isinstance(value, list):
        width = number(value, LENGTH, LARGEST_COORDINATE)
        return None if width is None else np.full(len(kept), width)
    widths = [number(width, LENGTH, LARGEST_COORDINATE) for width in value]
    if len(widths) != len(centreline) or None in widths:
        return None
    return np.array(widths, dtype=np.float64)[kept]


def _names(robots: list[Any]) -> list[str]:
    """Names of the robots; ``robots[2]`` where one is missing or not the only one of its kind."""
    given = [robot.get("name") if isinstance(robot, Mapping) else None for robot in robots]
    count = Counter(name for name in given if isinstance(name, str))
    return [
        name if isinstance(name, str) and name and count[name] == 1 else f"robots[{i}]"
        for i, name in enumerate(given)
    ]


def _regions(values: Mapping[str, Any], robots: list[Any]) -> Iterator[tuple[Location, FloatArray]]:
    holders: list[tuple[Location, Any]] = [((), values)]
    holders += [(("robots", i), robot) for i, robot in enumerate(robots)]
    for where, holder in holders:
        start = holder.get("start") if isinstance(holder, Mapping) else None
        region = _ring(start.get("region")) if isinstance(start, Mapping) else None
        if region is not None:
            yield (*where, "start", "region"), region


def _robot(i: int, given: Any, name: str) -> RobotSketch:
    robot = given if isinstance(given, Mapping) else {}
    pose, path, limits = robot.get("pose"), robot.get("path"), robot.get("limits", {})
    position, heading = _pose(pose)
    known: Mapping[str, Any] = limits if isinstance(limits, Mapping) else {"v": None, "omega": None}
    offset = path.get("offset") if isinstance(path, Mapping) and len(path) == 1 else None
    return RobotSketch(
        number=i,
        name=name,
        outline=_outline(robot.get("footprint")),
        position=position,
        heading=heading,
        path=_polyline(path)[0],
        offset=number(offset, -1e6, 1e6),
        v=number(known.get("v", _default(Limits, "v")), 1e-12, 1000.0),
        omega=number(known.get("omega", _default(Limits, "omega")), 1e-12, 1000.0),
    )


def _outline(value: Any) -> FloatArray | None:
    if not isinstance(value, Mapping):
        return _ring(value)
    length, width = (number(value.get(key), 1e-12, 1000.0) for key in ("length", "width"))
    if length is None or width is None or len(value) != 2:
        return None
    x, y = 0.5 * length, 0.5 * width
    return np.array([(-x, -y), (x, -y), (x, y), (-x, y)])


def _pose(value: Any) -> tuple[tuple[float, float] | None, float | None]:
    if not isinstance(value, list) or len(value) != 3:
        return None, None
    x, y = (number(c, -LARGEST_COORDINATE, LARGEST_COORDINATE) for c in value[:2])
    heading = number(value[2], -1000.0, 1000.0)
    if x is None or y is None or (heading is None and value[2] != "random"):
        return None, None
    return (x, y), heading


def _leads(value: Any, robots: int) -> FloatArray | None:
    if not isinstance(value, list) or len(value) != robots or not robots:
        return None
    leads = [number(lead, -1e6, 1e6) for lead in value]
    return None if None in leads else np.array(leads, dtype=np.float64)
