"""The ground: boundaries that cross, walls that fold in bends, obstacles beside the road.

Boundaries may touch, and a polyline may close; where they cross each other or themselves a wall
cuts through the road, unless it merely ends beyond a corner.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely

from physim.errors import Fault, Location, place_text, plural
from physim.geometry.corridor import corridor_boundaries
from physim.tolerances import LENGTH
from physim.world import World
from physim.world.layout.shape_checks import crossings, self_crossings
from physim.world.scene import Layout

HAIR = 1e-7
"""[-] share by which walls are drawn in, so that those that only touch do not cross"""
MOST_CROSSINGS = 3
"""Crossings of one polyline with itself that are reported one by one."""


def check_obstacles(laid: Layout) -> Iterator[Fault]:
    """Obstacles that no robot can meet, once for all of them."""
    solids = np.array([solid for _, solid in laid.solids])
    shapely.prepare(laid.area.polygon)
    meets = shapely.dwithin(laid.area.polygon, solids, LENGTH)  # they are cut out of it
    outside = np.flatnonzero(~np.asarray(meets, dtype=bool)).tolist()
    if outside:
        x, y = shapely.get_coordinates(solids[outside[0]])[0]
        left = len(outside) - 1
        more = f" (so {'does' if left == 1 else 'do'} {plural(left, 'more')})" if left else ""
        yield Fault(
            laid.obstacle_key(outside[0]),
            f"lies outside the accessible area, at {place_text(x, y)}{more}: no robot can meet it; "
            "move it between the boundaries, or remove it",
            "warning",
        )


def check_boundaries(world: World) -> Iterator[Fault]:
    """Boundaries that cross each other or themselves; ends beyond a corner are a warning."""
    lines = [np.array(line) for line in world.boundaries or ()]
    if not lines:
        return
    noded = shapely.unary_union([shapely.LineString(line) for line in lines])
    loose = shapely.get_coordinates(shapely.polygonize_full(shapely.get_parts(noded))[2])
    found = [
        (k, "itself", place)
        for k, line in enumerate(lines)
        for place in self_crossings(line)[:MOST_CROSSINGS]
    ]
    found += [(max(a, b), f"boundaries[{min(a, b)}]", at) for a, b, at in crossings(lines)]
    for k, other, place in found:
        where: Location = ("boundaries", k)
        said = f"crosses {other} at {place_text(*place)}"
        if len(loose) and np.hypot(*(loose - place).T).min() <= LENGTH:
            yield Fault(where, f"{said} and ends beyond it; let it end there", "warning")
        else:
            yield Fault(where, f"{said}; boundaries may touch and close, but not cross")


def check_folds(laid: Layout) -> Iterator[Fault]:
    """Walls of a corridor that fold over in a bend, where they cross themselves.

    Where that is no bend, its legs are too close, and the world is refused.
    """
    centreline, width, corridor = laid.centreline, laid.widths, laid.world.corridor
    if centreline is None or width is None or corridor is None:
        return
    # legs that share a wall do not fold
    walls = corridor_boundaries(centreline, (1.0 - HAIR) * width, corridor.end_margin)
    for name, wall in walls.items():
        if places := self_crossings(wall):
            more = f" and at {plural(len(places) - 1, 'more place')}" if len(places) > 1 else ""
            yield Fault(
                ("corridor",),
                f"the {name} crosses itself at {place_text(*places[0])}{more}: the bend is tighter "
                "than half the width, so the corridor is narrower there than written; widen the "
                "bend, or put the points of the centreline further apart",
                "warning",
            )


def road_note(laid: Layout) -> str:
    """What is to be known of a road that was drawn by the seed: the checks hold for that one."""
    line, width = laid.centreline, laid.widths
    if laid.passage is None or line is None or width is None:
        return ""
    return (
        f"road drawn by seed {laid.world.seed}: {shapely.LineString(line).length:.1f} m long, "
        f"{width.min():.4g} to {width.max():.4g} m wide, "
        f"{plural(len(laid.obstacles), 'obstacle')}, passage of {laid.passage:.4g} m; other "
        "seeds draw other roads"
    )
