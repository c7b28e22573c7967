"""Messages: robots tell one another station and command, and messages come late or not at all.

Every ``interval`` each robot tells all others its station along the reference path and the command
that it holds. Each keeps what it heard last, with its age. What is older than ``keep`` is
forgotten: station and command are then estimated from what is seen, and of a robot that is not seen
either nothing is known. At the start all know where all stand.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from physim.disturbances.delay import late_faults
from physim.disturbances.losses import Losses, put_heard
from physim.disturbances.rows import moved, own_rows, without
from physim.errors import Fault, Location
from physim.geometry.shapes import Flags, FloatArray
from physim.parts.controller import Sensed, Snapshot
from physim.parts.stages import observer_of_row
from physim.world import World
from physim.world.scene import Scene


class MessagesSettings(Losses):
    """Keys of ``type: messages`` under ``sensing.stages``."""

    delay: Annotated[float, Field(ge=0.0, le=1.0e4)] = Field(
        default=0.0, description="[s] time that a message takes, rounded to physics steps"
    )
    keep: Annotated[float, Field(ge=0.0, le=1.0e4)] = Field(
        default=5.0, description="[s] for how long what was heard last is kept"
    )

    @model_validator(mode="after")
    def _kept(self) -> MessagesSettings:
        if self.keep < self.delay + self.interval:
            raise ValueError(
                f"keep is {self.keep:g} s; messages that come every {self.interval:g} s (interval) "
                f"and take {self.delay:g} s (delay) would be forgotten before the next: keep them "
                f"for at least {self.delay + self.interval:g} s"
            )
        return self


class Messages:
    """Lets what robots tell one another, station and command, come late or get lost."""

    Settings = MessagesSettings
    on_demand = True

    def __init__(self, settings: MessagesSettings | None = None) -> None:
        self.settings = settings or MessagesSettings()

    def world_faults(self, world: World, where: Location) -> list[Fault]:
        """Refuse a delay that is longer than the run."""
        return late_faults(self.settings.delay, world, (*where, "delay"))

    def start(self, scene: Scene) -> None:
        """Nothing is told yet."""

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, state: FloatArray | None
    ) -> tuple[Sensed, FloatArray | None]:
        """Rows with what was heard last.

        The state holds what was told in the last slots, (K, N, C + 1): commands and stations.
        """
        s, step = self.settings, truth.step
        if not s.probability and not s.delay:
            return sensed, state
        every, keep = s.slot_steps(scene.dt), round(s.keep / scene.dt)
        if state is None or step % every == 0:
            told = np.column_stack((truth.command, truth.reference_station))[None]
            most = keep // every + 1
            state = told if state is None else np.concatenate((state[-most:], told))
        if not len(sensed.robot):
            return sensed, state
        rows = own_rows(scene, sensed)
        who, whom, slot = observer_of_row(rows), rows.robot, np.empty(len(rows.robot), np.int64)
        oldest = step // every - len(state) + 1
        newest = max((step - round(s.delay / scene.dt)) // every, oldest)
        key = s.key(scene.seed, "messages")
        put_heard(key, s.chance, newest, oldest, len(slot), who, whom, slot)
        is_told = np.isfinite(rows.heard) & (whom != who)
        late = step - np.maximum(slot * every, 0)
        lost = is_told & (late > keep)
        at = np.flatnonzero(is_told & ~lost)
        if len(at):
            j, last = whom[at], state[slot[at] - oldest, whom[at]]
            command, station = rows.command.copy(), rows.reference_station.copy()
            heard = rows.heard.copy()
            command[at] = last[:, :-1]
            # a stage before this one may have changed it: rows that hold the truth get the past
            station[at] = last[:, -1] + (station[at] - truth.reference_station[j])
            heard[at] += late[at] * scene.dt
            rows = rows._replace(command=command, reference_station=station, heard=heard)
        return forgotten(scene, rows, lost), state


def forgotten(scene: Scene, rows: Sensed, lost: Flags) -> Sensed:
    """Rows of which some, ``lost`` (M,), are not told: estimated from what is seen, or left out."""
    if not lost.any():
        return rows
    rows = without(
        rows._replace(heard=np.where(lost, np.inf, rows.heard)), lost & np.isnan(rows.pose[:, 0])
    )
    at = np.isinf(rows.heard) & (rows.robot < scene.robots)
    command, heading = rows.command.copy(), rows.pose[at, 2]
    vx, vy, turn = rows.velocity[at].T
    c, s = np.cos(heading), np.sin(heading)
    seen = np.column_stack((c * vx + s * vy, turn, c * vy - s * vx))
    command[at] = seen[:, : command.shape[1]]
    return moved(scene, rows._replace(command=command), rows.pose)
