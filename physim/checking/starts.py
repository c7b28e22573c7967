"""Robots at the start: their shapes, where they stand and look, how far a step takes them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import shapely

from physim.checking.ground import Ground
from physim.checking.sketch import RobotSketch, Sketch, number
from physim.checking.telling import Told
from physim.errors import Location, WorldError
from physim.geometry.polygon import circumscribed_radius, counter_clockwise
from physim.geometry.shapes import FloatArray
from physim.start_poses import drawn_heading, start_poses
from physim.tolerances import LENGTH
from physim.world import World
from physim.world.faults import shown
from physim.world.kinds import LARGEST_COORDINATE
from physim.world_file.geometry_check import (
    Moving,
    Placed,
    outline_fault,
    placed_outline,
    robot_faults,
    tunnelling,
    wall_faults,
)


def sound_outlines(sketch: Sketch, told: Told) -> dict[int, FloatArray]:
    """Footprints that are polygons, counter-clockwise, by number of the robot."""
    known: dict[bytes, str] = {}
    outlines = {}
    for robot in sketch.robots:
        if robot.outline is None:
            continue
        key = robot.outline.tobytes()
        if key not in known:
            known[key] = outline_fault(robot.outline)
        where: Location = ("robots", robot.number, "footprint")
        if known[key]:
            told.error(where, known[key])
            continue
        outlines[robot.number] = counter_clockwise(robot.outline)
        far = shapely.Polygon(robot.outline).convex_hull.distance(shapely.Point(0.0, 0.0))
        if far > LENGTH:
            told.warn(
                where,
                f"the reference point (0, 0), about which the robot turns and which follows the "
                f"path, lies {far:.4g} m outside the footprint; corners count from that point",
            )
    return outlines


def check_expected(
    sketch: Sketch, values: Mapping[str, Any], outlines: dict[int, FloatArray], told: Told
) -> None:
    """Warn of a least distance between robots that two of them already fall below at the start."""
    expect = values.get("expect")
    wanted = expect.get("min_distance") if isinstance(expect, Mapping) else None
    least = number(wanted, 0.0, LARGEST_COORDINATE)
    shapes, names = [], []
    for robot in sketch.robots:
        heading = robot.heading if robot.heading is not None else robot.drawn
        outline = outlines.get(robot.number)
        if outline is not None and robot.position is not None and heading is not None:
            shapes.append(placed_outline(np.array([*robot.position, heading]), outline))
            names.append(robot.name)
    if least is None or len(shapes) < 2:
        return
    tree = shapely.STRtree(shapes)
    (one, other), gaps = tree.query_nearest(shapes, exclusive=True, return_distance=True)
    k = int(np.argmin(gaps))
    if gaps[k] < least - LENGTH:
        told.warn(
            ("expect", "min_distance"),
            f"{shown(names[one[k]])} and {shown(names[other[k]])} are {gaps[k]:.4g} m apart at the "
            f"start, so {least:.6g} m cannot hold",
        )


def check_step(sketch: Sketch, outlines: dict[int, FloatArray], told: Told) -> None:
    """Refuse steps in which a robot could pass through something."""
    if sketch.step is None:
        return
    moving = [
        Moving(robot.number, robot.name, outlines[robot.number], robot.v, robot.omega)
        for robot in sketch.robots
        if robot.number in outlines and robot.v is not None and robot.omega is not None
    ]
    told.errors += tunnelling(moving, sketch.step)


def placed_by_seed(
    sketch: Sketch,
    world: World | None,
    ground: Ground,
    outlines: dict[int, FloatArray],
    paths: dict[int, FloatArray],
    told: Told,
) -> Sketch:
    """The sketch with the robots that start in a region where the world's seed places them.

    They are placed as for a run, so the rest of the world must be sound.
    """
    for where, region in sketch.regions:
        if message := outline_fault(region):
            told.error(where, message)
    waiting = {robot.number for robot in sketch.robots if robot.position is None}
    area, reference = ground.area, sketch.reference
    if world is None or told.errors or not waiting or area is None or reference is None:
        return sketch
    try:
        poses = start_poses(
            world,
            sketch.seed,
            footprints=list(outlines.values()),
            paths=list(paths.values()),
            reference=reference,
            boundaries=[shapely.get_coordinates(line) for _, line in ground.walls],
            obstacles=[shapely.get_coordinates(solid)[:-1] for _, solid in ground.solids],
            accessible=area.polygon,
        )
    except WorldError as error:
        told.errors += error.faults
        return sketch
    robots = [
        replace(robot, position=(float(poses[k, 0]), float(poses[k, 1])), drawn=float(poses[k, 2]))
        if k in waiting
        else robot
        for k, robot in enumerate(sketch.robots)
    ]
    return replace(sketch, robots=tuple(robots))


def check_start_used(world: World | None, told: Told) -> None:
    """Warn of a region of the world's in which no robot starts."""
    if world is None or world.start is None:
        return
    if all(world.start_of(i) is not world.start for i in range(len(world.robots))):
        told.warn(
            ("start",),
            "no robot starts in this region, as each has a pose or a region of its own; take the "
            "pose away from those that the seed should place, or take start away",
        )


def _heading(sketch: Sketch, robot: RobotSketch) -> float:
    """Heading at the start [rad]: as written, or that of the world's seed."""
    if robot.heading is not None:
        return robot.heading
    return drawn_heading(sketch.seed, robot.number) if robot.drawn is None else robot.drawn


def check_starts(
    sketch: Sketch, ground: Ground, outlines: dict[int, FloatArray], told: Told
) -> None:
    """Every robot stands inside, apart from walls, obstacles and the others."""
    placed = []
    for robot in sketch.robots:
        if robot.number in outlines and robot.position is not None:
            pose = (*robot.position, _heading(sketch, robot))
            shape = placed_outline(pose, outlines[robot.number])
            placed.append(Placed(robot.number, robot.name, shape))
    accessible = ground.area.polygon if ground.area is not None else None
    faults = wall_faults(placed, ground.walls, ground.solids, accessible) + robot_faults(placed)
    told.errors += faults
    faulty = {fault.location[1] for fault in faults}
    _check_random_headings(sketch, ground, outlines, placed, faulty, told)


def _check_random_headings(
    sketch: Sketch,
    ground: Ground,
    outlines: dict[int, FloatArray],
    placed: list[Placed],
    faulty: set[str | int],
    told: Told,
) -> None:
    """Warn where another seed may let a robot with a random heading start in contact.

    Judged by the circle that the robot sweeps when it turns on the spot: no false comfort, but a
    warning may be too cautious for a long robot.
    """
    random = {
        robot.number for robot in sketch.robots if robot.heading is None and robot.drawn is None
    }
    turning = [
        Placed(p.number, p.name, _circle(sketch.robots[p.number], outlines[p.number]))
        if p.number in random
        else p
        for p in placed
        if p.number not in faulty
    ]
    others = [*ground.walls, *ground.solids]
    if not any(p.number in random for p in turning):
        return
    tree = shapely.STRtree([*(shape for _, shape in others), *(p.shape for p in turning)])
    names = [*(name for name, _ in others), *(shown(p.name) for p in turning)]
    shapes = [p.shape for p in turning]
    met: dict[int, str] = {}
    for i, k in np.transpose(tree.query(shapes, predicate="intersects")):
        robot = turning[i]
        itself = k == len(others) + i
        if robot.number in random and not itself:
            met.setdefault(robot.number, names[k])
    for index, name in sorted(met.items()):
        told.warn(
            ("robots", index, "pose", 2),
            f"random; with this seed {shown(sketch.robots[index].name)} starts free, with another "
            f"it may touch {name}; leave room to turn, or write a heading",
        )


def _circle(robot: RobotSketch, outline: FloatArray) -> shapely.Polygon:
    x, y = robot.position or (0.0, 0.0)
    radius = circumscribed_radius(outline)
    return shapely.Point(x, y).buffer(radius + LENGTH, quad_segs=16)


def check_headings(sketch: Sketch, paths: dict[int, FloatArray], told: Told) -> None:
    """Warn of robots that start with their backs to their path."""
    for robot in sketch.robots:
        if robot.heading is None or robot.position is None or robot.number not in paths:
            continue
        along = direction_near(paths[robot.number], robot.position)
        away = abs((robot.heading - along + pi) % (2.0 * pi) - pi)
        if away > pi / 2.0 + 1e-6 and abs(robot.heading) <= 2.0 * pi:
            told.warn(
                ("robots", robot.number, "pose", 2),
                f"{shown(robot.name)} starts facing {np.degrees(away):.0f} degrees away from its "
                f"path, which goes {along:.4g} rad there; it will have to turn round",
            )


def direction_near(path: FloatArray, position: tuple[float, float]) -> float:
    """Direction [rad] of the segment of a path that is nearest to a place."""
    a, b = path[:-1], path[1:]
    d = b - a
    share = np.clip(((position - a) * d).sum(axis=1) / (d * d).sum(axis=1), 0.0, 1.0)
    k = int(np.argmin(np.hypot(*(a + share[:, None] * d - position).T)))
    return float(np.arctan2(d[k, 1], d[k, 0]))
