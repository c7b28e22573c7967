"""World and seed to Scene: resolve every length, number the bodies, pack the arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from physim.errors import Fault, WorldError
from physim.geometry.area import Area, accessible_area
from physim.geometry.corridor import corridor_boundaries, offset_polyline
from physim.geometry.nearby import build_nearby
from physim.geometry.path import Path
from physim.geometry.polygon import convex_parts, counter_clockwise, signed_area
from physim.geometry.shapes import (
    FloatArray,
    IntArray,
    Polylines,
    pack_polylines,
    pack_shapes,
)
from physim.scene import DENSITY, Body, FormationPlan, Layout, Scene
from physim.start_poses import start_poses
from physim.world import Offset, World
from physim.world.kinds import MOST_SEED
from physim.world.stages import DEFAULT_RANGE
from physim.world_file.geometry_check import path_faults, shape_faults, start_faults

GRID_CELL = 2.0
"""[m] cell of the wall look-up"""


def lay_out(world: World, seed: int | None = None) -> Layout:
    """Resolve every length of a world, with ``seed`` or else the world's own.

    Raises WorldError as `build_scene` does.
    """
    world = world if seed is None else world.changed(seed=seed)
    if faults := shape_faults(world):
        raise WorldError(faults)
    drawn = _boundaries(world)
    reference = np.array(world.reference)
    obstacles = [np.array(ring) for ring in world.obstacles]
    area = _area(list(drawn.values()), obstacles, reference)
    outside = area.outside_stretches(reference)
    if len(outside):
        key = "reference_path" if world.reference_path is not None else "corridor"
        raise WorldError([Fault((key,), _leaves(outside))])
    footprints = [counter_clockwise(np.array(robot.outline)) for robot in world.robots]
    paths = [_path(world, i, reference) for i in range(len(world.robots))]
    nowhere = np.zeros((len(world.robots), 3))
    return _placed(
        Layout(world, drawn, obstacles, reference, area, footprints, paths, nowhere), world
    )


def _placed(laid: Layout, world: World) -> Layout:
    """Layout with the robots where the seed of ``world`` puts them; WorldError where it cannot."""
    ground = {
        "footprints": laid.footprints,
        "boundaries": list(laid.boundaries.values()),
        "obstacles": laid.obstacles,
        "accessible": laid.area.polygon,
    }
    start = start_poses(world, world.seed, paths=laid.paths, reference=laid.reference, **ground)
    faults = path_faults(world, laid.paths, laid.area.polygon)
    if faults := [*faults, *start_faults(world, start=start, **ground)]:
        raise WorldError(faults)
    return replace(laid, world=world, start=start)


def build_scene(world: World, seed: int | None = None) -> Scene:
    """Make a world ready to run, with ``seed`` or else the world's own.

    Raises WorldError with every fault of its geometry: robots outside or overlapping, boundaries
    that enclose nothing, a step that would tunnel, ...
    """
    laid = lay_out(world, seed)
    world, area, start, reference = laid.world, laid.area, laid.start, laid.reference
    drawn, obstacles, footprints, paths = (
        laid.boundaries, laid.obstacles, laid.footprints, laid.paths,
    )  # fmt: skip
    parts = [convex_parts(f) for f in footprints]
    walls = pack_shapes(
        [_segments(line) for line in drawn.values()] + [list(convex_parts(o)) for o in obstacles]
    )
    formation = _formation(world, start, reference)
    names = [("robot", robot.name) for robot in world.robots]
    names += [("boundary", name) for name in drawn]
    names += [("obstacle", f"obstacle {k + 1}") for k in range(len(obstacles))]
    packed_paths = pack_polylines(paths)
    return Scene(
        world=world,
        seed=world.seed,
        dt=world.time.step,
        steps=round(world.time.duration / world.time.step),
        bodies=tuple(Body(k, kind, name) for k, (kind, name) in enumerate(names)),
        shapes=pack_shapes(parts),
        walls=walls,
        nearby=build_nearby(walls, world.sensing_range, GRID_CELL),
        mass=np.array([_mass(r.mass, f) for r, f in zip(world.robots, footprints, strict=True)]),
        limits=np.array([(robot.limits.v, robot.limits.omega) for robot in world.robots]),
        start=start,
        paths=packed_paths,
        reference=pack_polylines([reference]),
        outside=tuple(area.outside_stretches(path) for path in paths),
        speeds=tuple(robot.speeds for robot in world.robots),
        omegas=tuple(robot.omegas for robot in world.robots),
        stop_station=_stop_stations(packed_paths, formation),
        formation=formation,
        sensing_range=world.sensing_range,
        arrival_tolerance=world.arrival.tolerance,
        layout=laid,
    )  # fmt: skip


def reseeded(scene: Scene, seed: int) -> Scene:
    """Scene of the same world with another seed: only what the seed decides is made anew.

    Raises WorldError where the seed is none or the robots cannot be placed.
    """
    if (
        isinstance(seed, bool)
        or not isinstance(seed, int | np.integer)
        or not (0 <= seed <= MOST_SEED)
    ):
        raise WorldError([Fault(("seed",), f"{seed!r}; it must be a whole number from 0 on")])
    world = scene.world.model_copy(update={"seed": int(seed)})
    if not is_random(world):
        return replace(scene, world=world, seed=int(seed))
    laid = _placed(scene.layout, world)
    formation = _formation(world, laid.start, laid.reference)
    return replace(
        scene,
        world=world,
        seed=int(seed),
        start=laid.start,
        stop_station=_stop_stations(scene.paths, formation),
        formation=formation,
        layout=laid,
    )


def _stop_stations(paths: Polylines, formation: FormationPlan) -> FloatArray:
    ends = paths.station[paths.start[1:] - 1]
    return np.asarray(np.maximum(ends - (formation.lead.max() - formation.lead), 0.0))


def is_random(world: World) -> bool:
    """Whether anything in the world is drawn by the seed."""
    return any(robot.pose is None or robot.pose[2] == "random" for robot in world.robots)


def _boundaries(world: World) -> dict[str, FloatArray]:
    """Boundary polylines by name, in the order of their ids."""
    if world.corridor is None:
        lines = world.boundaries or ()
        return {f"boundary {k + 1}": np.array(line) for k, line in enumerate(lines)}
    centreline = np.array(world.corridor.centreline)
    width = np.broadcast_to(np.array(world.corridor.width, dtype=np.float64), len(centreline))
    try:
        return corridor_boundaries(centreline, width, world.corridor.end_margin)
    except ValueError as error:
        fault = Fault(("corridor", "centreline"), f"the centreline {error}")
        raise WorldError([fault]) from None


def _area(drawn: list[FloatArray], obstacles: list[FloatArray], reference: FloatArray) -> Area:
    try:
        return accessible_area(drawn, obstacles, reference)
    except ValueError as error:
        message = f"{error}; boundaries must close a face around the reference path"
        raise WorldError([Fault(("boundaries",), message)]) from None


def _leaves(outside: FloatArray) -> str:
    first, last = outside[0]
    return (
        f"the reference path leaves the accessible area from {first:.2f} m to {last:.2f} m along "
        "it; it must lie between the boundaries and beside the obstacles"
    )


def _path(world: World, i: int, reference: FloatArray) -> FloatArray:
    path = world.robots[i].path
    if not isinstance(path, Offset):
        return np.array(path)
    try:
        return offset_polyline(reference, np.full(len(reference), path.offset))
    except ValueError as error:
        fault = Fault(("robots", i, "path", "offset"), f"the reference path {error}")
        raise WorldError([fault]) from None


def _segments(line: FloatArray) -> list[FloatArray]:
    return [line[k : k + 2] for k in range(len(line) - 1)]


def _mass(given: float | None, footprint: FloatArray) -> float:
    return DENSITY * abs(signed_area(footprint)) if given is None else given


def _formation(world: World, start: FloatArray, reference: FloatArray) -> FormationPlan:
    """Desired leads: as listed, or those of the start poses along s*."""
    n = len(start)
    plan = world.formation
    if plan is None:
        none = np.zeros((0, 0), dtype=np.int64)
        return FormationPlan(False, 0.0, 1.0, 0.0, 1.0, np.zeros(n), none, DEFAULT_RANGE)
    if plan.spacing == "initial":
        path = Path(reference)
        station = np.array([path.project(x, y)[0] for x, y, _ in start])
        lead = station - station[0]
    else:
        lead = np.array(plan.spacing)
    return FormationPlan(
        active=True,
        gain=plan.gain,
        speed=plan.speed,
        v_min=plan.limits[0],
        v_max=plan.limits[1],
        lead=lead,
        adjacency=_adjacency(plan.neighbours, [robot.name for robot in world.robots]),
        range=plan.range,
    )


def _adjacency(
    neighbours: Literal["range", "all"] | Sequence[tuple[str, str]], names: Sequence[str]
) -> IntArray:
    """(N, N) symmetric, or (0, 0) when neighbours are those within range."""
    n = len(names)
    if neighbours == "range":
        return np.zeros((0, 0), dtype=np.int64)
    if neighbours == "all":
        return np.ones((n, n), dtype=np.int64) - np.eye(n, dtype=np.int64)
    adjacency = np.zeros((n, n), dtype=np.int64)
    for pair in neighbours:
        a, b = pair
        i, j = names.index(a), names.index(b)
        adjacency[i, j] = adjacency[j, i] = 1
    return adjacency
