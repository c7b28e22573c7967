"""Stops in the danger area, before which a robot without a formation stands for ever.

A target in the danger area is replaced by the nearest point of the safe one, which before an end
wall lies behind the stop. A formation gives a speed all the same, and so does
`reverse_in_safe_mode: false`; a robot that may choose to stand does so where going on brings it no
nearer to that point, as far before it as the stop lies beyond.
"""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np
import shapely

from physim.errors import plural
from physim.tolerances import LENGTH
from physim.world.checks.findings import Diagnostics
from physim.world.checks.standing import Stop
from physim.world.faults import describe
from physim.world.scene import Layout


def check_safe_stops(
    laid: Layout,
    at: list[Stop],
    safe_distance: float | None,
    look_ahead: float | None,
    found: Diagnostics,
) -> None:
    """Warn of stops whose safe points [m] lie too far behind them; None: no such setting."""
    world, expect = laid.world, laid.world.expect
    settings = {} if world.controller is None else world.controller.settings
    goes_on = world.formation is not None or settings.get("reverse_in_safe_mode") is False
    if safe_distance is None or look_ahead is None or goes_on:
        return
    if expect is not None and expect.finished is False:
        return
    safe = laid.area.shrunk(safe_distance, 16)
    allowed = world.arrival.tolerance
    short = [(_short(stop, safe, look_ahead), stop) for stop in at]
    told = {fault.location for fault in found.warnings}
    near = [
        (behind, stop)
        for behind, stop in short
        if 2.0 * behind > allowed - LENGTH and laid.path_key(stop.number) not in told
    ]
    if not near:
        return
    behind, stop = max(near, key=lambda one: one[0])
    others = f", as do {plural(len(near) - 1, 'more robot')}" if len(near) > 1 else ""
    found.warn(
        laid.path_key(stop.number),
        f"{describe(laid.names[stop.number])} stops nearer than {safe_distance:.4g} m "
        f"(controller.safe_distance) to the boundaries ahead of it{others}: its target is moved "
        f"back by {behind:.4g} m, so it would stand at least about as far short of its stop and "
        f"may never arrive (arrival.tolerance {allowed:g} m); end its path "
        f"{ceil(behind * 100.0) / 100.0:g} m earlier, or move the wall, or lower safe_distance",
    )


def _short(stop: Stop, safe: Any, look_ahead: float) -> float:
    """How far [m] behind a stop, along its direction, the nearest point of the safe area lies.

    0 for a stop in it, and where there is none as near as the controller looks for one.
    """
    (x, y), (dx, dy) = stop.pose[:2], (np.cos(stop.pose[2]), np.sin(stop.pose[2]))
    back, reach = 0.5 * look_ahead, 2.0 * look_ahead
    corners = [(-back, -reach), (reach, -reach), (reach, reach), (-back, reach)]
    looked_at = shapely.Polygon([(x + a * dx - b * dy, y + a * dy + b * dx) for a, b in corners])
    place = shapely.Point(x, y)
    rest = safe.intersection(looked_at)
    if rest.is_empty or safe.covers(place):
        return 0.0
    (px, py) = shapely.get_coordinates(shapely.shortest_line(place, rest))[1]
    return max(0.0, float((x - px) * dx + (y - py) * dy))
