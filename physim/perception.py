"""What robots know: their stations along the paths, and the observation each one decides from.

Today an observation equals the truth. It holds only what Robot i may know: itself, the robots and
walls within range, and the stations of its formation neighbours, which are broadcast.
"""

from __future__ import annotations

import numpy as np

from physim.compiled import compiled
from physim.control import FormationView, Neighbour, Observation, Seen, Snapshot
from physim.geometry.nearby import parts
from physim.geometry.path import Path, track
from physim.geometry.shapes import FloatArray, IntArray, Polylines, Shapes
from physim.geometry.sight import parts_in_range
from physim.scene import Scene

SHORTEST_WINDOW = 1.0
"""[m] A projection may move at least this far along the path between two steps."""


@compiled
def track_all(
    paths: Polylines,
    reference: Polylines,
    pose: FloatArray,
    windows: FloatArray,
    station: FloatArray,
    deviation: FloatArray,
    reference_station: FloatArray,
) -> None:
    """Move every robot's projections on its own path and on s* along with its pose, in place."""
    for i in range(len(pose)):
        x, y = pose[i, 0], pose[i, 1]
        station[i], deviation[i] = track(paths, i, x, y, station[i], windows[i])
        reference_station[i], _ = track(reference, 0, x, y, reference_station[i], windows[i])


class Perception:
    """Projections of all robots, followed step by step; observations made from them.

    A projection looks at most a window along the path: two circumscribed radii of the robot, at
    least 1 m. That is more than a robot moves in a step, and less than the way between two
    branches of a path that passes near itself.
    """

    def __init__(self, scene: Scene) -> None:
        n = scene.robots
        self.scene = scene
        self.windows = np.maximum(SHORTEST_WINDOW, 2.0 * scene.shapes.radius[:n])
        self.station = np.zeros(n)
        self.deviation = np.zeros(n)
        self.reference_station = np.zeros(n)
        self._project(scene.start, np.full(n, np.inf))

    def track(self, pose: FloatArray) -> None:
        """Follow the robots to their poses (N, 3) one step later."""
        self._project(pose, self.windows)

    def _project(self, pose: FloatArray, windows: FloatArray) -> None:
        track_all(
            self.scene.paths,
            self.scene.reference,
            pose,
            windows,
            self.station,
            self.deviation,
            self.reference_station,
        )

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
