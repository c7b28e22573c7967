"""Delay: robots see where others were some steps ago."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from physim.compiled import compiled
from physim.disturbances.rows import Rows, Stage, moved, rows_of
from physim.errors import Fault, Location
from physim.geometry.shapes import FloatArray, Rows3
from physim.parts.controller import Sensed, Snapshot
from physim.world import World
from physim.world.scene import Scene

Past = tuple[tuple[FloatArray, ...], ...]
"""Of each of the last samples poses and velocities of all bodies, stations and those on s*"""


class DelaySettings(BaseModel):
    """Keys of ``type: delay`` under ``sensing.stages``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    seconds: Annotated[float, Field(ge=0.0, le=1.0e4)] = Field(
        default=0.0, description="[s] how old what is seen is, rounded to physics steps"
    )
    steps: Annotated[int, Field(ge=0, le=10**6)] = Field(
        default=0, description="[steps] the same in physics steps, in place of seconds"
    )
    own: bool = Field(
        default=False,
        description="whether robots know their own motion as late, and so tell it others",
    )

    @model_validator(mode="after")
    def _one(self) -> DelaySettings:
        if self.seconds and self.steps:
            raise ValueError("seconds and steps are given; write one of them")
        return self


class Delay(Stage):
    """Shows robots where others were some time ago: pose and velocity, with their age."""

    Settings = DelaySettings
    settings: DelaySettings

    def __init__(self, settings: DelaySettings | None = None) -> None:
        self.settings = settings or DelaySettings()
        self.is_off = not (self.settings.steps or self.settings.seconds)

    def world_faults(self, world: World, where: Location) -> list[Fault]:
        """Refuse a delay that is longer than the run."""
        dt, key = world.time.step, "steps" if self.settings.steps else "seconds"
        return late_faults(self._steps(dt) * dt, world, (*where, key))

    def start(self, scene: Scene) -> Past:
        """Nothing is past yet."""
        return ()

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: Past
    ) -> tuple[Sensed, Past]:
        """Rows of the past; before there is one so old, of the first sample."""
        own, steps = self.settings.own, self._steps(scene.dt)
        bodies = truth.moving_pose, truth.moving_velocity
        now = (*bodies, *((truth.station, truth.reference_station) if own else ()))
        later = (*state[-steps + 1 :], now) if steps > 1 else (now,)
        if not state or not len(sensed.robot):
            return sensed, later
        then, late = state[-steps:][0], min(steps, len(state)) * scene.dt
        pose, velocity, age = sensed.pose.copy(), sensed.velocity.copy(), sensed.age.copy()
        put_past(own, late, rows_of(truth, sensed), then[0], then[1], now[1], pose, velocity, age)
        rows = sensed._replace(velocity=velocity, age=age)
        if own:
            told = np.flatnonzero(rows.robot < scene.robots)
            station, j = rows.reference_station.copy(), rows.robot[told]
            station[told] = then[3][j] + (station[told] - now[3][j])
            rows = rows._replace(
                station=then[2] + (rows.station - now[2]), reference_station=station,
                heard=rows.heard + late,
            )  # fmt: skip
        return moved(scene, rows, pose), later

    def _steps(self, dt: float) -> int:
        return self.settings.steps or round(self.settings.seconds / dt)


@compiled
def put_past(
    own: bool,
    late: float,
    rows: Rows,
    pose_then: Rows3,
    velocity_then: Rows3,
    velocity_now: Rows3,
    pose: Rows3,
    velocity: Rows3,
    age: FloatArray,
) -> None:
    """Put the past into rows of what is seen; what stages before changed stays.

    Rows that hold the truth get the past exactly.
    """
    for i in range(rows.observers):
        for row in range(rows.first[i], rows.end[i]):
            j = rows.robot[row]
            if own or j != i:
                age[row] += late
                for m in range(3):
                    pose[row, m] = pose_then[j, m] + (pose[row, m] - rows.truth[j, m])
                    velocity[row, m] = velocity_then[j, m] + (velocity[row, m] - velocity_now[j, m])


def late_faults(late: float, world: World, where: Location) -> list[Fault]:
    """Refuse a delay [s] that is as long as the run, or longer."""
    if late < world.time.duration or not late:
        return []
    message = (
        f"a delay of {late:g} s is not shorter than the run, time.duration = "
        f"{world.time.duration:g} s: nothing would ever be known but the start; shorten it"
    )
    return [Fault(where, message)]
