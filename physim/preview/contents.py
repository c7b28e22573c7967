"""What a preview shows, worked out from the world alone: no figure, no kernel."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import shapely

from physim.geometry.area import ROUND_SEGMENTS
from physim.geometry.corridor import SIDES
from physim.geometry.corridor_width import Widths, sampled_widths
from physim.geometry.polygon import circumscribed_radius, least_width
from physim.geometry.shapes import FloatArray
from physim.scene import Layout
from physim.scene_builder import is_random
from physim.world_file.geometry_check import corners_of_line, placed_outline

PLACES = 600
"""Stations at which the width is worked out, besides every waypoint."""
HAIR = 1.0e-6
"""Share of L by which a path may miss the safe area and still be drawn as in it: paths that run
along its very edge."""


@dataclass(frozen=True)
class Route:
    """A path, and the robots that follow it."""

    robots: tuple[int, ...]
    """indices; robots with the same waypoints share one route"""
    safe: list[FloatArray]
    """pieces (n, 2) [m] in the safe area"""
    danger: list[FloatArray]
    """pieces (n, 2) [m] elsewhere"""


@dataclass(frozen=True)
class RobotStart:
    """A robot at the start."""

    name: str
    outline: FloatArray
    """(n, 2) [m] footprint, world frame"""
    pose: FloatArray
    """(3,) [m, m, rad]"""
    reach: float
    """[m] from the reference point to the farthest corner"""
    stop: FloatArray
    """(2,) [m] where it stops"""
    across: float
    """[m] least width of its hull: the narrowest straight gap that it fits through, aligned"""


@dataclass(frozen=True)
class Contents:
    """Everything that a preview shows; world frame [m]."""

    name: str
    description: str
    seed: int
    random: bool
    """whether the seed decides anything"""
    safe_distance: float
    """[m] L of the controller; 0 where it has none"""
    accessible: shapely.Geometry
    safe: shapely.Geometry
    """empty where there is no L"""
    boundaries: list[FloatArray]
    obstacles: list[FloatArray]
    reference: FloatArray
    length: float
    """[m] of the reference path"""
    routes: list[Route]
    robots: list[RobotStart]
    widths: Widths
    """between boundaries and obstacles"""
    boundary_widths: Widths | None
    """between the boundaries alone, where there are obstacles too"""

    @property
    def names(self) -> list[str]:
        """Names of the robots."""
        return [robot.name for robot in self.robots]

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest x, y [m] of all that is drawn."""
        cloud = [*self.boundaries, *self.obstacles, self.reference]
        cloud += [piece for route in self.routes for piece in (*route.safe, *route.danger)]
        cloud += [robot.outline for robot in self.robots]
        points = np.concatenate(cloud)
        return points.min(axis=0), points.max(axis=0)


def contents(layout: Layout, safe_distance: float) -> Contents:
    """Work out what to show of a world; ``safe_distance`` is L [m], 0 for none."""
    world, area = layout.world, layout.area.polygon
    safe = area.buffer(-safe_distance, quad_segs=ROUND_SEGMENTS) if safe_distance > 0.0 else None
    boundaries, obstacles = list(layout.boundaries.values()), layout.obstacles
    reference = corners_of_line(layout.reference)
    others, walls = _sides(layout)
    rings = _segments([np.concatenate((ring, ring[:1])) for ring in obstacles])
    widths = sampled_widths(reference, np.concatenate((others, rings)), PLACES, walls)
    alone = sampled_widths(reference, others, PLACES, walls) if len(rings) else None
    return Contents(
        name=world.name,
        description=world.description,
        seed=world.seed,
        random=is_random(world),
        safe_distance=safe_distance,
        accessible=area,
        safe=shapely.Polygon() if safe is None else safe,
        boundaries=boundaries,
        obstacles=obstacles,
        reference=reference,
        length=float(shapely.LineString(reference).length),
        routes=_routes(layout, safe_distance),
        robots=_robots(layout, reference),
        widths=widths,
        boundary_widths=alone,
    )


def _sides(layout: Layout) -> tuple[FloatArray, tuple[FloatArray, FloatArray] | None]:
    """Segments of the boundaries between which a width is told, and the two walls of a corridor.

    The caps of a corridor are in neither.
    """
    drawn = layout.boundaries
    if layout.world.corridor is None:
        return _segments(drawn.values()), None
    return _segments([]), (_segments([drawn[SIDES[0]]]), _segments([drawn[SIDES[1]]]))


def _segments(lines: Iterable[FloatArray]) -> FloatArray:
    """(S, 4) segments ax, ay, bx, by of polylines (n, 2)."""
    pieces = [np.concatenate((line[:-1], line[1:]), axis=1) for line in lines]
    return np.concatenate(pieces) if pieces else np.zeros((0, 4))


def _routes(layout: Layout, safe_distance: float) -> list[Route]:
    """Paths of the robots, each once, in the order of the robots that come first on them."""
    shared: dict[bytes, list[int]] = {}
    for i, path in enumerate(layout.paths):
        shared.setdefault(path.tobytes(), []).append(i)
    safe = None
    if safe_distance > 0.0:
        grown = safe_distance * (1.0 - HAIR)
        safe = layout.area.polygon.buffer(-grown, quad_segs=ROUND_SEGMENTS)
        shapely.prepare(safe)
    routes = []
    for robots in shared.values():
        path = corners_of_line(layout.paths[robots[0]])
        if safe is None:
            routes.append(Route(tuple(robots), [path], []))
            continue
        line = shapely.LineString(path)
        inside, outside = line.intersection(safe), line.difference(safe)
        routes.append(Route(tuple(robots), _lines(inside), _lines(outside)))
    return routes


def _lines(geometry: shapely.Geometry) -> list[FloatArray]:
    """Joined lines (n, 2) of a geometry; points are left out."""
    parts = [part for part in shapely.get_parts(geometry) if part.length > 0.0]
    if not parts:
        return []
    merged = shapely.line_merge(shapely.MultiLineString(parts))
    return [shapely.get_coordinates(line) for line in shapely.get_parts(merged)]


def _robots(layout: Layout, reference: FloatArray) -> list[RobotStart]:
    stops = _stops(layout, reference)
    robots = []
    for i, robot in enumerate(layout.world.robots):
        outline = layout.footprints[i]
        robots.append(
            RobotStart(
                name=robot.name,
                outline=shapely.get_coordinates(placed_outline(layout.start[i], outline))[:-1],
                pose=layout.start[i],
                reach=circumscribed_radius(outline),
                stop=stops[i],
                across=least_width(outline),
            )
        )
    return robots


def _stops(layout: Layout, reference: FloatArray) -> FloatArray:
    """(N, 2) [m] stop stations on the paths: staggered by the wanted leads of the formation."""
    formation = layout.world.formation
    lead = np.zeros(len(layout.start))
    if formation is not None and formation.spacing == "initial":
        line = shapely.LineString(reference)
        station = shapely.line_locate_point(line, shapely.points(layout.start[:, :2]))
        lead = station - station[0]
    elif formation is not None:
        lead = np.array(formation.spacing, dtype=np.float64)
    lines = [shapely.LineString(path) for path in layout.paths]
    ends = shapely.length(lines)
    stations = np.maximum(ends - (lead.max() - lead), 0.0)
    return np.asarray(shapely.get_coordinates(shapely.line_interpolate_point(lines, stations)))
