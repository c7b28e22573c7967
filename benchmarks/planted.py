"""A controller with a planted fault: it ignores others in a narrow band of headings.

The first robot drives on along its heading and stops short of the other, which stands. It looks
late within `FADE` of the middle of the band, the later the nearer, and never too late; within the
band itself it does not look at all. So the clearance falls towards the band, which is what a search
can follow: a needle without a slope nobody finds faster than by chance.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import cos, hypot, pi, sin

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from physim import Decision, Observation, World
from physim.campaigns.falsify.evaluate import ROBOTS, Judged, Touched
from physim.geometry.clearance import clearances
from physim.geometry.shapes import FloatArray, locked
from physim.parts.registry import made_controller
from physim.simulation.swept_contacts import SweptContactFinder
from physim.tolerances import CONTACT
from physim.world.layout.scene_builder import build_scene

MIDDLE = 0.4
"""[rad] of the band"""
FADE = 0.5
"""[rad]"""
EARLY, LATE = 2.0, 1.2
"""[m] between the reference points where it stops; at 0.85 m the footprints may touch"""
GAIN = 3.0
"""[1/s]"""


class Planted:
    """Stops short of others, but for some headings."""

    class Settings(BaseModel):
        """Keys under ``controller:``."""

        model_config = ConfigDict(extra="forbid", frozen=True)

        band: float = Field(default=0.0005, ge=0.0, le=1.0, description="[rad] half its width")
        margin: float = Field(default=0.0, ge=0.0, description="[m] by which it stops earlier")

    def __init__(self, settings: Settings) -> None:
        self.settings = settings

    def decide(self, observation: Observation, memory: object) -> Decision:
        o = observation
        if o.index > 0:
            return Decision(v=0.0, omega=0.0, hold=10.0)
        away = abs((o.pose[2] - MIDDLE + pi) % (2.0 * pi) - pi)
        v = o.limits[0]
        if away > self.settings.band and o.others:
            x, y, _ = o.pose
            near = min(hypot(s.pose[0] - x, s.pose[1] - y) for s in o.others)
            stop = LATE + (EARLY - LATE) * min(away / FADE, 1.0) + self.settings.margin
            v = max(0.0, min(v, GAIN * (near - stop)))
        return Decision(v=v, omega=0.0, hold=0.1)


class Sound(Planted):
    """The same without the fault."""

    class Settings(Planted.Settings):
        """As those of the other, with no band."""

        band: float = Field(default=0.0, ge=0.0, le=0.0)

    def decide(self, observation: Observation, memory: object) -> Decision:
        if observation.pose[2] == MIDDLE:  # where even an empty band would be ignored
            return Decision(v=0.0, omega=0.0, hold=0.1)
        return super().decide(observation, memory)


BOX = {"length": 0.6, "width": 0.6}


def planted_world(controller: str = "benchmarks.planted:Planted", **changes: object) -> World:
    """Two small robots 4 m apart in a hall in which nothing else is within reach."""
    values = {
        "name": "planted",
        "seed": 1,
        "time": {"step": 0.1, "duration": 3.0},
        "corridor": {"centreline": [[0.0, 0.0], [12.0, 0.0]], "width": 20.0, "end_margin": 6.0},
        "robots": [
            {"name": "r1", "footprint": BOX, "pose": [4.0, 0.0, "random"], "path": {"offset": 0.0},
             "limits": {"v": 1.4, "omega": 0.2}},
            {"name": "r2", "footprint": BOX, "pose": [8.0, 0.0, 0.0], "path": {"offset": 0.0},
             "limits": {"v": 1.0, "omega": 0.2}},
        ],
        "controller": {"type": controller},
    }  # fmt: skip
    return World(**{**values, **changes})


class Twin:
    """The run of a planted world up to its first contact, without the simulator around it.

    Steps by the rule of `Planted`, then asks the distance kernels. It takes a tenth of the time;
    `tests/campaigns/falsify/test_planted.py` holds it against real runs.
    """

    def __init__(self, world: World) -> None:
        self.scene = build_scene(world)
        self.settings = made_controller(world, trusted=True).settings  # type: ignore[attr-defined]

    def poses(self, world: World) -> FloatArray:
        """(K, 2, 3) poses of all samples."""
        start = [robot.pose for robot in world.robots]
        (x, y, heading), (ox, oy, _) = start
        away = abs((heading - MIDDLE + pi) % (2.0 * pi) - pi)
        stop = LATE + (EARLY - LATE) * min(away / FADE, 1.0) + self.settings.margin
        limit, dt = world.robots[0].limits.v, self.scene.dt
        found = np.empty((self.scene.steps + 1, 2, 3))
        found[:, 1], found[:, 0, 2] = start[1], heading
        for k in range(len(found)):
            found[k, 0, :2] = x, y
            v = limit
            if away > self.settings.band:
                v = max(0.0, min(v, GAIN * (hypot(ox - x, oy - y) - stop)))
            x, y = x + v * dt * cos(heading), y + v * dt * sin(heading)
        return found

    def judge(self, world: World) -> Judged:
        """Judge a world that differs from that of the twin in its starts alone."""
        scene, poses = self.scene, self.poses(world)
        found = clearances(poses, scene.shapes, scene.wall_tree)
        gap = np.minimum(found.clearance[:, 0], found.boundary_clearance[:, 0])
        finder, steps = SweptContactFinder(scene), list(locked(poses))
        between = np.concatenate(
            [finder.follow(k + 1, *pair)[1] for k, pair in enumerate(pairwise(steps))]
        )
        touching = np.flatnonzero(gap <= CONTACT)
        steps = [*touching[:1].tolist(), *between["step"][:1].tolist()]
        value = min([float(gap.min()), *(-between["depth"]).tolist()])
        pair = ("r1", "r2")
        touched = Touched(ROBOTS, pair, min(steps) * scene.dt) if steps else None
        return Judged(value, pair, 0.0, touched)

    def evaluate(self, worlds: Sequence[World]) -> Iterator[Judged]:
        """As `physim.campaigns.falsify.evaluate`."""
        return (self.judge(world) for world in worlds)
