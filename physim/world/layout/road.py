"""The road of a world that its seed draws: walls, obstacles and a reference path, with proof.

A road is kept only if, as rounded, all of this holds; else it is drawn again, `ATTEMPTS` times at
most, and then refused:

- it neither crosses itself nor passes itself nearer than `road_line.APART`;
- every wall and obstacle is half the passage or more from the reference path: so a disc as wide as
  the passage moves along all of it, and free space less half the passage is connected;
- both walls run forward, and so do the paths beside the reference path, in its bends too.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from physim.errors import Fault, Location, WorldError
from physim.geometry.polygon import circumscribed_radius, least_width
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world import Offset, RandomCorridor, RandomRoad, RobotGroup, World
from physim.world.ground.corridor import corridor_boundaries
from physim.world.layout.clutter import draw_clutter
from physim.world.layout.road_line import (
    ASTRAY,
    Course,
    are_apart,
    draw_centreline,
    draw_way,
    draw_widths,
    lanes_advance,
    walls_advance,
)
from physim.world.road import MARGIN
from physim.world.robot import outline_of

ROAD: Location = ("corridor", "random")
ATTEMPTS = 60
"""Times that a road is drawn before it is refused"""
CROWDED = 6
"""Times that its obstacles find no room before it is refused"""


@dataclass(frozen=True)
class DrawnRoad:
    """A road as drawn, lengths [m]."""

    centreline: FloatArray
    """(n, 2)"""
    widths: FloatArray
    """(n,)"""
    way: FloatArray
    """(n, 2) reference path"""
    obstacles: list[FloatArray]
    """outlines (m, 2)"""
    passage: float
    """clear width along the reference path"""


@dataclass(frozen=True)
class Lane:
    """What a passage is for: a robot on its path."""

    where: Location
    offset: float
    """[m]"""
    reach: float
    """[m] from its reference point to its farthest corner"""
    width: float
    """[m] least width of its footprint"""


def drawn_road(world: World, corridor: RandomCorridor) -> DrawnRoad:
    """The road that the seed of a world draws, with room for all paths beside its reference path.

    Raises WorldError where none of the roads drawn keeps to what is asked.
    """
    road, end_margin, lanes = corridor.random, corridor.end_margin, _lanes(world)
    passage = _passage(road, lanes)
    offsets = sorted({lane.offset for lane in lanes})
    failed: Counter[str] = Counter()
    for attempt in range(ATTEMPTS):
        astray = ASTRAY[2 * attempt >= ATTEMPTS]
        centreline = draw_centreline(road, world.seed, attempt, astray)
        widths = draw_widths(road, centreline, world.seed, attempt)
        if not are_apart(centreline, widths, end_margin):
            failed["bends"] += 1
            continue
        lines = corridor_boundaries(centreline, widths, end_margin)
        course = Course(road, passage, world.seed, attempt, centreline, widths, lines)
        if not walls_advance(lines, centreline) or not lanes_advance(
            way := draw_way(course), offsets
        ):
            failed["radii"] += 1
            continue
        line = shapely.LineString(way)
        obstacles = draw_clutter(course, line)
        if obstacles is None:
            failed["clutter"] += 1
            if failed["clutter"] >= CROWDED:
                break
            continue
        # the diameter of the largest disc that moves along all of the way
        solids = [course.walls, *map(shapely.Polygon, obstacles)]
        if 2.0 * min(float(line.distance(one)) for one in solids) >= passage - LENGTH:
            return DrawnRoad(centreline, widths, way, obstacles, passage)
        failed["radii"] += 1
    key = "clutter" if failed["clutter"] >= CROWDED else failed.most_common(1)[0][0]
    count = round(road.clutter * (road.length - 2.0 * road.ends) / 100.0)
    why = {
        "clutter": f"have no room for {count} obstacles beside a passage of {passage:.4g} m; give "
        "less clutter, smaller sizes, more width",
        "bends": "cross or nearly touch themselves; give fewer bends, smaller turns, more length",
        "radii": "have no room for walls and paths in their bends; give larger radii, smaller "
        "offsets",
    }[key]
    drawn = f"{failed[key]} of {failed.total()} roads drawn by this seed"
    raise WorldError([Fault((*ROAD, key), f"{drawn} {why} or another seed")])


def _lanes(world: World) -> list[Lane]:
    """Every footprint with the paths that it may follow, of those beside the reference path."""
    found = []
    for e, entry in enumerate(world.robots):
        shapes: Any = entry.shapes if isinstance(entry, RobotGroup) else (entry.footprint,)
        several = entry.paths if isinstance(entry, RobotGroup) else None
        for outline in map(outline_of, shapes):
            reach, width = circumscribed_radius(outline), least_width(outline)
            for k, path in enumerate((entry.path,) if several is None else several):
                where = ("path",) if several is None else ("paths", k)
                if isinstance(path, Offset):
                    found.append(Lane(("robots", e, *where), path.offset, reach, width))
    return found


def _passage(road: RandomRoad, lanes: list[Lane]) -> float:
    """Clear width [m] that is guaranteed; WorldError where it cannot be."""
    tightest = road.bend_radii[0]
    for lane in lanes:
        if abs(lane.offset) >= tightest:
            message = (
                f"{lane.offset:g} m to the side there is no path in bends of {tightest:.4g} m "
                "radius; use a smaller offset, or larger radii"
            )
            raise WorldError([Fault((*lane.where, "offset"), message)])
    if road.passage is None:
        half = max((abs(lane.offset) + lane.reach for lane in lanes), default=0.0) + MARGIN
        wanted = float(np.ceil(2000.0 * half - 1e-6) / 1000.0)
        if wanted > road.widths[0]:
            message = (
                f"{road.widths[0]:.6g} m at the least is narrower than the passage, {wanted:.6g} "
                f"m, in which every robot can turn round on its path with {MARGIN} m to either "
                "side; widen the road, or state a passage"
            )
            raise WorldError([Fault((*ROAD, "width"), message)])
        return wanted
    for lane in lanes:
        if (needed := 2.0 * abs(lane.offset) + lane.width) > road.passage:
            message = (
                f"{road.passage:.6g} m is too narrow for robots[{lane.where[1]}], "
                f"{lane.width:.4g} m wide, {lane.offset:g} m beside the middle of the passage: "
                f"at least {needed:.6g} m"
            )
            raise WorldError([Fault((*ROAD, "passage"), message)])
    return road.passage
