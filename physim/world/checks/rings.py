"""Paths that come by the same place twice, closed ones and loops: which station does one start at?

The station of a robot at the start is that of the nearest point of the whole path. Just before the
joint of a closed path this is near the end, where the way is over, and not before its beginning.
Next to a crossing it may be that of the later leg, though the robot is in the earlier one.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from physim.errors import Location, plural
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray, IntArray
from physim.tolerances import LENGTH
from physim.world.checks.findings import MOST_ALIKE, Diagnostics
from physim.world.checks.spacing import start_stations
from physim.world.checks.standing import reached
from physim.world.checks.way import Way, is_ring
from physim.world.faults import describe
from physim.world.layout.shared import sharing
from physim.world.scene import Layout

NEAR = 0.1
"""[-] of its length before and after the joint that count as next to it"""
MOST_PAIRS = 2_000_000
"""Robots times segments of their path that are looked at together, which bounds memory."""

FACED = float(np.cos(np.pi / 4.0))
"""[-] A robot faces along a leg when it is turned from it by less than 45 degrees."""


def check_rings(laid: Layout, found: Diagnostics) -> None:
    """Warn of robots that start where little of their way is left, though they face more of it."""
    _check_loops(laid, found)
    if not _is_order_told(laid, found):  # from which the ways follow
        _check_laps(laid, found)


def _check_loops(laid: Layout, found: Diagnostics) -> None:
    """Robots that face an earlier leg of their path than the one they are taken to be on."""
    placed = [i for i, path in enumerate(laid.paths) if not is_ring(path)]
    part_of = reached(laid)
    for group in sharing([laid.paths[i] for i in placed]):
        way = Way(laid.paths[placed[group[0]]])
        at_once = max(1, MOST_PAIRS // len(way.direction))
        told: list[tuple[int, str]] = []
        for k in range(0, len(group), at_once):
            if len(told) < MOST_ALIKE:
                some = [placed[number] for number in group[k : k + at_once]]
                told += _loops(laid, some, way, np.array([part_of[i][0] for i in some]))
        for i, message in told[:MOST_ALIKE]:
            found.warn(laid.path_key(i), message)


def _loops(laid: Layout, robots: list[int], way: Way, begin: FloatArray) -> list[tuple[int, str]]:
    """Who of robots that share a path faces an earlier leg of it than that of ``begin`` [m]."""
    reach = np.array([circumscribed_radius(laid.footprints[i]) for i in robots])
    pose = laid.start[robots]
    row, leg, station, apart = way.within(pose[:, :2], reach)
    direction = way.direction
    ahead = np.stack((np.cos(pose[:, 2]), np.sin(pose[:, 2])), axis=1)
    faces = (direction[leg] * ahead[row]).sum(axis=1) > FACED
    faces_here = (way.at(begin)[1] * ahead).sum(axis=1) > FACED
    skipped = begin[row] - station
    is_loop = skipped > np.maximum(NEAR * way.station[-1], 4.0 * reach[row])
    return [
        (
            robots[row[k]],
            f"{describe(laid.names[robots[row[k]]])} faces along its path at station "
            f"{station[k]:.2f} m, {apart[k]:.2f} m away, but is nearest to station "
            f"{begin[row[k]]:.2f} m, where it is taken to start: it skips {skipped[k]:.2f} m; "
            "place it nearer to the leg that it is to begin with",
        )
        for k in _first_of_each(row, faces & ~faces_here[row] & is_loop, station)
    ]


def _first_of_each(row: IntArray, wanted: NDArray[np.bool_], station: FloatArray) -> list[int]:
    """Of each robot the wanted place of the least station."""
    first: dict[int, int] = {}
    for k in np.flatnonzero(wanted)[np.argsort(station[wanted], kind="stable")].tolist():
        first.setdefault(int(row[k]), k)
    return [first[one] for one in sorted(first)]


def _check_laps(laid: Layout, found: Diagnostics) -> None:
    """Robots to which a closed path of their own leaves next to nothing of its lap."""
    short: dict[Location, list[tuple[int, float, float]]] = {}
    for i, (begin, stop) in reached(laid).items():
        path = laid.paths[i]
        length = float(shapely.LineString(path).length)
        # who starts at or past the stop station is told with the formation
        if is_ring(path) and LENGTH < stop - begin < NEAR * length:
            short.setdefault(laid.path_key(i), []).append((i, begin, stop))
    for where, group in short.items():
        i, begin, stop = group[0]
        others = f", and so do {plural(len(group) - 1, 'more robot')}" if len(group) > 1 else ""
        found.warn(
            where,
            f"{describe(laid.names[i])} starts at station {begin:.2f} m of a closed path and stops "
            f"at {stop:.2f} m: it drives {stop - begin:.2f} m, not a lap{others}; let the path "
            "begin behind the robot",
        )


def _is_order_told(laid: Layout, found: Diagnostics) -> bool:
    """Warn of a formation on both sides of the joint of a closed reference path, and say so."""
    line = laid.reference
    if line is None or laid.world.formation is None or not is_ring(line):
        return False
    reference = shapely.LineString(line)
    stations = start_stations(laid, reference)
    if stations is None or not len(stations):
        return False
    first, last = int(np.argmin(stations)), int(np.argmax(stations))
    low, high = float(stations[first]), float(stations[last])
    near = NEAR * reference.length
    if not (low < near and high > reference.length - near):
        return False
    found.warn(
        laid.reference_key,
        f"the reference path is closed, and robots start on both sides of its joint: "
        f"{describe(laid.names[first])} at station {low:.2f} m, {describe(laid.names[last])} at "
        f"{high:.2f} m, by which the formation takes it to be {high - low:.4g} m ahead; let the "
        "path begin behind all robots",
    )
    return True
