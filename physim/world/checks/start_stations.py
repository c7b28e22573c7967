"""Stations at the start against walls: a robot is on the stretch of a path that is nearest to it.

That may lie beyond a wall, or an obstacle, on another leg, where the stretch that is meant is
farther away.
"""

from __future__ import annotations

import numpy as np
import shapely

from physim.errors import Fault, Location, place_text, plural
from physim.geometry.polygon import circumscribed_radius
from physim.geometry.shapes import FloatArray, IntArray
from physim.world.checks.findings import Diagnostics
from physim.world.checks.way import Way
from physim.world.faults import describe
from physim.world.layout.shared import Shared
from physim.world.scene import Layout

ROUND = 2.0
"""[-] times the ways to two stretches: what lies between them along the path, where it merely goes
round what stands in the way"""
FAR = 10.0
"""[-] times its circumscribed radius that a robot starts from its path, if that is told"""
NEARLY = 1.0 - 1e-9
"""[-] Share of a way that no wall may cross"""
MOST_LOOKED_AT = 100
"""Robots beyond a wall from their nearest stretch that are looked at, of each kind of path"""
MOST_STRETCHES = 100
"""Other stretches that are looked at for each"""


def doubtful_starts(layout: Layout) -> list[Fault]:
    """What `check_start_stations` warns of in a world that can be run."""
    found = Diagnostics()
    check_start_stations(layout, found)
    return layout.world.of_the_road(found.warnings)


def check_start_stations(laid: Layout, found: Diagnostics) -> None:
    """Warn of robots whose nearest stretch of the reference path, or of their own, is walled off.

    Told only where another stretch, far from it along the path, is in sight.
    """
    placed = list(range(len(laid.paths)))
    if not (laid.walls or laid.solids) or not placed:
        return
    lines = [shapely.get_coordinates(shape) for _, shape in (*laid.walls, *laid.solids)]
    walls = shapely.STRtree(
        shapely.linestrings(np.concatenate([np.stack([a[:-1], a[1:]], axis=1) for a in lines]))
    )
    line_of = Shared(shapely.LineString)
    if laid.world.formation is not None:
        line = line_of(laid.reference)
        _check(laid, placed, [line] * len(placed), "the reference path", walls, found)
    _check(laid, placed, [line_of(laid.paths[i]) for i in placed], "its path", walls, found)


def check_far_starts(laid: Layout, found: Diagnostics) -> None:
    """Warn of robots that are written to start far from their paths, as where x and y are swapped.

    Where the seed places them they may have far to go.
    """
    line_of = Shared(shapely.LineString)
    told: list[tuple[int, float, float, float]] = []
    for i, path in enumerate(laid.paths):
        if laid.world.robots[i].pose is None:
            continue
        start = shapely.Point(laid.start[i, :2])
        away = line_of(path).distance(start)
        if away > FAR * circumscribed_radius(laid.footprints[i]):
            (x, y) = shapely.get_coordinates(shapely.shortest_line(start, line_of(path)))[1]
            told.append((i, away, float(x), float(y)))
    if told:
        i, away, x, y = told[0]
        more = f", and {plural(len(told) - 1, 'more robot')} so" if len(told) > 1 else ""
        found.warn(
            (*laid.world.entry_of(i), "pose"),
            f"{describe(laid.names[i])} starts {away:.4g} m away from its path, which is nearest "
            f"at {place_text(x, y, 4)}{more}; are x and y swapped, or is the path another's?",
        )


def _check(
    laid: Layout,
    robots: list[int],
    lines: list[shapely.LineString],
    called: str,
    walls: shapely.STRtree,
    found: Diagnostics,
) -> None:
    starts = laid.start[robots, :2]
    ways = shapely.shortest_line(shapely.points(starts), lines)
    ends = shapely.get_coordinates(ways).reshape(-1, 2, 2)[:, 1]
    hidden = _walled_off(starts, ends, walls)
    told: list[tuple[int, float, float, float, float]] = []
    for row in hidden[:MOST_LOOKED_AT].tolist():
        start, way = starts[row], Way(shapely.get_coordinates(lines[row]))
        along = ((start - way.points[:-1]) * way.direction).sum(axis=1)
        along = np.clip(along, 0.0, np.diff(way.station))
        feet = way.points[:-1] + along[:, None] * way.direction
        far = np.hypot(*(feet - start).T)
        at = way.station[:-1] + along
        station = float(at[np.argmin(far)])
        padded = np.concatenate([[np.inf], far, [np.inf]])
        is_nearest = (far <= padded[:-2]) & (far <= padded[2:])  # of its stretch
        others = np.flatnonzero(is_nearest & (np.abs(at - station) > ROUND * (far + far.min())))
        others = others[np.argsort(far[others], kind="stable")][:MOST_STRETCHES]
        blocked = _walled_off(np.broadcast_to(start, feet[others].shape), feet[others], walls)
        seen = np.delete(others, blocked)
        if len(seen):
            k = seen[0]
            told.append((robots[row], far.min(), station, far[k], at[k]))
    if not told:
        return
    i, near, station, seen_at, other = told[0]
    at_least = " or more" if len(hidden) > MOST_LOOKED_AT else ""
    more = f", and {plural(len(told) - 1, 'more robot')}{at_least} so" if len(told) > 1 else ""
    where: Location = (*laid.world.entry_of(i), "pose")
    found.warn(
        where,
        f"{describe(laid.names[i])} starts {near:.4g} m from {called} at {station:.2f} m along it, "
        f"beyond a wall or an obstacle, and counts as there{more}; the stretch at {other:.2f} m, "
        f"in sight, is {seen_at:.4g} m away; start it nearer to that, or lead the path farther "
        "from what is between",
    )


def _walled_off(starts: FloatArray, ends: FloatArray, walls: shapely.STRtree) -> IntArray:
    """Numbers of the straight ways, of the same number each, that a wall crosses.

    A way that ends at a wall is not crossed by it.
    """
    ends = starts + NEARLY * (ends - starts)
    ways = shapely.linestrings(np.stack([starts, ends], axis=1))
    return np.unique(walls.query(ways, predicate="intersects")[0])
