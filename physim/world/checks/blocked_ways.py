"""Stops in the way of robots that come there later, and would wait there for ever."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from physim.errors import place_text, plural
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world.checks.findings import Diagnostics
from physim.world.checks.standing import Stop, reached
from physim.world.checks.way import Way
from physim.world.faults import describe
from physim.world.layout.shared import Shared
from physim.world.scene import Layout

CLEARLY = 3.0
"""[-] times its half width that a robot is farther away when the one in its way has stopped: about
its length"""

MOST_PLACES = 5_000
"""of a way at which it is looked whether it is that of another robot, and as many of its corners"""


def check_blocked_ways(
    laid: Layout, at: list[Stop], speed: float, clear: float, found: Diagnostics
) -> None:
    """Warn of robots that stop in the way of others, unless the run is not to finish.

    ``speed`` [m/s] is that of all robots whose limits are not below it; a formation adjusts it, so
    none is judged. ``clear`` [m] is what robots keep from one another. One warning for all of
    them, at the first. Those that stop on one another are
    told by `check_shared_stops`.
    """
    world, expect = laid.world, laid.world.expect
    if not at or (expect is not None and expect.finished is False):
        return
    if world.formation is not None:
        return
    robots = world.robots
    way = reached(laid)
    blocked = blocked_ways(
        [laid.paths[stop.number] for stop in at],
        laid.start[[stop.number for stop in at], :2],
        np.array([way[stop.number][0] for stop in at]),
        np.array([stop.station for stop in at]),
        np.array([min(speed, robots[stop.number].limits.v) for stop in at]),
        np.array([sides(laid.footprints[stop.number]) for stop in at]),
        [stop.outline for stop in at],
        clear,
    )
    first = (
        (i, next((j for j in others if not at[i].outline.intersects(at[j].outline)), None))
        for i, others in blocked.items()
    )
    pairs = [(i, j) for i, j in first if j is not None]
    if not pairs:
        return
    late, stop = at[pairs[0][0]], at[pairs[0][1]]
    x, y = stop.pose[:2]
    more = f", as {plural(len(pairs) - 1, 'more robot')} would" if len(pairs) > 1 else ""
    found.warn(
        laid.path_key(stop.number),
        f"{describe(laid.names[stop.number])} stops at station {stop.station:.2f} m of its path, "
        f"{place_text(x, y, 4)}, in the way of {describe(laid.names[late.number])}, "
        f"which comes there later and may wait there for ever{more}; end one of the paths "
        "elsewhere, or let the other robot be there first",
    )


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
