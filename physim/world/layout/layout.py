"""Where everything in a world lies, worked out once: a run is built of it, a check looks at it.

The faults found here keep a world from running; what would run but cannot be meant is left to
`physim.world.checks`. They are told stage by stage: those of shapes, then those of the ground, then
those of where robots stand.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from physim.errors import Fault, Location, WorldError, place_text
from physim.geometry.polygon import convex_parts
from physim.geometry.shapes import FloatArray
from physim.tolerances import LENGTH
from physim.world import Obstacle, RandomCorridor, World, each_robot
from physim.world.ground.area import accessible_area, united
from physim.world.ground.corridor import corridor_boundaries
from physim.world.ground.lines import meet_more_often, segments_of, thinned
from physim.world.layout.moved import moved_faults, mover_step_faults, way_faults
from physim.world.layout.road import drawn_road
from physim.world.layout.robots import footprints_of, paths_of, shared
from physim.world.layout.shape_checks import (
    corners_of_line,
    gaps,
    outline_fault,
    standing_faults,
)
from physim.world.layout.start_poses import start_poses
from physim.world.layout.step import step_faults
from physim.world.layout.wall_crossing import wall_crossing
from physim.world.scene import Layout, wall_label

MOST_MEETINGS = 100_000
"""Pairs of segments of boundaries that share a point, beside those that follow each other"""


def lay_out(world: World, seed: int | None = None) -> Layout:
    """Resolve every length of a world, with ``seed`` or else the world's own.

    Raises WorldError with every fault of its shapes; where these are sound, of its ground; then of
    where its robots stand.
    """
    world = world if seed is None else world.changed(seed=seed)
    faults: list[Fault] = []
    _check_regions(world, faults)
    robots, entries = each_robot(world.robots, world.seed)
    footprints = footprints_of(world, robots, faults)
    obstacles, pushed = list[FloatArray](), dict[int, FloatArray]()
    for k, entry in enumerate(world.obstacles):
        is_pushed = isinstance(entry, Obstacle)
        ring = entry.corners if isinstance(entry, Obstacle) else entry
        if message := outline_fault(ring):
            where: Location = ("obstacles", k, *(("corners",) if is_pushed else ()))
            faults.append(Fault(where, message))
        elif is_pushed:
            pushed[k] = np.array(ring)
        else:
            obstacles.append(np.array(ring))
    for k, mover in enumerate(world.movers):
        if message := outline_fault(mover.outline):
            faults.append(Fault(("movers", k, "footprint"), message))
    _raise(faults)
    centreline = widths = passage = line = None
    if world.reference_path is not None:
        line = np.array(world.reference_path)
    if isinstance(world.corridor, RandomCorridor):
        road = drawn_road(world, world.corridor)
        centreline, widths, line, obstacles = road.centreline, road.widths, road.way, road.obstacles
        passage = road.passage
    elif world.corridor is not None:
        centreline = np.array(world.corridor.centreline)
        widths = np.zeros(len(centreline)) + np.array(world.corridor.width)
    reference = corners_of_line(np.array(centreline if line is None else line))
    boundaries = _boundaries(world, centreline, widths, faults)
    paths = paths_of(world, robots, entries, reference, faults)
    parts = shared(convex_parts, footprints)
    faults += step_faults(world.time.step, robots, entries, footprints, parts)
    faults += mover_step_faults(world.time.step, world.movers)
    _raise(faults)
    lines = list(boundaries.values())
    try:
        area = accessible_area(lines, obstacles, reference)
    except ValueError as error:
        where = ("corridor",) if world.boundaries is None else ("boundaries",)
        message = f"{error}; {gaps([wall_label(name) for name in boundaries], lines)}"
        raise WorldError([Fault(where, message)]) from error
    laid = Layout(
        world, robots, entries, centreline, widths, boundaries, obstacles, reference, area,
        footprints, parts, paths, np.empty((0, 3)), passage, pushed,
    )  # fmt: skip
    _check_ground(laid, faults)
    faults += way_faults(laid)
    _raise(faults)
    return placed(laid)


def placed(laid: Layout) -> Layout:
    """The layout with the robots where its world and seed put them; WorldError if it cannot."""
    laid = replace(laid, start=start_poses(laid))
    _raise([*standing_faults(laid), *moved_faults(laid)])
    return laid


def _raise(faults: Iterable[Fault]) -> None:
    """Raise WorldError with the faults, if there are any, each once."""
    if found := list(dict.fromkeys(faults)):
        raise WorldError(found)


def _check_regions(world: World, faults: list[Fault]) -> None:
    holders: list[tuple[Location, Any]] = [((), world)]
    holders += [(("robots", i), entry) for i, entry in enumerate(world.robots)]
    for where, holder in holders:
        if holder.start is not None and (message := outline_fault(holder.start.region)):
            faults.append(Fault((*where, "start", "region"), message))


def _boundaries(
    world: World, centreline: FloatArray | None, widths: FloatArray | None, faults: list[Fault]
) -> dict[str, FloatArray]:
    """Boundary polylines by name, in the order of their ids."""
    if world.corridor is not None and centreline is not None and widths is not None:
        try:
            return corridor_boundaries(centreline, widths, world.corridor.end_margin)
        except ValueError as error:
            faults.append(Fault(("corridor", "centreline"), f"the centreline {error}"))
            return {}
    lines = [np.array(line) for line in world.boundaries or ()]
    segments = segments_of(lines)
    if meet_more_often(segments, len(segments) + MOST_MEETINGS):
        message = f"they meet in more than {MOST_MEETINGS} places; draw each wall once"
        faults.append(Fault(("boundaries",), message))
    return thinned({f"boundary {k + 1}": line for k, line in enumerate(lines)})


def _check_ground(laid: Layout, faults: list[Fault]) -> None:
    """Refuse a corridor that runs into itself, and a reference path that is not all in the area."""
    if laid.centreline is not None and laid.widths is not None and laid.world.corridor is not None:
        found = wall_crossing(laid.centreline, laid.widths, laid.world.corridor.end_margin)
        if found is not None and found.severity == "error":
            faults.append(found)
            return
    outside = laid.area.outside_stretches(laid.reference)
    if not len(outside):
        return
    line = shapely.LineString(laid.reference)
    first, last = outside[0].tolist()
    place = f"from {first:.2f} m to {last:.2f} m along it"
    inside = [shapely.get_coordinates(line.intersection(solid)) for _, solid in laid.solids]
    begin = [
        float(shapely.line_locate_point(line, shapely.points(at)).min(initial=np.inf))
        for at in inside
    ]
    met = [int(k) for k in np.argsort(begin) if np.isfinite(begin[k])]
    if met and _is_cut(laid, line):
        k = next((k for k in met if not _is_cut(laid, line, without=k)), met[0])
        at = line.interpolate(begin[k])
        message = (
            f"stands right across the way at {place_text(at.x, at.y)}, {begin[k]:.2f} m along the "
            "reference path, so that no robot can pass; make it smaller, or move it"
        )
        faults.append(Fault(laid.obstacle_key(k), message))
        return
    middle = line.interpolate(0.5 * (first + last))
    through = next((name for name, solid in laid.solids if solid.covers(middle)), None)
    message = f"it leaves the accessible area {place}; draw it between the boundaries"
    if through is not None:
        message = f"it leads through {through} {place}; lead it around"
    faults.append(Fault(laid.reference_key, message))


def _is_cut(laid: Layout, line: shapely.LineString, without: int | None = None) -> bool:
    """Whether the obstacles leave the beginning and the end of s* in different parts."""
    face = accessible_area(list(laid.boundaries.values()), [], laid.reference).polygon
    solids = [solid for k, (_, solid) in enumerate(laid.solids) if k != without]
    parts = shapely.get_parts(face.difference(united(solids)))
    free = [line.intersection(part) for part in parts]
    begins, ends = (
        [k for k, piece in enumerate(free) if piece.distance(shapely.Point(end)) <= LENGTH]
        for end in line.coords[:: len(line.coords) - 1]
    )
    return not set(begins) & set(ends)
