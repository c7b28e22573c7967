"""Robots whose paths end in one place: in which order they come there, how far apart they stop."""

from __future__ import annotations

from itertools import pairwise
from math import hypot

import numpy as np

from physim.authoring.importing.fit import Fit
from physim.authoring.importing.lines import is_closed, length_of, station_of
from physim.authoring.importing.robots import Placed
from physim.geometry.shapes import FloatArray

GAP = 1.1
"""[m] at size 1 between robots that stop one behind the other, nearer than which they are in danger
mode"""

Group = tuple[FloatArray, list[Placed]]
"""A path (n, 2) [m], and the robots on it or beside it"""


def queues_of(groups: list[Group], found: Fit) -> list[list[Group]]:
    """The groups on open paths, those together whose paths end within a robot's length."""
    queues: list[list[Group]] = []
    for line, some in groups:
        if not some or is_closed(line):
            continue
        for queue in queues:
            if hypot(*(queue[0][0][-1] - line[-1])) <= found.box[0]:
                queue.append((line, some))
                break
        else:
            queues.append([(line, some)])
    return queues


def stations(line: FloatArray, robots: list[Placed]) -> FloatArray:
    """(k,) [m] of a path at which robots start."""
    return np.array([station_of(line, np.array(one.pose[:2])) for one in robots])


def lags(queue: list[Group], found: Fit) -> dict[str, float]:
    """How far [m] before the ends of their paths the robots of a queue stop, by name.

    In the order in which they come: as far behind the one before as they start, if that is on the
    same path, as a formation has it; a robot and a gap behind one on another.
    """
    to_go, lag = _to_go(queue), 0.0
    found_lags = {to_go[0][1]: lag}
    for (before, _, path), (left, name, k) in pairwise(to_go):
        lag += left - before if k == path else _room_for(found)
        found_lags[name] = lag
    return found_lags


def first_of(queue: list[Group]) -> str:
    """Name of the robot that comes first."""
    return _to_go(queue)[0][1]


def order_told(queue: list[Group], found: Fit) -> list[str]:
    """Which two of different paths come to the end of a queue at about the same time; or none."""
    for (before, first, path), (left, name, k) in pairwise(_to_go(queue)):
        if k != path and left - before < _room_for(found):
            ways = f"{first} and {name} have {before:.2f} and {left:.2f} m to go to one end"
            return [
                f"note: {ways}, and may come in the other order, in which {first} would wait for "
                f"ever behind {name}; draw one of them farther away"
            ]
    return []


def _to_go(queue: list[Group]) -> list[tuple[float, str, int]]:
    """How far [m] the robots of groups are from the ends of their paths, with names and groups."""
    return sorted(
        (length_of(line) - float(station), one.name, k)
        for k, (line, some) in enumerate(queue)
        for one, station in zip(some, stations(line, some), strict=True)
    )


def _room_for(found: Fit) -> float:
    """[m] that a robot takes in a queue at the end of a path."""
    return found.box[0] + GAP * found.size
