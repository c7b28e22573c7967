"""Delay: robots see where others were some steps ago."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from physim.disturbances.rows import moved, moving, own_rows
from physim.errors import Fault, Location
from physim.geometry.shapes import FloatArray
from physim.parts.controller import Sensed, Snapshot
from physim.parts.stages import observer_of_row
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


class Delay:
    """Shows robots where others were some time ago: pose and velocity, with their age."""

    Settings = DelaySettings
    on_demand = True

    def __init__(self, settings: DelaySettings | None = None) -> None:
        self.settings = settings or DelaySettings()

    def world_faults(self, world: World, where: Location) -> list[Fault]:
        """Refuse a delay that is longer than the run."""
        s, time = self.settings, world.time
        late = s.steps * time.step if s.steps else s.seconds
        return late_faults(late, world, (*where, "steps" if s.steps else "seconds"))

    def start(self, scene: Scene) -> Past:
        """Nothing is past yet."""
        return ()

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: Past
    ) -> tuple[Sensed, Past]:
        """Rows of the past; before there is one so old, of the first sample."""
        s = self.settings
        steps = s.steps or round(s.seconds / scene.dt)
        if steps == 0:
            return sensed, state
        now = (*moving(truth), *((truth.station, truth.reference_station) if s.own else ()))
        later = (*state[-steps + 1 :], now) if steps > 1 else (now,)
        if not state or not len(sensed.robot):
            return sensed, later
        then, rows = state[-steps:][0], own_rows(scene, sensed)
        late, robot = min(steps, len(state)) * scene.dt, rows.robot
        seen = np.full(len(robot), True) if s.own else robot != observer_of_row(rows)
        # what a stage before this one changed stays: rows that hold the truth get the past exactly
        pose, velocity = (
            np.where(seen[:, None], old[robot] + (given - new[robot]), given)
            for old, given, new in zip(then, (rows.pose, rows.velocity), now, strict=False)
        )
        rows = rows._replace(velocity=velocity, age=np.where(seen, rows.age + late, rows.age))
        if s.own:
            told = robot < scene.robots
            station = rows.reference_station.copy()
            j = robot[told]
            station[told] = then[3][j] + (station[told] - now[3][j])
            rows = rows._replace(
                station=then[2] + (rows.station - now[2]),
                reference_station=station,
                heard=rows.heard + np.where(robot == observer_of_row(rows), 0.0, late),
            )
        return moved(scene, rows, pose), later


def late_faults(late: float, world: World, where: Location) -> list[Fault]:
    """Refuse a delay [s] that is as long as the run, or longer."""
    if late < world.time.duration or not late:
        return []
    message = (
        f"a delay of {late:g} s is not shorter than the run, time.duration = "
        f"{world.time.duration:g} s: nothing would ever be known but the start; shorten it"
    )
    return [Fault(where, message)]
