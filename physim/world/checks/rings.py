"""Closed paths: the last station lies where the first one does, and robots start on one side.

The station of a robot at the start is that of the nearest point of the whole path. Just before the
joint this is near the end of the path, where the way is over, and not before its beginning.
"""

from __future__ import annotations

import numpy as np
import shapely

from physim.errors import Location, plural
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world.checks.findings import Diagnostics
from physim.world.checks.formation import start_stations
from physim.world.checks.standing import reached
from physim.world.faults import describe
from physim.world.layout.layout import PartialLayout

JOINED = 1.0
"""[m] A path whose ends are nearer than this is closed."""
NEAR = 0.1
"""[-] of its length before and after the joint that count as next to it"""


def is_ring(path: FloatArray) -> bool:
    """Whether a path (n, 2) [m] ends where it begins."""
    return float(np.hypot(*(path[0] - path[-1]))) < JOINED


def check_rings(laid: PartialLayout, found: Diagnostics) -> None:
    """Warn of robots that start next to the joint of a closed path, where little way is left."""
    if not _is_order_told(laid, found):  # from which the ways follow
        _check_laps(laid, found)


def _check_laps(laid: PartialLayout, found: Diagnostics) -> None:
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


def _is_order_told(laid: PartialLayout, found: Diagnostics) -> bool:
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
