"""Breakdowns: a robot stands, for a while or for ever, or runs on with its last command."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from physim.disturbances.named import Named, Stream, name_faults, robots_of
from physim.errors import Fault, Location
from physim.geometry.shapes import FloatArray, IntArray, read_only
from physim.parts.controller import LONGEST_HOLD, Snapshot
from physim.randomness import uniform
from physim.world import World
from physim.world.scene import Scene

MOST_TIMES = 1000
AT_RANDOM, AT_GIVEN = range(2)
"""What a draw is for"""


def _listed(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(value)
    return (value,) if isinstance(value, int | float) else value


class BreakdownSettings(BaseModel):
    """Keys under ``disturbances:`` for ``type: breakdown``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    at: Annotated[
        tuple[Annotated[float, Field(ge=0.0, allow_inf_nan=False)], ...],
        Field(max_length=MOST_TIMES),
        BeforeValidator(_listed),
    ] = Field(default=(), description="[s] when robots break down, one time or several")
    probability: float = Field(
        default=1.0, ge=0.0, le=1.0, description="that a robot breaks down at such a time"
    )
    rate: float = Field(
        default=0.0,
        ge=0.0,
        le=1.0e6,
        description="[1/s] breakdowns of a robot in a second on the average, at random times",
    )
    lasts: Annotated[float, Field(ge=0.0, le=1.0e8)] | None = Field(
        default=None, description="[s] after which it works again; for ever when absent"
    )
    then: Literal["stands", "runs_on"] = Field(
        default="stands", description="whether it stands, or runs on with its last command"
    )
    robots: Named = None
    stream: Stream = 0


State = tuple[IntArray, int, NDArray[np.bool_], IntArray, IntArray, FloatArray]
"""Indices (n,) of its robots; step at which any robot changes next; which (N,) are broken; steps
(N,) at which these work again, and others break down; how often (N,) each broke down; commands
(N, C) of the step before, none before the first"""


class Breakdown:
    """Robots break down at times given or drawn: they stand, or run on."""

    Settings = BreakdownSettings

    def __init__(self, settings: BreakdownSettings | None = None) -> None:
        self.settings = settings or BreakdownSettings()

    def world_faults(self, world: World, where: Location) -> list[Fault]:
        """Refuse what never happens: no time or rate, a time after the end, names of no robot."""
        return [*self._time_faults(world, where), *name_faults(world, where, self.settings.robots)]

    def _time_faults(self, world: World, where: Location) -> Iterator[Fault]:
        own, end = self.settings, world.time.duration
        if not own.at and "rate" not in own.model_fields_set:
            message = "neither at nor rate; give at: 20.0 (seconds), or rate: 0.01 (in a second)"
            yield Fault(where, message)
        for k, time in enumerate(own.at):
            if time >= end:
                message = f"{time:g} s is not within the run, which ends at {end:g} s"
                at = ("at", k) if len(own.at) > 1 else ("at",)  # it may be written as a number
                yield Fault((*where, *at), f"{message}; give an earlier time")
        for k, (before, time) in enumerate(pairwise(own.at), start=1):
            if time <= before:
                message = f"{time:g} s does not come after the time before it, {before:g} s"
                yield Fault((*where, "at", k), f"{message}; write times in their order")

    def start(self, scene: Scene) -> State:
        """All robots begin to work at the first step, as after a breakdown."""
        none = np.zeros(scene.robots, np.int64)
        who = robots_of(scene, self.settings.robots)
        return who, 0, np.ones(scene.robots, np.bool_), none, none, np.zeros((0, 2))

    def disturb(
        self, scene: Scene, truth: Snapshot, filtered: FloatArray, state: State
    ) -> tuple[FloatArray, State]:
        """Commands of those that work, and what broken ones do. A broken one breaks no further."""
        who, event, broken, due, count, last = state
        if truth.step >= event:
            event, broken, due, count = self._changed(scene, truth.step, state)
        if not broken.any():
            return filtered, (who, event, broken, due, count, filtered)
        last = last if len(last) else truth.command
        held = last if self.settings.then == "runs_on" else np.zeros_like(filtered)
        applied = np.where(broken[:, None], held, filtered)
        last = np.where(broken[:, None], last, filtered)
        return read_only(applied), (who, event, broken, due, count, last)

    def _changed(
        self, scene: Scene, step: int, state: State
    ) -> tuple[int, NDArray[np.bool_], IntArray, IntArray]:
        """What of a state becomes another at a step: robots work again, and others break down."""
        who, _, broken, due, count, _ = state
        own, purpose = self.settings, f"breakdown {self.settings.stream}"
        broken, due, count = broken.copy(), due.copy(), count.copy()
        again = broken & (due <= step)
        broken[again], due[again] = False, LONGEST_HOLD
        mine = np.intersect1d(who, np.flatnonzero(again))
        if own.rate and len(mine):  # how long a robot works is drawn as a whole
            drawn = uniform(scene.seed, purpose, AT_RANDOM, mine, count[mine])[:, 0]
            works = np.minimum(-np.log1p(-drawn) / own.rate / scene.dt, LONGEST_HOLD)
            due[mine] = step + np.maximum(np.ceil(works), 1.0)
        breaks = ~broken & (due <= step)
        given = [round(at / scene.dt) for at in own.at]
        if step in given:
            drawn = uniform(scene.seed, purpose, AT_GIVEN, who, given.index(step))[:, 0]
            breaks[who] |= ~broken[who] & (drawn < own.probability)
        lasts = LONGEST_HOLD if own.lasts is None else round(own.lasts / scene.dt)
        if lasts:
            broken, due = broken | breaks, np.where(breaks, step + lasts, due)
            count += breaks
        later = [*(at for at in given if at > step), LONGEST_HOLD]
        return min(int(due.min()), later[0]), broken, due, count
