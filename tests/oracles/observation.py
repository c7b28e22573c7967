"""An observation whole and at once: everybody and every wall is looked at, robot by robot."""

from __future__ import annotations

import itertools

import numpy as np

from physim import (
    FormationView,
    Neighbour,
    Observation,
    ObservedRobot,
    Scene,
    Sensed,
    Vehicle,
    Wall,
)
from physim.geometry import Shapes
from tests.helpers import inside

Path, outline_distance = inside("physim.geometry", "Path", "outline_distance")
FloatArray, IntArray, Part = inside("physim.geometry", "FloatArray", "IntArray", "Part")


def observe(scene: Scene, sensed: Sensed, i: int) -> Observation:
    """What Robot i may know at a step, from what it senses."""
    plan, reach = scene.formation, scene.sensing_range
    rows = sensed.rows(i)
    known = sensed.robot[rows]
    pose, station = sensed.pose[rows], sensed.reference_station[rows]
    command, age, heard = sensed.command[rows], sensed.age[rows], sensed.heard[rows]
    velocity = sensed.velocity[rows]
    me = int(np.flatnonzero(known == i)[0])
    time = sensed.step * scene.dt
    x, y = pose[me, 0], pose[me, 1]
    in_range = np.square(pose[:, :2] - pose[me, :2]).sum(axis=1) <= reach * reach
    in_range[me] = False
    parts = itertools.pairwise(scene.walls.part_start)
    near = [outline_distance(Part(scene.walls.vertices, *part), x, y) <= reach for part in parts]
    walls = np.flatnonzero(near).tolist()
    first, end = scene.paths.start[i], scene.paths.start[i + 1]
    return Observation(
        time=time,
        index=i,
        name=scene.names[i],
        pose=_read_only(pose[me]),
        v=float(command[me, 0]),
        omega=float(command[me, 1]),
        velocity=_read_only(velocity[me]),
        footprint=_footprint(scene, i),
        limits=(float(scene.limits[i, 0]), float(scene.limits[i, 1])),
        path=Path(scene.paths.points[first:end], scene.outside[i].copy()),
        station=float(sensed.station[i]),
        stop_station=float(scene.stop_station[i]),
        reference_station=float(station[me]),
        lead=float(plan.lead[i]),
        neighbours=tuple(
            Neighbour(
                index=int(known[row]),
                station=float(station[row]),
                lead=float(plan.lead[known[row]]),
                time=time - float(heard[row]),
            )
            for row in (_neighbours(scene, i, me, known, station) if plan.active else ())
        ),
        others=tuple(
            ObservedRobot(
                index=int(known[row]),
                pose=_read_only(pose[row]),
                footprint=_footprint(scene, int(known[row])),
                v=float(command[row, 0]),
                omega=float(command[row, 1]),
                velocity=_read_only(velocity[row]),
                station=float(station[row]),
                time=time - float(age[row]),
            )
            for row in np.flatnonzero(in_range)
        ),
        walls=tuple(_wall(scene, p) for p in walls),
        range=reach,
        dt=scene.dt,
        formation=FormationView(plan.active, plan.gain, plan.speed, plan.v_min, plan.v_max),
        vehicle=Vehicle(
            "unicycle", float(command[me, 0]), float(command[me, 1]), 0.0, 0.0, float("inf"), None
        ),
        speeds=scene.speeds[i],
        omegas=scene.omegas[i],
    )


def _wall(scene: Scene, part: int) -> Wall:
    """A piece of a wall."""
    points, free = _part(scene.walls, part), scene.pieces.free[part]
    joins = [None if one < 0 else int(one) for one in scene.pieces.joins[part]]
    return Wall(part, points, *joins, (None, "left", "right", "outside")[free])


def _neighbours(scene: Scene, i: int, me: int, known: IntArray, station: FloatArray) -> IntArray:
    """Rows of the robots in N_i, increasing."""
    plan = scene.formation
    if plan.adjacency.shape[0]:
        near = plan.adjacency[i][known] != 0
    else:
        near = np.abs(station - station[me]) <= plan.range
    near[me] = False
    return np.flatnonzero(near)


def _footprint(scene: Scene, i: int) -> tuple[FloatArray, ...]:
    shapes = scene.shapes
    return tuple(_part(shapes, p) for p in range(shapes.body_start[i], shapes.body_start[i + 1]))


def _part(shapes: Shapes, part: int) -> FloatArray:
    """Vertices (n, 2) of a part, read-only."""
    return _read_only(shapes.vertices[shapes.part_start[part] : shapes.part_start[part + 1]])


def _read_only(array: FloatArray) -> FloatArray:
    copy = array.copy()
    copy.flags.writeable = False
    return copy
