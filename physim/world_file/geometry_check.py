"""Faults of geometry, found before the run: with shapely, independent of the compiled kernels.

`shape_faults` looks at single shapes and needs the world alone; call it before areas or convex
parts are worked out. `geometry_faults` looks at where the robots stand.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike

from physim.errors import Fault, Location
from physim.geometry.polygon import (
    circumscribed_radius,
    convex_parts,
    corners,
    is_simple,
    least_width,
    smallest_width,
)
from physim.geometry.shapes import FloatArray
from physim.tolerances import CONTACT, LENGTH, TUNNEL_FRACTION
from physim.world import World
from physim.world.faults import shown

MOST_TOLD = 3
"""Bodies that one robot overlaps which are told one by one."""


def shape_faults(world: World) -> list[Fault]:
    """Faults of single shapes: outlines that cross themselves or enclose nothing, and tunnelling.

    Robots of the same outline are looked at once.
    """
    faults: list[Fault] = []
    known: dict[Any, str] = {}
    for i, robot in enumerate(world.robots):
        outline = robot.outline
        if outline not in known:
            known[outline] = _outline_fault(outline)
        if known[outline]:
            faults.append(Fault(("robots", i, "footprint"), known[outline]))
        if robot.start is not None and (message := _outline_fault(robot.start.region)):
            faults.append(Fault(("robots", i, "start", "region"), message))
    if world.start is not None and (message := _outline_fault(world.start.region)):
        faults.append(Fault(("start", "region"), message))
    for k, obstacle in enumerate(world.obstacles):
        if message := _outline_fault(obstacle):
            faults.append(Fault(("obstacles", k), message))
    return faults or _tunnelling(world)


def geometry_faults(
    world: World,
    *,
    start: ArrayLike,
    footprints: Sequence[ArrayLike],
    boundaries: Sequence[ArrayLike],
    obstacles: Sequence[ArrayLike],
    accessible: Any,
    paths: Sequence[ArrayLike],
) -> list[Fault]:
    """Every fault of a world's geometry at the start, each with its location and numbers.

    ``start`` (N, 3) poses [m, m, rad]; ``footprints`` N outlines (n, 2), robot's frame;
    ``boundaries`` polylines and ``obstacles`` outlines as drawn, world frame; ``accessible`` the
    shapely area that robots may use, None where the boundaries bound no face around the reference
    path; ``paths`` N polylines. Touching (distance at most ``CONTACT``) counts as overlap.
    """
    faults = shape_faults(world)
    if faults:
        return faults
    for i, path in enumerate(paths):
        if len(corners_of_line(path)) < 2:
            faults.append(Fault(("robots", i, "path"), "must have two distinct points"))
    if accessible is None or accessible.is_empty:
        where: Location = ("boundaries",) if world.boundaries is not None else ("corridor",)
        message = "the boundaries close no face around the reference path; join their ends"
        return [*faults, Fault(where, message)]
    placed = [placed_outline(p, f) for p, f in zip(np.asarray(start), footprints, strict=True)]
    walls = [shapely.LineString(np.asarray(line)) for line in boundaries]
    solids = [shapely.Polygon(np.asarray(ring)) for ring in obstacles]
    faults += _wall_faults(world, placed, walls, solids, accessible)
    faults += _robot_faults(world, placed)
    return faults


def corners_of_line(line: ArrayLike) -> FloatArray:
    """Points (n, 2) of a polyline without neighbours closer than ``LENGTH``."""
    points = np.asarray(line, dtype=np.float64).reshape(-1, 2)
    steps = np.hypot(*np.diff(points, axis=0).T)
    keep = np.concatenate((np.ones(min(len(points), 1), dtype=bool), steps > LENGTH))
    return np.asarray(points[keep], dtype=np.float64)


def placed_outline(pose: ArrayLike, footprint: ArrayLike) -> Any:
    """Outline of a robot as a shapely polygon in the world frame."""
    x, y, heading = np.asarray(pose, dtype=np.float64)
    c, s = math.cos(heading), math.sin(heading)
    return shapely.Polygon(np.asarray(footprint) @ np.array([[c, s], [-s, c]]) + (x, y))


def _outline_fault(outline: ArrayLike) -> str:
    """What is wrong with an outline; empty when it is simple and encloses an area."""
    points = corners(outline)
    if len(points) < 3:
        return "has fewer than three distinct corners; a polygon with area is needed"
    if is_simple(points):
        thin = least_width(points)
        return "" if thin > LENGTH else f"is only {thin:.2g} m wide; a polygon with area is needed"
    ring = shapely.Polygon(points)
    if least_width(points) <= LENGTH:
        return "encloses no area; a polygon with area is needed"
    reason = shapely.is_valid_reason(ring)
    place = reason[reason.find("[") + 1 : -1].split() if "[" in reason else []
    near = f" at ({float(place[0]):.6g}, {float(place[1]):.6g})" if len(place) == 2 else ""
    return f"crosses or touches itself{near}; the corners must go once round the outline"


def _tunnelling(world: World) -> list[Fault]:
    """Refuse (v + r |omega|) dt beyond a quarter of the smallest width: see physics, time step."""
    widths: dict[Any, float] = {}
    for robot in world.robots:
        if robot.outline not in widths:
            widths[robot.outline] = smallest_width(convex_parts(robot.outline))
    narrowest = min(world.robots, key=lambda robot: widths[robot.outline])
    limit = TUNNEL_FRACTION * widths[narrowest.outline]
    faults = []
    for i, robot in enumerate(world.robots):
        radius = circumscribed_radius(robot.outline)
        speed = robot.limits.v + radius * robot.limits.omega
        advance = speed * world.time.step
        if advance > limit:
            message = (
                f"{shown(robot.name)} could move {advance:.4g} m in one step of "
                f"{world.time.step:.6g} s (v {robot.limits.v:.6g} m/s + {radius:.4g} m x omega "
                f"{robot.limits.omega:.6g} rad/s); at most {limit:.4g} m are allowed, a quarter "
                f"of the smallest width, that of {shown(narrowest.name)}; "
                f"use a step of at most {_floored(limit / speed)} s or lower limits"
            )
            faults.append(Fault(("robots", i, "limits"), message))
    return faults


def _floored(value: float) -> str:
    """Three significant digits, rounded down."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return f"{math.floor(value / unit) * unit:.3g}"


def _wall_faults(
    world: World, placed: list[Any], walls: list[Any], solids: list[Any], accessible: Any
) -> list[Fault]:
    """Robots in or against a boundary or obstacle, or outside the accessible area."""
    tree = shapely.STRtree([*walls, *solids])
    shapely.prepare(accessible)
    near: list[list[int]] = [[] for _ in placed]
    for i, k in np.transpose(tree.query(placed, predicate="dwithin", distance=CONTACT)):
        near[i].append(int(k))
    faults = []
    for i, shape in enumerate(placed):
        where: Location = ("robots", i, "pose")
        name = shown(world.robots[i].name)
        for k in sorted(near[i])[:MOST_TOLD]:
            if k < len(walls):
                told = _boundary_message(world, shape, k, walls[k], accessible)
            else:
                told = _overlap(shape, solids[k - len(walls)], f"obstacles[{k - len(walls)}]")
            faults.append(Fault(where, f"{name} {told} at the start; move it away"))
        if not near[i] and not accessible.covers(shape):
            far = accessible.distance(shape)
            away = f", {far:.4g} m from it" if far > 0.0 else ""
            message = f"{name} starts outside the accessible area{away}; move it inside"
            faults.append(Fault(where, message))
    return faults


def _boundary_message(world: World, shape: Any, k: int, wall: Any, accessible: Any) -> str:
    label = f"boundaries[{k}]" if world.boundaries is not None else "the edge of the corridor"
    beyond = shape.difference(accessible)
    if beyond.is_empty or not shape.intersects(wall):
        return f"touches {label}"
    points = shapely.points(shapely.get_coordinates(beyond))
    reach = float(shapely.distance(points, accessible).max())
    return f"touches {label}" if reach <= CONTACT else f"reaches {reach:.4g} m over {label}"


def _overlap(a: Any, b: Any, label: str) -> str:
    """``overlaps LABEL by D m``: the least width of the common area, at most the true depth."""
    common = a.intersection(b)
    depth = least_width(shapely.get_coordinates(common)) if common.area > 0.0 else 0.0
    return f"overlaps {label} by {depth:.4g} m" if depth > CONTACT else f"touches {label}"


def _robot_faults(world: World, placed: list[Any]) -> list[Fault]:
    """Pairs of robots that overlap or touch, told at the later one."""
    tree = shapely.STRtree(placed)
    pairs = np.transpose(tree.query(placed, predicate="dwithin", distance=CONTACT))
    faults = []
    for i, j in sorted((int(i), int(j)) for i, j in pairs if i < j):
        first, second = shown(world.robots[i].name), shown(world.robots[j].name)
        told = _overlap(placed[j], placed[i], first)
        faults.append(Fault(("robots", j, "pose"), f"{second} {told} at the start; part them"))
    return faults
