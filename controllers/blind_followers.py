"""Robots that follow each other where the one behind does not see the one before it.

Priority goes by stations along the reference path: a robot looks out for those ahead along it. On a
way against the reference path, or on one where stations stay the same, as beyond its ends or at a
right angle to it, the one that drives behind is ahead, or neither is.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import hypot
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from physim.errors import Fault
from physim.geometry.shapes import FloatArray, IntArray

from .settings import ModeSwitchingSettings

if TYPE_CHECKING:
    from physim.world import Robot, World

MOST_LOOKED_AT = 200
"""Robots with points of their own as a path that are looked at"""
MOST_BLIND = 12
"""of them with such a stretch whose paths are held against each other"""
MOST_PLACES = 400
"""of one path that are looked at, half a width apart"""
AT_ONCE = 500_000
"""Places times segments that are looked at in one go, which bounds memory"""
FOLLOWED = 2
"""Widths of a robot along which another's path is its own, if that is told"""
LEAP = 2
"""Places between which a station may fall, as at the joint of a closed path"""
LEAD = 0.01
"""[-] share of a way by which the station has to grow along it"""


def sense_doubts(settings: ModeSwitchingSettings, world: World) -> list[Fault]:
    """Warn of the first two robots of which the one behind would not see the one before it."""
    if settings.avoidance == "none" or not world.reference:
        return []
    reference = np.array(world.reference)
    ways: list[tuple[int, float, FloatArray, list[FloatArray]]] = []
    looked_at = [i for i, one in enumerate(world.robots) if isinstance(one.path, Sequence)]
    for i in looked_at[:MOST_LOOKED_AT]:
        robot = world.robots[i]
        width = 2.0 * max(hypot(x, y) for x, y in robot.outline)
        line = _way(robot)
        stretches = _blind_stretches(line, reference, width)
        for k, other_width, other, others in ways:
            if any(
                _follows(one, with_it, max(width, other_width))
                for one, with_it in (*((s, other) for s in stretches), *((s, line) for s in others))
            ):
                return [_doubt(world, k, i)]
        if stretches and len(ways) < MOST_BLIND:
            ways.append((i, width, line, stretches))
    return []


def _doubt(world: World, k: int, i: int) -> Fault:
    message = (
        f'"{world.robots[k].name}" and "{world.robots[i].name}" drive the same way against the '
        "reference path, across it or beyond its ends; by stations along it this controller "
        "settles who looks out for whom: the one behind does not see the one before it; lead the "
        "reference path their way, if others do not need it more"
    )
    return Fault((*world.entry_of(k), "path"), message)


def _way(robot: Robot) -> FloatArray:
    """Path (n, 2) [m] of a robot from where it starts, as far as that is written."""
    path = np.array(robot.path, dtype=np.float64)
    if robot.pose is None:
        return path
    (station,), _ = nearest(path, np.array([robot.pose[:2]]))
    own = _stations(path)
    begin = [np.interp(station, own, path[:, k]) for k in (0, 1)]
    return np.vstack([begin, path[own > station]])


def _stations(line: FloatArray) -> FloatArray:
    return np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))


def _blind_stretches(line: FloatArray, reference: FloatArray, width: float) -> list[FloatArray]:
    """Places (n, 2) of the parts of a way, some widths long, along which stations do not grow."""
    own = _stations(line)
    if own[-1] < FOLLOWED * width:
        return []
    at = np.linspace(0.0, own[-1], min(int(2.0 * own[-1] / width) + 2, MOST_PLACES))
    places = np.stack([np.interp(at, own, line[:, k]) for k in (0, 1)], axis=1)
    station, _ = nearest(reference, places)
    grows = np.diff(station) > LEAD * np.diff(at)
    return [
        places[run]
        for run in _runs(~grows)
        if len(run) > LEAP and at[run[-1]] - at[run[0]] >= FOLLOWED * width
    ]


def _runs(steps: NDArray[np.bool_]) -> list[IntArray]:
    """Numbers of the places of each run of steps, from place to place, that are true."""
    ends = np.flatnonzero(np.diff(np.concatenate(([False], steps, [False]))))
    return [np.arange(first, last + 1) for first, last in pairwise(ends)][::2]


def _follows(stretch: FloatArray, other: FloatArray, width: float) -> bool:
    """Whether another's way leads along a stretch (n, 2) of one, nearer than ``width`` [m]."""
    station, away = nearest(other, stretch)
    along = np.hypot(*np.diff(stretch, axis=0).T)
    is_along = (away[:-1] <= width) & (away[1:] <= width) & (np.diff(station) > 0.5 * along)
    return any(along[run[:-1]].sum() >= FOLLOWED * width for run in _runs(is_along))


def nearest(line: FloatArray, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stations (k,) [m] of a line next to places (k, 2), and how far those are; without a kernel,
    which would be loaded with every world."""
    begin, step = line[:-1], np.diff(line, axis=0)
    length = np.maximum(np.hypot(*step.T), np.finfo(np.float64).tiny)
    whole = np.concatenate(([0.0], np.cumsum(length)[:-1]))
    unit = step / length[:, None]
    found = []
    for some in np.array_split(places, max(1, len(places) * len(step) // AT_ONCE)):
        out = some[:, None] - begin
        along = np.clip((out * unit).sum(axis=2), 0.0, length)
        away = np.hypot(*np.moveaxis(out - along[..., None] * unit, 2, 0))
        k = np.argmin(away, axis=1)
        row = np.arange(len(some))
        found.append(np.stack([whole[k] + along[row, k], away[row, k]], axis=1))
    station, far = np.concatenate(found).T
    return station, far
