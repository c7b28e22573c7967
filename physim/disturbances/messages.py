"""Messages: robots tell one another station and command, and messages come late or not at all.

Every ``interval`` each robot tells all others its station along the reference path and the command
that it holds. Each keeps what it heard last, with its age. What is older than ``keep`` is
forgotten: station and command are then estimated from what is seen, and of a robot that is not seen
either nothing is known. At the start all know where all stand.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from physim.compiled import compiled
from physim.disturbances.delay import late_faults
from physim.disturbances.losses import Chance, Losses, last_drawn
from physim.disturbances.rows import Rows, Stage, moved, rows_of, without
from physim.errors import Fault, Location
from physim.geometry.shapes import Flags, FloatArray
from physim.parts.controller import Sensed, Snapshot
from physim.randomness import Words
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


class Messages(Stage):
    """Lets what robots tell one another, station and command, come late or get lost."""

    Settings = MessagesSettings

    def __init__(self, settings: MessagesSettings | None = None) -> None:
        self.settings = settings or MessagesSettings()
        self.is_off = not (self.settings.probability or self.settings.delay)

    def world_faults(self, world: World, where: Location) -> list[Fault]:
        """Refuse a delay that is longer than the run."""
        return late_faults(self.settings.delay, world, (*where, "delay"))

    def sense(
        self, scene: Scene, truth: Snapshot, sensed: Sensed, before: FloatArray | None
    ) -> tuple[Sensed, FloatArray | None]:
        """Rows with what was heard last.

        The state holds what was told in the last slots, (K, N, C + 1): commands and stations.
        """
        s, step = self.settings, truth.step
        every, keep = s.slot_steps(scene.dt), round(s.keep / scene.dt)
        state = before
        if state is None or step % every == 0:
            told = np.column_stack((truth.command, truth.reference_station))[None]
            state = told
            if before is not None:
                state = np.concatenate((before[-(keep // every) - 1 :], told))
        if not len(sensed.robot):
            return sensed, state
        oldest = step // every - len(state) + 1
        newest = max((step - round(s.delay / scene.dt)) // every, oldest)
        command, heard = sensed.command.copy(), sensed.heard.copy()
        station, lost = sensed.reference_station.copy(), np.zeros(len(heard), np.bool_)
        slots = Slots(newest, oldest, step, every, keep, scene.dt, state.reshape(-1))
        put_heard(
            self.key(scene), s.chance, slots, rows_of(truth, sensed), command.shape[1],
            truth.reference_station, command.reshape(-1), station, heard, lost,
        )  # fmt: skip
        rows = sensed._replace(command=command, reference_station=station, heard=heard)
        return forgotten(scene, rows, lost), state


class Slots(NamedTuple):
    """When messages were sent, and what they said."""

    newest: int
    """that may have come"""
    oldest: int
    """that is remembered; it counts as heard"""
    step: int
    """now"""
    every: int
    """steps of a slot"""
    keep: int
    """[steps] for how long what was heard is kept"""
    dt: float
    told: FloatArray
    """(K N (C + 1),) commands and station of each robot, from the oldest slot on"""


@compiled
def put_heard(
    key: Words,
    chance: Chance,
    slots: Slots,
    rows: Rows,
    columns: int,
    station_now: FloatArray,
    command: FloatArray,
    station: FloatArray,
    heard: FloatArray,
    lost: Flags,
) -> None:
    """Put what was heard last into rows of others: commands (M C,), stations and ages (M,).

    What stages before changed of stations stays; rows that hold the truth get the past exactly.
    ``lost`` are rows of which nothing was heard for so long that it is forgotten.
    """
    for i in range(rows.observers):
        for row in range(rows.first[i], rows.end[i]):
            j, slot = rows.robot[row], slots.newest
            if j == i or not heard[row] < np.inf:
                continue
            while slot > slots.oldest:
                last = last_drawn(key, chance, slot, i, j)
                if not last.is_bad:
                    break
                slot = last.slot - 1
            slot = max(slot, slots.oldest)
            late = slots.step - slots.every * slot
            if late > slots.keep:
                lost[row], heard[row] = True, np.inf
                continue
            at = (rows.observers * (slot - slots.oldest) + j) * (columns + 1)
            for m in range(columns):
                command[columns * row + m] = slots.told[at + m]
            station[row] = slots.told[at + columns] + (station[row] - station_now[j])
            heard[row] += late * slots.dt


def forgotten(scene: Scene, rows: Sensed, lost: Flags) -> Sensed:
    """Rows of which some, ``lost`` (M,), are not told: estimated from what is seen, or left out."""
    if not np.count_nonzero(lost):
        return rows
    rows = without(rows, lost & np.isnan(rows.pose[:, 0]))
    at = np.isinf(rows.heard) & (rows.robot < scene.robots)
    command, heading = rows.command.copy(), rows.pose[at, 2]
    vx, vy, turn = rows.velocity[at].T
    c, s = np.cos(heading), np.sin(heading)
    seen = np.column_stack((c * vx + s * vy, turn, c * vy - s * vx))
    command[at] = seen[:, : command.shape[1]]
    return moved(scene, rows._replace(command=command), rows.pose)
