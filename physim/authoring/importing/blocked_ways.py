"""Stops in the way of robots that come there later, and would wait there for ever."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from physim.authoring.importing.way import Way
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world.layout.shared import Shared

CLEARLY = 3.0
"""[-] times its half width that a robot is farther away when the one in its way has stopped: about
its length"""

MOST_PLACES = 5_000
"""of a way at which it is looked whether it is that of another robot, and as many of its corners"""


def sides(outline: FloatArray) -> FloatArray:
    """How far (2,) [m] a footprint (n, 2) reaches to the right and to the left of its heading."""
    return np.array([max(-float(outline[:, 1].min()), 0.0), max(float(outline[:, 1].max()), 0.0)])


def blocked_ways(
    paths: Sequence[FloatArray],
    start: FloatArray,
    begin: FloatArray,
    stop: FloatArray,
    speed: FloatArray,
    reach: FloatArray,
    outlines: Sequence[Any],
    clear: float = 0.0,
) -> dict[int, list[int]]:
    """Robots that would find others in their way, stopped before they came there; and which.

    Each of N robots drives along its path (n, 2) [m] from its place ``start`` (N, 2) [m], at
    station ``begin``, to station ``stop`` (N,) [m], at ``speed`` (N,) [m/s], where its footprint is
    one of the ``outlines``. It stands in the way of those that reach ``reach`` (N, 2) [m] to the
    right and left of their paths, and would pass nearer than ``clear`` [m]; if it is there before
    them, for it starts ahead of them on the same way, or, where ways meet, ``CLEARLY``: who is
    first of two that come at about the same time cannot be known.
    """
    ways, shapes = Shared(Way), np.array(outlines)
    places = np.array([ways(path).at(stop[[k]])[0][0] for k, path in enumerate(paths)])
    near = Shared(lambda path: ways(path).beside(shapes, places, float(reach.max()) + clear))
    half = reach.mean(axis=1)
    before = _starts_on(ways, paths, start, begin, half)
    way, blocked = stop - begin, dict[int, list[int]]()
    for i, path in enumerate(paths):
        other, station, away = near(path)
        place, (dx, dy) = (one.T for one in ways(path).at(station))
        x, y = places[other].T - place
        wide = np.where(dx * y - dy * x > 0.0, reach[i, 1], reach[i, 0])
        is_met = (other != i) & (away < wide + clear - LENGTH)
        is_met &= (station > begin[i]) & (station < stop[i] - LENGTH)
        first = set()
        for j, s in zip(other[is_met].tolist(), station[is_met].tolist(), strict=True):
            margin, comes = CLEARLY * half[i], s - begin[i]
            near_by = half[i] + half[j]
            follows = abs(s - before[i].get(j, np.inf) - way[j]) <= margin and _same_way(
                ways, paths[i], paths[j], (begin[j], stop[j]), near_by
            )
            leads = abs(stop[j] - before[j].get(i, np.inf) - comes) <= margin and _same_way(
                ways, paths[j], paths[i], (begin[i], s), near_by
            )
            if follows or (comes - way[j] / speed[j] * speed[i] > margin and not leads):
                first.add(j)
        if first:
            blocked[i] = sorted(first)
    return blocked


def _starts_on(
    ways: Shared[Way],
    paths: Sequence[FloatArray],
    start: FloatArray,
    begin: FloatArray,
    half: FloatArray,
) -> list[dict[int, float]]:
    """For each robot, which others start ahead on its path, by number: at which station [m]."""
    near = Shared(lambda path: ways(path).within(start, half + half.max()))
    found = []
    for i, path in enumerate(paths):
        other, _, station, away = near(path)
        is_ahead = (away < half[i] + half[other]) & (station - begin[i] > away)
        found.append(dict(zip(other[is_ahead].tolist(), station[is_ahead].tolist(), strict=True)))
    return found


def _same_way(
    ways: Shared[Way],
    path: FloatArray,
    other: FloatArray,
    part: tuple[float, float],
    near_by: float,
) -> bool:
    """Whether a part of another path, between two stations [m], lies along a path, so near by."""
    if path is other:
        return True
    way, (first, last) = ways(other), part
    count = min(max(int((last - first) / near_by) + 2, 2), MOST_PLACES)
    corners = way.station[(way.station > first) & (way.station < last)][:MOST_PLACES]
    places = way.at(np.concatenate([np.linspace(first, last, count), corners]))[0]
    found = ways(path).within(places, np.full(len(places), near_by))[0]
    return len(np.unique(found)) == len(places)
