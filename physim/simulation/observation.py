"""What robots know when they decide: observations made from what is sensed.

An observation holds only what Robot i may know: itself, the robots and walls within range, and the
stations of its formation neighbours, which are broadcast.

`Sight` is made once for a scene, `Views` once for a step. Most of an observation is made when it is
asked for; what several robots see of one is made once for all of them. Nothing of it can change:
arrays of a step and of a scene never do once they are handed out.
"""

from __future__ import annotations

from functools import cache, cached_property, partial
from typing import Any

import numpy as np

from physim.geometry.neighbours import rows_in_range, sorted_places, window_along
from physim.geometry.path import Path
from physim.geometry.shapes import FloatArray, IntArray, Shapes, read_only
from physim.geometry.walls import parts_within
from physim.parts.controller import FormationView, Neighbour, Observation, ObservedRobot, Sensed
from physim.world.scene import Scene


def formation_errors(scene: Scene, reference_station: FloatArray) -> FloatArray:
    """(…, N) [m] distance to the robots' mean place on s* less its desired value."""
    station, lead = reference_station, scene.formation.lead
    return np.asarray((station.mean(axis=-1, keepdims=True) - station) - (lead.mean() - lead))


FEW = 32
"""Rows of so many are looked at one by one: to sort them would take longer."""


class Sight:
    """What observations have in common at all steps of a scene, made when it is first needed."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        plan = scene.formation
        self.formation = FormationView(plan.active, plan.gain, plan.speed, plan.v_min, plan.v_max)
        self.facts, self.footprint = cache(self._facts), cache(self._footprint)
        self.path, self.wall = cache(self._path), cache(partial(_part, scene.walls))

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
        """Convex parts (n, 2) of Robot i, read-only."""
        shapes = self.scene.shapes
        return tuple(
            _part(shapes, p) for p in range(shapes.body_start[i], shapes.body_start[i + 1])
        )

    def _path(self, i: int) -> Path:
        """Path of Robot i."""
        paths = self.scene.paths
        return Path(paths.points[paths.start[i] : paths.start[i + 1]], self.scene.outside[i])

    def walls_near(self, x: float, y: float) -> tuple[FloatArray, ...]:
        """Parts of walls (n, 2) within range of a place, read-only."""
        scene = self.scene
        parts = parts_within(scene.wall_tree, x, y, scene.sensing_range)
        return tuple(map(self.wall, parts.tolist()))


class Views:
    """Observations of robots ``due`` (increasing) at one step."""

    def __init__(self, sight: Sight, sensed: Sensed, due: IntArray) -> None:
        self.sight = sight
        self.sensed = sensed
        self.due = due
        self.time = sensed.step * sight.scene.dt
        self._neighbour = cache(self._made_neighbour)

    def observation(self, i: int) -> Observation:
        """What Robot i, one of those that are due, may know."""
        sensed, own = self.sensed, self._own_row(i)
        values = self.sight.facts(i).copy()
        values["time"] = self.time
        values["pose"] = read_only(sensed.pose[own].copy())
        values["v"], values["omega"] = sensed.command[own].tolist()
        values["velocity"] = read_only(sensed.velocity[own].copy())
        values["station"] = sensed.station.item(i)
        values["reference_station"] = sensed.reference_station.item(own)
        return Observation.partly(values, partial(self._make, i))

    def _make(self, i: int, field: str) -> Any:
        """A field of `physim.parts.controller.LATER`."""
        if field == "footprint":
            return self.sight.footprint(i)
        if field == "path":
            return self.sight.path(i)
        if field == "walls":
            x, y, _ = self.sensed.pose[self._own_row(i)]
            return self.sight.walls_near(x, y)
        if field == "neighbours":
            return tuple(map(self._neighbour, self._neighbour_rows(i)))
        start, found = self._in_range
        k = self._position[i]
        rows = np.sort(found[start[k] : start[k + 1]]).tolist()
        return tuple(map(self._robots.__getitem__, rows))

    @cached_property
    def _robots(self) -> dict[int, ObservedRobot]:
        """Robots as they are seen in the rows that are within range of anybody."""
        sensed = self.sensed
        rows = np.unique(self._in_range[1])
        robots = sensed.robot[rows].tolist()
        return {
            row: ObservedRobot(j, pose, shape, v, omega, velocity, station, time)
            for row, j, pose, shape, (v, omega), velocity, station, time in zip(
                rows.tolist(),
                robots,
                read_only(sensed.pose[rows]),
                map(self.sight.footprint, robots),
                sensed.command[rows].tolist(),
                read_only(sensed.velocity[rows]),
                sensed.reference_station[rows].tolist(),
                (self.time - sensed.age[rows]).tolist(),
                strict=True,
            )
        }

    def _made_neighbour(self, row: int) -> Neighbour:
        sensed = self.sensed
        j = int(sensed.robot[row])
        return Neighbour(
            index=j,
            station=float(sensed.reference_station[row]),
            lead=float(self.sight.scene.formation.lead[j]),
            time=self.time - float(sensed.age[row]),
        )

    # Rows of what is sensed

    @cached_property
    def _position(self) -> dict[int, int]:
        """Where each of those that are due stands among them."""
        return {i: k for k, i in enumerate(self.due.tolist())}

    @cached_property
    def _is_shared(self) -> bool:
        """Whether all observers have the same rows."""
        first, end = self.sensed.first, self.sensed.end
        return bool((first == first[0]).all() and (end == end[0]).all())

    @cached_property
    def _row_of(self) -> IntArray:
        """(N,) row of each robot, where all observers have the same rows."""
        rows = self.sensed.rows(0)
        row_of = np.zeros(self.sight.scene.robots, dtype=np.int64)
        row_of[self.sensed.robot[rows]] = np.arange(rows.start, rows.stop)
        return row_of

    def _own_row(self, i: int) -> int:
        if self._is_shared:
            return int(self._row_of[i])
        rows = self.sensed.rows(i)
        return int(rows.start + np.flatnonzero(self.sensed.robot[rows] == i)[0])

    @cached_property
    def _in_range(self) -> tuple[IntArray, IntArray]:
        """Rows within range of all that are due, as `rows_in_range` has them."""
        sensed, reach = self.sensed, self.sight.scene.sensing_range
        own = np.array([self._own_row(i) for i in self.due.tolist()])
        low, high = sensed.first[self.due], sensed.end[self.due]
        rows = sensed.rows(0)
        if self._is_shared and rows.stop - rows.start > FEW:
            order, axis = sorted_places(sensed.pose[rows])
            order += rows.start
            place = sensed.pose[:, axis]
            low, high = window_along(place[order], place[own], reach)
        else:
            order = np.arange(len(sensed.pose))
        return rows_in_range(sensed.pose, order, low, high, own, reach)

    @cached_property
    def _along(self) -> tuple[IntArray, FloatArray]:
        """Rows that all share in order along s*, and their stations there."""
        rows = self.sensed.rows(0)
        order = rows.start + np.argsort(self.sensed.reference_station[rows], kind="stable")
        return order, self.sensed.reference_station[order]

    def _neighbour_rows(self, i: int) -> list[int]:
        """Rows of the robots in N_i, increasing."""
        plan, station = self.sight.scene.formation, self.sensed.reference_station
        if not plan.active:
            return []
        own, rows = self._own_row(i), self.sensed.rows(i)
        among = np.arange(rows.start, rows.stop)
        if plan.adjacency.shape[0]:
            near = plan.adjacency[i][self.sensed.robot[rows]] != 0
        else:
            if self._is_shared:
                order, along = self._along
                low, high = window_along(along, station[own : own + 1], plan.range)
                among = np.sort(order[low[0] : high[0]])
            near = np.abs(station[among] - station[own]) <= plan.range
        found: list[int] = among[near & (among != own)].tolist()
        return found


def _part(shapes: Shapes, part: int) -> FloatArray:
    """Vertices (n, 2) of a part, read-only."""
    return read_only(shapes.vertices[shapes.part_start[part] : shapes.part_start[part + 1]].copy())
