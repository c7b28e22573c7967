"""Where everything in a world lies, worked out once: a run is built of it, a check looks at it.

What is sound is laid out although something else is not, so that all faults arrive at once. These
faults keep a world from running; what would run but cannot be meant is left to
`physim.world.checks`.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from physim.errors import Fault, Location, WorldError
from physim.geometry.area import Area, accessible_area
from physim.geometry.corridor import corridor_boundaries
from physim.geometry.shapes import FloatArray
from physim.geometry.tangles import meet_more_often, segments_of
from physim.geometry.thinning import thinned
from physim.world import Offset, World
from physim.world.layout.cuts import cut_faults
from physim.world.layout.road import with_drawn_road
from physim.world.layout.robots import distinct, footprints_of, path_of, paths_of
from physim.world.layout.self_overlap import self_overlap
from physim.world.layout.shape_checks import (
    Placed,
    gaps,
    outline_fault,
    placed_outline,
    robot_faults,
    wall_faults,
)
from physim.world.layout.start_poses import start_poses, written_poses
from physim.world.layout.tunnelling import Moving, tunnelling
from physim.world.scene import Layout

MOST_MEETINGS = 100_000
"""Pairs of segments of boundaries that share a point, beside those that follow each other"""

Named = tuple[str, Any]
"""A shapely line or polygon, and before it what messages call it"""


@dataclass(frozen=True)
class PartialLayout:
    """The sound parts of a layout, N robots; world frame [m] but for the footprints."""

    world: Any
    """a `World`, or the `sound_parts` of what is none"""
    boundaries: dict[str, FloatArray]
    """polylines (n, 2) by name, in the order of their ids"""
    obstacles: dict[int, FloatArray]
    """outlines (n, 2) by number"""
    reference: FloatArray | None
    """(n, 2) waypoints of s*"""
    area: Area | None
    """accessible face; None where it is unknown: a boundary or the reference path is missing, or
    nothing encloses it"""
    footprints: dict[int, FloatArray]
    """outlines (n, 2), counter-clockwise, in the frames of their robots, by number"""
    paths: dict[int, FloatArray]
    """waypoints (n, 2) by number of the robot"""
    start: FloatArray
    """(N, 3) poses [m, m, rad]; NaN where unknown"""
    faults: tuple[Fault, ...] = ()
    """why the world cannot be run"""

    @property
    def reference_key(self) -> Location:
        """Where the reference path stands."""
        own = self.world.reference_path is not None
        return ("reference_path",) if own else ("corridor", "centreline")

    def path_key(self, i: int) -> Location:
        """Where the path of a robot stands."""
        where = path_of(self.world, i)
        return (*where, "offset") if isinstance(self.world.robots[i].path, Offset) else where

    @cached_property
    def walls(self) -> list[Named]:
        """Boundaries as shapely lines."""
        return [(_label(name), shapely.LineString(line)) for name, line in self.boundaries.items()]

    @cached_property
    def solids(self) -> list[Named]:
        """Obstacles as shapely polygons."""
        drawn = self.world.is_road_drawn
        return [
            (f"obstacle {k + 1}" if drawn else f"obstacles[{k}]", shapely.Polygon(ring))
            for k, ring in self.obstacles.items()
        ]

    @cached_property
    def names(self) -> list[str]:
        """Names of the robots; ``robots[2]`` where one is missing or not the only one."""
        return robot_names(self.world)

    def whole(self) -> Layout:
        """The layout of a world that can be run; raises WorldError with every fault otherwise."""
        if self.faults or self.area is None or self.reference is None:
            raise WorldError(list(self.faults))
        return Layout(
            self.world, *corridor_line(self.world), self.boundaries,
            list(self.obstacles.values()), self.reference, self.area,
            list(self.footprints.values()), list(self.paths.values()), self.start,
        )  # fmt: skip


def lay_out(world: World, seed: int | None = None) -> Layout:
    """Resolve every length of a world, with ``seed`` or else the world's own.

    Raises WorldError with every fault of its geometry.
    """
    return partial_layout(world if seed is None else world.changed(seed=seed)).whole()


def placed_anew(layout: Layout, world: World) -> Layout:
    """The layout with the robots where the seed of ``world`` puts them; WorldError if it cannot."""
    return _placed(as_partial(layout, world), is_whole=True).whole()


def as_partial(layout: Layout, world: World) -> PartialLayout:
    """A layout as the checks take it, of ``world``."""
    return PartialLayout(
        world, layout.boundaries, dict(enumerate(layout.obstacles)), layout.reference, layout.area,
        dict(enumerate(layout.footprints)), dict(enumerate(layout.paths)), layout.start,
    )  # fmt: skip


def partial_layout(world: Any, is_whole: bool = True) -> PartialLayout:
    """Lay out what is sound of a `World`, or of the `sound_parts` of values that are no world.

    Robots are placed by the seed where everything else is sound; ``is_whole`` says of the world
    that it is.
    """
    world, faults = with_drawn_road(world)
    footprints = footprints_of(world, faults)
    _check_regions(world, faults)
    _check_step(world, footprints, faults)
    obstacles = _obstacles(world, faults)
    reference = distinct(world.reference)[0]
    boundaries, are_all = _boundaries(world, faults)
    laid = PartialLayout(
        world, thinned(boundaries), obstacles, reference, None, footprints,
        paths_of(world, reference, faults), np.empty((0, 3)),
    )  # fmt: skip
    if are_all and reference is not None:
        laid = replace(laid, area=_area(laid, reference, faults))
    return _placed(replace(laid, faults=tuple(dict.fromkeys(faults))), is_whole)


def _placed(laid: PartialLayout, is_whole: bool) -> PartialLayout:
    """With the robots at their start, and the faults of where they stand."""
    start, faults = written_poses(laid.world), list(laid.faults)
    if is_whole and not faults and laid.area is not None and laid.reference is not None:
        try:
            start = start_poses(laid)
        except WorldError as error:
            faults += error.faults
    standing = [
        Placed(i, laid.names[i], placed_outline(start[i], footprint))
        for i, footprint in laid.footprints.items()
        if not np.isnan(start[i]).any()
    ]
    accessible = laid.area.polygon if laid.area is not None else None
    of_places = wall_faults(standing, laid.walls, laid.solids, accessible, laid.world.boundaries)
    of_places += robot_faults(standing)
    faults += laid.world.as_written(of_places)
    return replace(laid, start=start, faults=tuple(laid.world.of_the_road(faults)))


def robot_names(world: Any) -> list[str]:
    """Names of the robots; ``robots[2]`` where one is missing or not the only one."""
    count = Counter(robot.name for robot in world.robots)
    return [
        robot.name if robot.name is not None and count[robot.name] == 1 else f"robots[{i}]"
        for i, robot in enumerate(world.robots)
    ]


def _check_regions(world: Any, faults: list[Fault]) -> None:
    holders: list[tuple[Location, Any]] = [((), world)]
    holders += [(("robots", i), entry) for i, entry in enumerate(world.entries)]
    for where, holder in holders:
        region = holder.start.region if holder.start is not None else None
        if region is not None and (message := outline_fault(region)):
            faults.append(Fault((*where, "start", "region"), message))


def _check_step(world: Any, footprints: dict[int, FloatArray], faults: list[Fault]) -> None:
    """Refuse steps in which a robot could pass through something."""
    moving, names = [], robot_names(world)
    for i, robot in enumerate(world.robots):
        limits = robot.limits
        if i in footprints and limits.v is not None and limits.omega is not None:
            moving.append(Moving(i, names[i], footprints[i], limits.v, limits.omega))
    if world.time.step is not None:
        faults += world.as_written(tunnelling(moving, world.time.step))


def _obstacles(world: Any, faults: list[Fault]) -> dict[int, FloatArray]:
    found = {}
    for k, ring in enumerate(world.obstacles or ()):
        if ring is None:
            continue
        if message := outline_fault(ring):
            faults.append(Fault(("obstacles", k), message))
        else:
            found[k] = np.array(ring)
    return found


def _boundaries(world: Any, faults: list[Fault]) -> tuple[dict[str, FloatArray], bool]:
    """Boundary polylines by name, in the order of their ids, and whether these are all."""
    if world.boundaries is not None:
        lines = [distinct(line)[0] for line in world.boundaries]
        found = {f"boundary {k + 1}": line for k, line in enumerate(lines) if line is not None}
        segments = segments_of(list(found.values()))
        if meet_more_often(segments, len(segments) + MOST_MEETINGS):
            message = (
                f"the lines meet each other or themselves in more than {MOST_MEETINGS} places; "
                "draw each wall once"
            )
            faults.append(Fault(("boundaries",), message))
            return {}, False
        return found, len(found) == len(lines)
    centreline, width = corridor_line(world)
    if centreline is None or width is None or world.corridor.end_margin is None:
        return {}, False
    try:
        return corridor_boundaries(centreline, width, world.corridor.end_margin), True
    except ValueError as error:
        faults.append(Fault(("corridor", "centreline"), f"the centreline {error}"))
        return {}, False


def corridor_line(world: Any) -> tuple[FloatArray | None, FloatArray | None]:
    """Centreline (n, 2) of a corridor [m] and its width (n,) [m] at each of these points.

    None where it is not known, and in a world with boundaries.
    """
    if world.corridor is None or world.boundaries is not None:
        return None, None
    centreline, kept = distinct(world.corridor.centreline)
    width = world.corridor.width
    if centreline is None or width is None:
        return centreline, None
    if isinstance(width, tuple):
        is_one_each = len(width) == len(world.corridor.centreline)
        return centreline, np.array(width, dtype=np.float64)[kept] if is_one_each else None
    return centreline, np.full(len(centreline), width, dtype=np.float64)


def _area(laid: PartialLayout, reference: FloatArray, faults: list[Fault]) -> Area | None:
    """The accessible area; where there is none, the gaps between the boundaries are named."""
    lines, drawn = list(laid.boundaries.values()), laid.world.boundaries is not None
    try:
        area = accessible_area(lines, list(laid.obstacles.values()), reference)
    except ValueError as error:
        where: Location = ("boundaries",) if drawn else ("corridor",)
        labels = [_label(name) for name in laid.boundaries]
        faults.append(Fault(where, f"{error}; {gaps(labels, lines)}"))
        return None
    corridor, (centreline, width) = laid.world.corridor, corridor_line(laid.world)
    if corridor is not None and centreline is not None and width is not None:
        message = self_overlap(centreline, width, corridor.end_margin)
        if message:
            faults.append(Fault(("corridor", "centreline"), message))
            return None  # what the rest would say follows from that
    outside = area.outside_stretches(reference)
    if not len(outside):
        return area
    if cuts := cut_faults(lines, laid.obstacles, reference):
        faults += cuts
        return None  # paths and robots beyond them are where they should be
    first, last = outside[0]
    place = f"from {first:.2f} m to {last:.2f} m along it"
    middle = shapely.LineString(reference).interpolate((first + last) / 2.0)
    through = next((name for name, solid in laid.solids if solid.covers(middle)), None)
    message = (
        f"the reference path leaves the accessible area {place}; it must lie between the "
        "boundaries and beside the obstacles"
        if through is None
        else f"the reference path leads through {through} {place}; it must lie beside the "
        "obstacles: lead it around, or move the obstacle"
    )
    faults.append(Fault(laid.reference_key, message))
    return area


def _label(name: str) -> str:
    """What messages call a boundary: its key where it is drawn."""
    kind, _, number = name.partition(" ")
    return f"boundaries[{int(number) - 1}]" if kind == "boundary" else "the edge of the corridor"
