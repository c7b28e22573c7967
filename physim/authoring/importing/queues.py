"""Robots whose paths end in one place: in which order they come there, how far apart they stop."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf
from typing import Any

import numpy as np
import shapely

from physim.authoring.importing.fit import Fit
from physim.authoring.importing.lines import Pose, is_closed, length_of, pose_at, station_of
from physim.authoring.importing.placed import Placed, shape_at
from physim.authoring.importing.stops import WAITING
from physim.authoring.importing.way import Way
from physim.errors import plural
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH

GAP = 1.1
"""[m] at size 1 between robots that stop one behind the other, nearer than which they are in danger
mode"""

BESIDE = 0.5
"""[m] at size 1 between robots that stop beside one another; nearer they are in danger mode"""
STEP, MOST_STEPS = 0.1, 400
"""[m] at size 1 by which a robot stops earlier until it is clear of others, and how many at most"""
MOST_TOLD = 3
"""Pairs of robots of a queue of which it is told that either may come first"""
UNSURE = 1.5
"""[-] times what is kept between two, by which one is farther away if it is known to come later"""

Group = tuple[FloatArray, list[Placed]]
"""A path (n, 2) [m], and the robots on it or beside it"""


def queues_of(groups: list[Group], found: Fit) -> list[list[Group]]:
    """The groups on open paths, those together whose paths end within what a robot takes there."""
    queues: list[list[Group]] = []
    for line, some in groups:
        if not some or is_closed(line):
            continue
        near = [
            queue
            for queue in queues
            if any(
                hypot(*(path[-1] - line[-1])) < _apart(_longest(some), _longest(others), found)
                for path, others in queue
            )
        ]
        queues = [queue for queue in queues if not any(queue is one for one in near)]
        queues.append([*(group for queue in near for group in queue), (line, some)])
    return queues


def stations(line: FloatArray, robots: list[Placed]) -> FloatArray:
    """(k,) [m] of a path at which robots start."""
    return np.array([station_of(line, np.array(one.pose[:2])) for one in robots])


@dataclass(frozen=True)
class _Stop:
    """Where a robot of a queue stops."""

    robot: Placed
    group: int
    to_go: float
    """[m] from its start to the end of the path of its group"""
    lag: float
    """[m] before the end of its path"""
    place: FloatArray
    """(2,) [m]"""
    outline: Any


def queue_up(queue: list[Group], found: Fit) -> tuple[dict[str, float], list[str]]:
    """How far [m] before the ends of their paths the robots of a queue stop, by name.

    In the order in which they come: as far behind those on the same path as they start, as a
    formation has it; a robot and a gap behind those on others in whose way they would stop. And
    what is said of two of which it is not known who comes first.
    """
    stops, unsure = list[_Stop](), list[tuple[_Stop, float, str]]()
    for to_go, name, k, robot in _in_order(queue):
        lag = max((one.lag + to_go - one.to_go for one in stops if one.group == k), default=0.0)
        met = _in_the_way(robot, [one for one in stops if one.group != k], found)
        lag = max([lag, *(behind for _, behind in met)])
        last = max((other for other, _ in met), key=lambda one: one.to_go, default=None)
        if last and to_go - last.to_go < UNSURE * _apart(robot, last.robot, found):
            unsure.append((last, to_go, name))
        beside = [one.outline for one in stops if one.group != k]
        lag, pose = _clear_of(robot, lag, beside, found)
        stops.append(
            _Stop(robot, k, to_go, lag, np.array(pose[:2]), shape_at(robot.footprint, pose))
        )
    return {one.robot.name: one.lag for one in stops}, _of_order(unsure)


def _of_order(unsure: list[tuple[_Stop, float, str]]) -> list[str]:
    """What is told of robots that have about as far to go as the one behind which they stop."""
    told = [
        f"note: {first.robot.name} and {name} have {first.to_go:.2f} and {to_go:.2f} m to go to "
        "one end: they may touch where their paths meet, or come in the other order, in which "
        f"{first.robot.name} would wait for ever behind {name}; draw one of them farther away"
        for first, to_go, name in unsure[:MOST_TOLD]
    ]
    left = len(unsure) - MOST_TOLD
    return [*told, f"note: and so for {plural(left, 'more pair')}"] if left > 0 else told


def _in_the_way(robot: Placed, others: list[_Stop], found: Fit) -> list[tuple[_Stop, float]]:
    """Which of the others stand on the last of a robot's path, or just ahead of its end.

    And how far [m] before its end it stops for that.
    """
    if not others:
        return []
    length, ahead = length_of(robot.path), robot.path[-1] - robot.path[-2]
    most = max(_apart(robot, one.robot, found) for one in others)
    way = Way(np.vstack([robot.path, robot.path[-1] + most / hypot(*ahead) * ahead]))
    reach = 0.5 * float(_extents(robot)[1]) + BESIDE * found.size
    outlines = np.array([one.outline for one in others])
    places = np.array([one.place for one in others])
    last, met = dict[int, float](), dict[int, float]()
    passed = zip(*way.beside(outlines, places, reach - LENGTH), strict=True)
    for j, station, _ in sorted(passed, reverse=True):
        need = _apart(robot, others[j].robot, found)
        if last.setdefault(j, station) - station < 2.0 * need:  # where it passes there last
            away = hypot(*(way.at(np.array([station]))[0][0] - places[j]))
            met[j] = max(length - float(station) + need - away, met.get(j, 0.0))
    return [(others[j], behind) for j, behind in met.items() if behind > 0.0]


def _clear_of(robot: Placed, lag: float, others: list[Any], found: Fit) -> tuple[float, Pose]:
    """How far [m] before its end a robot stops, ``lag`` at least, clear of the others; its pose.

    Where it is nowhere so the lag is what it was.
    """
    end = length_of(robot.path)

    def pose(behind: float) -> Pose:
        return pose_at(robot.path, max(end - behind, 0.0), found.size)

    def gap(behind: float) -> float:
        outline = shape_at(robot.footprint, pose(behind))
        return min((float(outline.distance(one)) for one in others), default=inf)

    step = STEP * found.size
    if gap(lag) < BESIDE * found.size:
        for behind in lag + step * np.arange(min(MOST_STEPS, int((end - lag) / step))):
            if gap(float(behind)) >= WAITING * found.size:
                return float(behind), pose(float(behind))
    return lag, pose(lag)


def first_of(queue: list[Group]) -> str:
    """Name of the robot that comes first."""
    return _in_order(queue)[0][1]


def _in_order(queue: list[Group]) -> list[tuple[float, str, int, Placed]]:
    """How far [m] robots are from the ends of their paths, with names, groups and themselves."""
    return sorted(
        (
            (length_of(line) - float(station), one.name, k, one)
            for k, (line, some) in enumerate(queue)
            for one, station in zip(some, stations(line, some), strict=True)
        ),
        key=lambda one: one[:3],
    )


def own_outline(robot: Placed) -> FloatArray:
    """(n, 2) [m] of its footprint, in its own frame."""
    return np.asarray(shapely.get_coordinates(shape_at(robot.footprint, (0.0, 0.0, 0.0))))


def _extents(robot: Placed) -> FloatArray:
    """(2,) [m] of its footprint, along and across its heading."""
    return np.asarray(np.ptp(own_outline(robot), axis=0))


def _longest(robots: list[Placed]) -> Placed:
    return max(robots, key=lambda one: float(_extents(one)[0]))


def _apart(one: Placed, other: Placed, found: Fit) -> float:
    """[m] from one robot to another behind which it stops."""
    return 0.5 * float(_extents(one)[0] + _extents(other)[0]) + GAP * found.size
