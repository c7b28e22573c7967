"""Scenes for the tests of controllers, and the one place that asks the paper's.

A `History` is one layout with several moments: the robots decide at each, with the memory of the
moment before. What the oracles need is in `tests.oracles.view`; here it becomes what the
controllers need.
"""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass

import numpy as np

from physim import Decisions, Observation, Scene, Sensed, View, build_scene
from physim.world.file import parse_world
from tests.helpers import STRAIGHT, inside
from tests.oracles.paths import lengths, point_at
from tests.oracles.view import Body, Cluster

ModeSwitching = inside("physim.controllers", "ModeSwitching")
ModeSwitchingSettings = inside("physim.controllers", "ModeSwitchingSettings")
build_wall_tree, pack_parts = inside("physim.geometry", "build_wall_tree", "pack_parts")
pack_polylines, read_only = inside("physim.geometry", "pack_polylines", "read_only")
shared = inside("physim.parts", "shared")
FormationPlan, SceneBody = inside("physim.world", "FormationPlan", "Body")


@dataclass(frozen=True)
class History:
    """Walls (bodies of convex parts), a cluster, and the robots at one moment after the other."""

    walls: list[list[np.ndarray]]
    cluster: Cluster
    reference: np.ndarray
    moments: list[list[Body]]

    @property
    def wall_parts(self) -> list[np.ndarray]:
        return [part for body in self.walls for part in body]


@functools.cache
def template() -> Scene:
    """Any scene: it lends what no controller looks at."""
    return build_scene(parse_world(STRAIGHT))


def scene_of(history: History) -> Scene:
    """The same as arrays."""
    robots, cluster = history.moments[0], history.cluster
    names = [SceneBody(i, "robot", f"r{i + 1}") for i in range(len(robots))]
    names += [
        SceneBody(len(robots) + k, "boundary", f"wall {k}") for k in range(len(history.walls))
    ]
    n = len(robots)
    adjacency = np.zeros((0, 0)) if cluster.adjacency is None else cluster.adjacency
    walls = pack_parts(history.walls)
    return dataclasses.replace(
        template(),
        dt=0.01,
        bodies=tuple(names),
        shapes=pack_parts([robot.parts for robot in robots]),
        walls=walls,
        wall_tree=build_wall_tree(walls),
        mass=np.ones(n),
        limits=np.array([robot.limits for robot in robots]),
        curvature=np.full(n, np.inf),
        braking=np.full(n, np.inf),
        start=np.array([robot.pose for robot in robots]),
        paths=pack_polylines([robot.path for robot in robots]),
        reference=pack_polylines([history.reference]),
        outside=tuple(robot.outside for robot in robots),
        speeds=tuple(robot.speeds for robot in robots),
        omegas=tuple(robot.omegas for robot in robots),
        stop_station=np.array([robot.stop_station for robot in robots]),
        formation=FormationPlan(
            active=cluster.active,
            gain=cluster.gain,
            speed=cluster.speed,
            v_min=cluster.v_min,
            v_max=cluster.v_max,
            lead=np.array([robot.lead for robot in robots]),
            adjacency=np.array(adjacency, dtype=np.int64),
            range=cluster.range,
        ),
        sensing_range=cluster.range,
    )


def sensed_at(robots: list[Body], step: int) -> Sensed:
    """All robots at one moment, as everybody knows them."""
    robot, first, end, age, heard = shared(len(robots))
    rows = Sensed(
        step=step,
        robot=robot,
        pose=np.array([robot.pose for robot in robots]),
        command=np.array([robot.command for robot in robots]),
        velocity=np.zeros((len(robots), 3)),
        reference_station=np.array([robot.reference_station for robot in robots]),
        age=age,
        first=first,
        end=end,
        station=np.array([robot.station for robot in robots]),
        heard=heard,
    )
    return Sensed(step, *map(read_only, rows[1:]))


def decisions(history: History, settings: ModeSwitchingSettings) -> list[Decisions]:
    """What all robots decide at each moment."""
    scene, controller = scene_of(history), ModeSwitching(settings)
    memory, everyone = controller.start(scene), np.arange(scene.robots)
    views = [View(scene, sensed_at(robots, 10 * k)) for k, robots in enumerate(history.moments)]
    return [controller.decide_all(view, everyone, memory) for view in views]


def observations(history: History, moment: int) -> list[Observation]:
    """What each robot may know at a moment."""
    scene, sensed = scene_of(history), sensed_at(history.moments[moment], 0)
    view = View(scene, sensed)
    return [view.observation(i) for i in range(len(history.moments[moment]))]


def single_robot(path: np.ndarray, station: float) -> History:
    """A small robot at a station of its path, which is s* as well, in a wide open place."""
    robot = Body(
        parts=(np.array([[-0.3, -0.2], [0.3, -0.2], [0.3, 0.2], [-0.3, 0.2]]),),
        pose=np.array([*point_at(path, station)[0], 0.0]),
        command=(0.0, 0.0),
        path=path,
        station=station,
        stop_station=lengths(path)[-1],
        reference_station=station,
        lead=0.0,
        limits=(1.5, 1.6),
    )
    corners = path[0] + np.array([[-25.0, -25.0], [25.0, -25.0], [25.0, 25.0], [-25.0, 25.0]])
    walls = [[np.array([corners[k], corners[(k + 1) % 4]])] for k in range(4)]
    return History(walls, Cluster(True, 0.05, 1.0, 0.8, 1.3, 5.0), path, [[robot]])
