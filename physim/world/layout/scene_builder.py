"""World and seed to Scene: resolve every length, number the bodies, pack the arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from physim.errors import Fault, WorldError
from physim.geometry.path import Path, project
from physim.geometry.polygon import convex_parts, signed_area
from physim.geometry.shapes import (
    FloatArray,
    IntArray,
    Polylines,
    pack_parts,
    pack_polylines,
)
from physim.geometry.timed_paths import timed_paths
from physim.geometry.walls import build_wall_tree
from physim.parts.registry import CONTROLLER, find_part, shipped_parts
from physim.units import joined
from physim.world import Robot, RobotGroup, World
from physim.world.kinds import MOST_SEED
from physim.world.layout.driven import drives_of
from physim.world.layout.layout import lay_out, placed
from physim.world.layout.robots import shared
from physim.world.run import DEFAULT_RANGE
from physim.world.scene import DENSITY, Body, FormationPlan, Layout, Scene


@np.errstate(all="ignore")  # GEOS divides by zero on the way, where lengths are as good as none
def build_scene(world: World, seed: int | None = None) -> Scene:
    """Make a world ready to run, with ``seed`` or else the world's own.

    Raises WorldError with every fault of its geometry: robots outside or overlapping, boundaries
    that enclose nothing, a step that would tunnel, ...
    """
    return scene_of(lay_out(world, seed))


@np.errstate(all="ignore")
def scene_of(laid: Layout) -> Scene:
    """Make a world that is laid out ready to run."""
    world, footprints = laid.world, laid.footprints
    walls = pack_parts(
        [
            *([line[k : k + 2] for k in range(len(line) - 1)] for line in laid.boundaries.values()),
            *(list(convex_parts(obstacle)) for obstacle in laid.obstacles),
        ]
    )
    formation = _formation(laid)
    names = [("robot", robot.name) for robot in laid.robots]
    names += [(one.kind, one.name) for one in laid.moved]
    names += [("boundary", name) for name in laid.boundaries]
    names += [("obstacle", f"obstacle {k + 1}") for k in laid.standing]
    movers = world.movers
    paths = pack_polylines(laid.paths)
    driven, most = drives_of(laid.robots, laid.entries)
    return Scene(
        world=world,
        seed=world.seed,
        dt=world.time.step,
        steps=round(world.time.duration / world.time.step),
        bodies=tuple(Body(k, kind, name) for k, (kind, name) in enumerate(names)),
        shapes=pack_parts([
            *laid.parts, *(convex_parts(one.outline) for one in laid.moved),
        ]),
        walls=walls,
        wall_tree=build_wall_tree(walls),
        mass=np.array([
            *(
                DENSITY * abs(size) if robot.mass is None else robot.mass
                for robot, size in zip(laid.robots, shared(signed_area, footprints), strict=True)
            ),
            *(one.mass for one in laid.moved),
        ]),
        limits=np.ascontiguousarray(most[:, : 3 if most[:, 2].any() else 2]),
        curvature=np.ascontiguousarray(most[:, 3]),
        braking=np.ascontiguousarray(most[:, 4]),
        drives=driven,
        start=laid.start,
        movers=timed_paths(
            [one.poses for one in movers], [one.moments for one in movers],
            [one.repeat for one in movers],
        ),
        paths=paths,
        reference=pack_polylines([laid.reference]),
        outside=tuple(shared(laid.area.outside_stretches, laid.paths)),
        speeds=tuple(robot.speeds for robot in laid.robots),
        omegas=tuple(robot.omegas for robot in laid.robots),
        stop_station=_stop_stations(paths, formation),
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
        message = f"{seed!r}; it must be a whole number from 0 to 10^15"
        raise WorldError([Fault(("seed",), message)])
    world = scene.world.model_copy(update={"seed": int(seed)})
    if not is_random(world):
        return replace(scene, world=world, seed=int(seed))
    is_drawn = any(isinstance(entry, RobotGroup) and entry.is_drawn for entry in world.robots)
    if is_drawn or world.is_road_random:
        return build_scene(scene.world, int(seed))  # footprints or roads are others, too
    laid = placed(replace(scene.layout, world=world))
    formation = _formation(laid)
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


TO_DRAW = (
    "to use the seed, write random as the heading of a robot, for example pose: [2.0, 0.0, "
    "random], or start: {region: [corners]} instead of its pose"
)
"""What to do about a world in which nothing is random"""


def is_random(world: World) -> bool:
    """Whether anything in the scene of the world is drawn by the seed."""
    return bool(_drawn(world))


def seeds_draw(world: World) -> str:
    """What rates over seeds are drawn over: ``the starts and headings``, "" where nothing is.

    Of stages it is taken that they draw; of a controller of one's own it is not known.
    """
    stages = (*world.sensing.stages, *world.filters, *world.disturbances)
    words = [*_drawn(world), *dict.fromkeys(f"noise of {stage.type}" for stage in stages)]
    return f"the {joined(words)}" if words else ""


def _drawn(world: World) -> list[str]:
    """What of the scene the seed draws."""
    starts = [world.start_of(entry) for entry in world.robots]
    poses = (entry.pose for entry in world.robots if isinstance(entry, Robot) and entry.pose)
    groups = (entry for entry in world.robots if isinstance(entry, RobotGroup))
    found = {
        "road": world.is_road_random,
        "footprints": any(group.is_drawn for group in groups),
        "starts": any(starts),
        "headings": any(one.heading == "random" for one in starts if one is not None)
        or any(pose[2] == "random" for pose in poses),
    }
    return [word for word, is_drawn in found.items() if is_drawn]


def may_vary(world: World) -> bool:
    """Whether runs of another seed may be others: the scene is, or a part may draw by the seed.

    Errs to the side of true: that a part draws nothing cannot be known. Raises ControllerError
    where the controller cannot be had.
    """
    return is_random(world) or bool(_drawing(world))


def seeds_note(world: World) -> str:
    """What is to be noted of its runs with several seeds, where only parts may draw; else ""."""
    names = ", ".join(dict.fromkeys(_drawing(world)))
    if not names or is_random(world):
        return ""
    return f"by the seed only {names} may draw: where they do not, every seed gives the same run"


def _drawing(world: World) -> tuple[str, ...]:
    """Parts that may draw: every stage, and controllers of one's own that are given the scene."""
    stages = (*world.sensing.stages, *world.filters, *world.disturbances)
    shipped = shipped_parts(CONTROLLER)
    own = (one.type for one in world.drivers() if one.type not in shipped)
    kinds = ((one, find_part(CONTROLLER, one, trusted=True)) for one in own)
    drawing = (one for one, kind in kinds if hasattr(kind, "decide_all") or hasattr(kind, "start"))
    return (*dict.fromkeys(drawing), *(stage.type for stage in stages))


def _formation(laid: Layout) -> FormationPlan:
    """Desired leads: as listed, or those of the start poses along s*."""
    n = len(laid.robots)
    plan = laid.world.formation
    if plan is None:
        none = np.zeros((0, 0), dtype=np.int64)
        return FormationPlan(False, 0.0, 1.0, 0.0, 1.0, np.zeros(n), none, DEFAULT_RANGE)
    if plan.spacing == "initial":
        path = Path(laid.reference)
        length = path.length
        station = np.array([project(path.lines, 0, x, y, 0.0, length)[0] for x, y, _ in laid.start])
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
        adjacency=_adjacency(plan.neighbours, laid.names),
        range=np.inf if plan.neighbours == "all" else plan.range,
    )


def _adjacency(
    neighbours: Literal["range", "all"] | Sequence[tuple[str, str]], names: Sequence[str]
) -> IntArray:
    """(N, N) symmetric where pairs are listed, else (0, 0)."""
    n = len(names)
    if isinstance(neighbours, str):
        return np.zeros((0, 0), dtype=np.int64)
    adjacency = np.zeros((n, n), dtype=np.int64)
    number = {name: i for i, name in enumerate(names)}
    for a, b in neighbours:
        i, j = number[a], number[b]
        adjacency[i, j] = adjacency[j, i] = 1
    return adjacency
