"""What is known at one step: a `View`, and the observations of single robots that it makes.

An observation holds only what Robot i may know: itself, the robots and walls within range, and the
stations of its formation neighbours, which are broadcast. Most of it is made when it is asked for.
Nothing of it can change: arrays of a step and of a scene never do once they are handed out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from math import inf
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import DTypeLike

from physim.geometry.motion import twists
from physim.geometry.path import Path
from physim.geometry.shapes import FloatArray, IntArray, Shapes, read_only
from physim.geometry.walls import parts_within
from physim.parts.controller import (
    FormationView,
    Neighbour,
    Observation,
    ObservedRobot,
    Sensed,
    Vehicle,
    Wall,
)
from physim.parts.drive import PLAIN
from physim.simulation.arrays import Arrays, Layout, arrays_of, layout_of, unchanging
from physim.simulation.driving import reachable
from physim.world.scene import Scene

T = TypeVar("T")

SIDES: tuple[Literal["left", "right", "outside"] | None, ...] = (None, "left", "right", "outside")
"""by `physim.world.ground.pieces`"""


def formation_errors(scene: Scene, reference_station: FloatArray) -> FloatArray:
    """(…, N) [m] distance to the robots' mean place on s* less its desired value."""
    station, lead = reference_station, scene.formation.lead
    return np.asarray((station.mean(axis=-1, keepdims=True) - station) - (lead.mean() - lead))


class View:
    """What is known at one step: the ``scene``, the ``sensed`` rows of it, and the ``time`` [s].

    Observer i has ``rows(i)`` of the sensed ones, one of itself among them. It may use those of
    ``others(i)``, which are within range, of ``neighbours(i)`` the stations along the reference
    path, and of the scene's walls the pieces ``walls(i)``; ``observation(i)`` is just that. Nothing
    may be written to.
    """

    def __init__(self, scene: Scene, sensed: Sensed, like: View | None = None) -> None:
        """View of a scene at a step; ``like``, one of the same scene, has what all steps share."""
        self.scene, self.sensed = scene, sensed
        self.time: float = sensed.step * scene.dt
        self._shared: _SceneFacts = _SceneFacts(scene) if like is None else like._shared
        self._robots: dict[int, ObservedRobot] = {}
        self._neighbours: dict[int, Neighbour] = {}
        self._reach: dict[float, FloatArray] = {}

    def rows(self, i: int) -> slice:
        """Rows of ``sensed`` that observer i has."""
        return self.sensed.rows(i)

    def own_row(self, i: int) -> int:
        """Its row of itself."""
        rows = self.rows(i)
        return int(rows.start + (self.sensed.robot[rows] == i).argmax())

    def others(self, i: int) -> IntArray:
        """Its rows of other robots, and of all else that moves, within range, increasing."""
        sensed, rows, own, reach = (
            self.sensed,
            self.rows(i),
            self.own_row(i),
            self.scene.sensing_range,
        )
        x, y, _ = sensed.pose[own]
        dx, dy = sensed.pose[rows, 0] - x, sensed.pose[rows, 1] - y
        near = dx * dx + dy * dy <= reach * reach
        near[own - rows.start] = False
        return np.asarray(rows.start + near.nonzero()[0])

    def neighbours(self, i: int) -> IntArray:
        """Its rows of formation neighbours, increasing; they may be beyond the range."""
        sensed, rows, own, plan = self.sensed, self.rows(i), self.own_row(i), self.scene.formation
        if not plan.active:
            return np.zeros(0, dtype=np.int64)
        robot, robots = sensed.robot[rows], self.scene.robots
        if plan.adjacency.shape[0]:
            near = (plan.adjacency[i][np.minimum(robot, robots - 1)] != 0) & (robot < robots)
        else:
            station = sensed.reference_station
            near = (np.abs(station[rows] - station[own]) <= plan.range) & (robot < robots)
        near[own - rows.start] = False
        return np.asarray(rows.start + near.nonzero()[0])

    def walls(self, i: int) -> IntArray:
        """Numbers of the pieces of walls within range of its reference point, where it senses that
        to be; increasing, as ``observation(i).walls``."""
        x, y, _ = self.sensed.pose[self.own_row(i)]
        return parts_within(self.scene.wall_tree, x, y, self.scene.sensing_range)

    def prepared(self, make: Callable[[Scene], T]) -> T:
        """What ``make(scene)`` gives, made once for all steps of a run and every robot.

        ``make`` is a function or a method of the controller's. What it gives is not part of the
        state of a simulation: a copy makes its own, so it must follow from scene and settings
        alone, and nothing that a decision depends on may be written to it.
        """
        found = self._shared.prepared
        if make not in found:
            found[make] = make(self.scene)
        value: T = found[make]
        return value

    def arrays(
        self,
        others: int = 4,
        walls: int = 4,
        ahead: Sequence[float] = (1.0, 2.0),
        dtype: DTypeLike = np.float32,
    ) -> Arrays:
        """What all robots may know, as `physim.simulation.arrays.Arrays` of fixed sizes.

        Of each robot the ``others`` nearest robots and ``walls`` nearest parts of walls within
        range, and points ``ahead`` [m] on its path. ``dtype`` is float32 or float64; what is
        computed is float64. Raises PhysimError for sizes that are no whole numbers from 0 to 1000,
        and for points that are not ahead.
        """
        points = ahead if type(ahead) is tuple else repr(ahead)
        asked = others, walls, points, dtype
        known, layout = self._shared.layout
        if known != asked or layout is None:
            layout = layout_of(others, walls, ahead, dtype)
            self._shared.layout = asked, layout
        return arrays_of(self.prepared(unchanging), self.sensed, layout)

    def observation(self, i: int) -> Observation:
        """What Robot i may know."""
        sensed, own = self.sensed, self.own_row(i)
        values = self._shared.facts(i).copy()
        values["time"] = self.time
        values["pose"] = read_only(sensed.pose[own].copy())
        values["v"], values["omega"], *lateral = sensed.command[own].tolist()
        values["lateral"] = lateral[0] if lateral else 0.0
        values["velocity"] = read_only(sensed.velocity[own].copy())
        values["station"] = sensed.station.item(i)
        values["reference_station"] = sensed.reference_station.item(own)
        return Observation.partly(values, self)

    def later(self, i: int, field: str) -> Any:
        """A field of the observation of Robot i that is made when it is asked for."""
        if field == "footprint":
            return self._shared.footprint(i)
        if field == "path":
            return self._shared.path(i)
        if field == "vehicle":
            return self._vehicle(i)
        if field == "walls":
            return tuple(map(self._shared.wall, self.walls(i).tolist()))
        if field == "others":
            return tuple(map(self._robot, self.others(i).tolist()))
        return tuple(map(self._neighbour, self.neighbours(i).tolist()))

    def reach(self, time: float) -> FloatArray:
        """(N, 6) what robots can come to within a time [s]: least and greatest v [m/s], omega
        [rad/s] and curvature [1/m]. Each may know its own row alone."""
        if time not in self._reach:
            self._reach[time] = read_only(reachable(self.scene, self.sensed.drive, time))
        return self._reach[time]

    def _vehicle(self, i: int) -> Vehicle:
        """Of Robot i; one without drive does what it was last commanded to."""
        sensed, drives = self.sensed, self.scene.drives
        row = sensed.drive[i] if drives else twists(sensed.command[self.own_row(i)][None])[0]
        v, omega, lateral, *steering = row.tolist()
        name = next((one.type for one in drives if i in one.robots), PLAIN)
        return Vehicle(
            name, v, omega, lateral, steering[0] if steering else 0.0, self.scene.braking.item(i),
            lambda time: tuple(self.reach(time)[i].tolist()),
        )  # fmt: skip

    def _robot(self, row: int) -> ObservedRobot:
        """Of a row; what several see of one is made once for all of them."""
        if row not in self._robots:
            sensed = self.sensed
            j, (v, omega, *lateral) = sensed.robot.item(row), sensed.command[row].tolist()
            self._robots[row] = ObservedRobot(
                j,
                read_only(sensed.pose[row].copy()),
                self._shared.footprint(j),
                v,
                omega,
                read_only(sensed.velocity[row].copy()),
                sensed.reference_station.item(row),
                self.time - sensed.age.item(row),
                self.scene.bodies[j].kind,  # type: ignore[arg-type]  # of what moves
                lateral[0] if lateral else 0.0,
            )
        return self._robots[row]

    def _neighbour(self, row: int) -> Neighbour:
        if row not in self._neighbours:
            sensed = self.sensed
            j, station = sensed.robot.item(row), sensed.reference_station.item(row)
            lead, age = self.scene.formation.lead.item(j), sensed.heard.item(row)
            age = sensed.age.item(row) if age == inf else age
            self._neighbours[row] = Neighbour(j, station, lead, self.time - age)
        return self._neighbours[row]


class _SceneFacts:
    """What views of all steps of a scene share, made when it is first needed."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.prepared: dict[Callable[[Scene], Any], Any] = {}
        self.layout: tuple[Any, Layout | None] = None, None
        """of the arrays that were asked for last"""
        plan = scene.formation
        self.formation = FormationView(plan.active, plan.gain, plan.speed, plan.v_min, plan.v_max)
        self.facts, self.footprint = cache(self._facts), cache(self._footprint)
        self.path, self.wall = cache(self._path), cache(self._wall)

    def _facts(self, i: int) -> dict[str, Any]:
        """Fields of observations of Robot i that stay as they are."""
        scene = self.scene
        return {
            "index": i,
            "name": scene.names[i],
            "limits": (float(scene.limits[i, 0]), float(scene.limits[i, 1])),
            "stop_station": float(scene.stop_station[i]),
            "lead": float(scene.formation.lead[i]),
            "range": scene.sensing_range,
            "dt": scene.dt,
            "formation": self.formation,
            "speeds": scene.speeds[i],
            "omegas": scene.omegas[i],
        }

    def _footprint(self, i: int) -> tuple[FloatArray, ...]:
        """Convex parts (n, 2) of Robot i, or another body that moves, read-only."""
        shapes = self.scene.shapes
        return tuple(
            _part(shapes, p) for p in range(shapes.body_start[i], shapes.body_start[i + 1])
        )

    def _path(self, i: int) -> Path:
        """Path of Robot i."""
        paths = self.scene.paths
        return Path(paths.points[paths.start[i] : paths.start[i + 1]], self.scene.outside[i])

    def _wall(self, part: int) -> Wall:
        """A part of a wall."""
        before, after = (None if one < 0 else one for one in self.scene.pieces.joins[part].tolist())
        free = SIDES[self.scene.pieces.free[part]]
        return Wall(part, _part(self.scene.walls, part), before, after, free)


def _part(shapes: Shapes, part: int) -> FloatArray:
    """Vertices (n, 2) of a part, read-only."""
    return read_only(shapes.vertices[shapes.part_start[part] : shapes.part_start[part + 1]].copy())
