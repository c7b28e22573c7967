"""What may be drawn so, but is seldom meant: crossings, folds in bends, obstacles beside the road.

Boundaries may touch, and a polyline may close; where they cross each other or themselves a wall
cuts through the road, unless it merely ends beyond a corner.
"""

from __future__ import annotations

import numpy as np
import shapely

from physim.errors import Location, place_text, plural
from physim.geometry.corridor import SIDES, corridor_boundaries
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world.checks.findings import Diagnostics
from physim.world.layout.shape_checks import crossings, self_crossings
from physim.world.scene import Layout

HAIR = 1e-7
"""[-] share by which walls are drawn in, so that those that only touch do not cross"""
MOST_CROSSINGS = 3
"""Crossings of one polyline with itself that are reported one by one."""


def check_obstacles(laid: Layout, found: Diagnostics) -> None:
    """Warn of obstacles that no robot can meet, once for all of them."""
    if not laid.obstacles:
        return
    solids = np.array([solid for _, solid in laid.solids])
    shapely.prepare(laid.area.polygon)
    meets = shapely.dwithin(laid.area.polygon, solids, LENGTH)  # they are cut out of it
    outside = np.flatnonzero(~meets).tolist()
    if outside:
        x, y = laid.obstacles[outside[0]][0]
        more = f" (so {'does' if len(outside) == 2 else 'do'} {plural(len(outside) - 1, 'more')})"
        found.warn(
            ("obstacles", outside[0]),
            f"lies outside the accessible area, at {place_text(x, y)}{more * (len(outside) > 1)}: "
            "no robot can meet it; move it between the boundaries, or remove it",
        )


def check_boundaries(laid: Layout, found: Diagnostics) -> None:
    """Boundaries do not cross, and the walls of a corridor do not fold over in its bends."""
    if laid.world.boundaries is not None:
        _check_drawn(laid, found)
        return
    centreline, width = laid.centreline, laid.widths
    if centreline is None:
        return
    for x, y in self_crossings(centreline)[:MOST_CROSSINGS]:
        found.error(
            ("corridor", "centreline"),
            f"the centreline crosses itself at {place_text(x, y)}; walls would cut through the "
            "road there; lead it round, or draw boundaries instead",
        )
    corridor = laid.world.corridor
    if corridor is not None and width is not None:
        width = (1.0 - HAIR) * width  # legs that share a wall do not fold
        walls = corridor_boundaries(centreline, width, corridor.end_margin)
        _check_folds([walls[side] for side in SIDES], found)


def _check_drawn(laid: Layout, found: Diagnostics) -> None:
    lines = list(laid.boundaries.values())
    keys: list[Location] = [("boundaries", int(name.split()[1]) - 1) for name in laid.boundaries]
    ends = _overshoots([shape for _, shape in laid.walls])
    for key, line in zip(keys, lines, strict=True):
        for place in self_crossings(line)[:MOST_CROSSINGS]:
            _add_crossing(key, "itself", place, ends, found)
    for a, b, place in crossings(lines):
        _add_crossing(keys[max(a, b)], laid.walls[min(a, b)][0], place, ends, found)


def _add_crossing(
    where: Location, other: str, place: tuple[float, float], ends: FloatArray, found: Diagnostics
) -> None:
    crossing = f"crosses {other} at {place_text(*place)}"
    if len(ends) and np.hypot(*(ends - place).T).min() <= LENGTH:
        found.warn(where, f"{crossing} and ends beyond it; let it end there")
    else:
        found.error(where, f"{crossing}; boundaries may touch and close, but not cross")


def _overshoots(lines: list[shapely.LineString]) -> FloatArray:
    """(n, 2) ends of the pieces of boundaries that border no face: loose ends beyond a corner."""
    if not lines:
        return np.zeros((0, 2))
    noded = shapely.unary_union(lines)
    _, _, dangles, _ = shapely.polygonize_full(shapely.get_parts(noded))
    return np.asarray(shapely.get_coordinates(dangles))


def _check_folds(walls: list[FloatArray], found: Diagnostics) -> None:
    """Warn of a wall, left or right, that folds over in a bend, where it crosses itself.

    Where it would not, its legs are too close for a bend, and the world is refused.
    """
    for name, wall in zip(SIDES, walls, strict=True):
        places = self_crossings(wall)
        if places:
            x, y = places[0]
            more = f" and at {plural(len(places) - 1, 'more place')}" if len(places) > 1 else ""
            found.warn(
                ("corridor",),
                f"the {name} crosses itself at {place_text(x, y)}{more}: the bend is tighter than "
                "half the width, so the corridor is narrower there than written; widen the bend, "
                "or put the points of the centreline further apart",
            )
