"""What robots know: their stations along the paths, and the observation each one decides from.

Today an observation equals the truth. It holds only what Robot i may know: itself, the robots and
walls within range, and the stations of its formation neighbours, which are broadcast.
"""

from __future__ import annotations

import numpy as np

from physim.control import FormationView, Neighbour, Observation, Seen, Snapshot
from physim.geometry.nearby import parts
from physim.geometry.path import Path
from physim.geometry.shapes import FloatArray, IntArray, Shapes
from physim.geometry.sight import parts_in_range
from physim.geometry.tracking import Tracking
from physim.scene import Scene


class Perception:
    """Projections of all robots, followed step by step; observations made from them."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._tracking = Tracking(
            scene.paths, scene.reference, scene.shapes.radius[: scene.robots], scene.start
        )
        self.station = self._tracking.station
        self.deviation = self._tracking.deviation
        self.reference_station = self._tracking.reference_station

    def track(self, pose: FloatArray) -> None:
        """Follow the robots to their poses (N, 3) one step later."""
        self._tracking.follow(pose)

    def formation_errors(self) -> FloatArray:
        """(N,) [m] distance to the robots' mean place on s* less its desired value."""
        station, lead = self.reference_station, self.scene.formation.lead
        return np.asarray((station.mean() - station) - (lead.mean() - lead))

    def neighbours(self, i: int) -> IntArray:
        """Robots in N_i, increasing."""
        plan, s = self.scene.formation, self.reference_station
        if plan.adjacency.shape[0]:
            near = plan.adjacency[i] != 0
        else:
            near = np.abs(s - s[i]) <= plan.range
        near[i] = False
        return np.flatnonzero(near)

    def observe(self, i: int, snapshot: Snapshot) -> Observation:
        """What Robot i may know at the snapshot's step."""
        scene, plan = self.scene, self.scene.formation
        time = snapshot.step * scene.dt
        x, y = snapshot.pose[i, 0], snapshot.pose[i, 1]
        gaps = np.square(snapshot.pose[:, :2] - snapshot.pose[i, :2]).sum(axis=1)
        in_range = gaps <= plan.range * plan.range
        in_range[i] = False
        walls = parts_in_range(scene.walls, parts(scene.nearby, x, y), x, y, plan.range)
        first, end = scene.paths.start[i], scene.paths.start[i + 1]
        return Observation(
            time=time,
            index=i,
            name=scene.names[i],
            pose=_read_only(snapshot.pose[i]),
            v=float(snapshot.command[i, 0]),
            omega=float(snapshot.command[i, 1]),
            footprint=self._footprint(i),
            limits=(float(scene.limits[i, 0]), float(scene.limits[i, 1])),
            path=Path(scene.paths.points[first:end], scene.outside[i].copy()),
            station=float(snapshot.station[i]),
            stop_station=float(scene.stop_station[i]),
            reference_station=float(snapshot.reference_station[i]),
            lead=float(plan.lead[i]),
            neighbours=tuple(
                Neighbour(
                    index=int(j),
                    station=float(snapshot.reference_station[j]),
                    lead=float(plan.lead[j]),
                    time=time,
                )
                for j in (self.neighbours(i) if plan.active else ())
            ),
            others=tuple(self._seen(int(j), snapshot, time) for j in np.flatnonzero(in_range)),
            walls=tuple(_part(scene.walls, p) for p in walls),
            range=plan.range,
            dt=scene.dt,
            formation=FormationView(plan.active, plan.gain, plan.speed, plan.v_min, plan.v_max),
            speeds=scene.speeds[i],
            omegas=scene.omegas[i],
        )

    def _seen(self, j: int, snapshot: Snapshot, time: float) -> Seen:
        return Seen(
            index=j,
            pose=_read_only(snapshot.pose[j]),
            footprint=self._footprint(j),
            v=float(snapshot.command[j, 0]),
            omega=float(snapshot.command[j, 1]),
            station=float(snapshot.reference_station[j]),
            time=time,
        )

    def _footprint(self, i: int) -> tuple[FloatArray, ...]:
        shapes = self.scene.shapes
        parts = range(shapes.body_start[i], shapes.body_start[i + 1])
        return tuple(_part(shapes, p) for p in parts)


def _part(shapes: Shapes, part: int) -> FloatArray:
    """Vertices (n, 2) of a part, read-only."""
    return _read_only(shapes.vertices[shapes.part_start[part] : shapes.part_start[part + 1]])


def _read_only(array: FloatArray) -> FloatArray:
    copy = array.copy()
    copy.flags.writeable = False
    return copy
