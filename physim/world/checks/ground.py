"""The ground: boundaries that cross, walls that fold in bends, obstacles beside the road.

Boundaries may touch, and a polyline may close; where they cross each other or themselves a wall
cuts through the road, unless it merely ends beyond a corner.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np
import shapely

from physim.errors import Fault, Location, place_text, plural
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world import World
from physim.world.ground.polyline import Polyline
from physim.world.layout.wall_crossing import wall_crossing
from physim.world.scene import Layout

MOST_FOUND = 50
"""Crossings of two boundaries after which no more are sought"""
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
    loose = shapely.polygonize_full(shapely.get_parts(noded))[2]
    for k, other, place in (*_with_itself(lines), *_of_two(lines)):
        where: Location = ("boundaries", k)
        said = f"crosses {other} at {place_text(*place)}"
        if loose.distance(shapely.Point(place)) <= LENGTH:
            yield Fault(where, f"{said} and ends beyond it; let it end there", "warning")
        else:
            yield Fault(where, f"{said}; boundaries may touch and close, but not cross")


def _with_itself(lines: list[FloatArray]) -> Iterator[tuple[int, str, FloatArray]]:
    """Polylines that cross themselves elsewhere than at their ends, and where."""
    for k, line in enumerate(lines):
        met = (place for *_, place in Polyline(line).crossings())
        for place in islice((one for one in met if _is_inner(one, line)), MOST_CROSSINGS):
            yield k, "itself", place


def _of_two(lines: list[FloatArray]) -> Iterator[tuple[int, str, FloatArray]]:
    """Polylines that meet elsewhere than at an end of one of them, and where first.

    Two that share stretches only, as of a wall drawn twice, do no harm.
    """
    shapes = np.array([shapely.LineString(line) for line in lines])
    found = 0
    for a, b in shapely.STRtree(shapes).query(shapes, predicate="intersects").T.tolist():
        if a < b and found < MOST_FOUND:
            common = shapes[a].intersection(shapes[b])
            inner = [p for p in shapely.get_coordinates(common) if _is_inner(p, lines[a], lines[b])]
            if inner and "Point" in {part.geom_type for part in shapely.get_parts(common)}:
                found += 1
                yield b, f"boundaries[{a}]", inner[0]


def _is_inner(place: FloatArray, *lines: FloatArray) -> bool:
    """Whether a place is no end of any of these lines."""
    ends = np.vstack([line[[0, -1]] for line in lines])
    return float(np.hypot(*(ends - place).T).min()) > LENGTH


def check_folds(laid: Layout) -> Iterator[Fault]:
    """Walls of a corridor that fold over in a bend."""
    corridor = laid.world.corridor
    if laid.centreline is not None and laid.widths is not None and corridor is not None:
        found = wall_crossing(laid.centreline, laid.widths, corridor.end_margin)
        yield from [] if found is None else [found]


def road_notes(laid: Layout) -> tuple[str, ...]:
    """What is to be known of a road that was drawn by the seed: the checks hold for that one."""
    line, width = laid.centreline, laid.widths
    if laid.passage is None or line is None or width is None:
        return ()
    return (
        f"road drawn by seed {laid.world.seed}: {shapely.LineString(line).length:.1f} m long, "
        f"{width.min():.4g} to {width.max():.4g} m wide, "
        f"{plural(len(laid.obstacles), 'obstacle')}, passage of {laid.passage:.4g} m; other "
        "seeds draw other roads",
    )
