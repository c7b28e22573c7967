"""Errors of actuation: gain, bias and noise of speed and turn rate, delay, and slip.

Every draw follows from seed, robot and time alone. Noise and slip have draws of their own at knots
in time, and are blended between two of them: noise so that its variance stays as it is.
"""

from __future__ import annotations

from math import sqrt
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from physim.compiled import compiled
from physim.disturbances.named import Named, Stream, name_faults, robots_of
from physim.errors import Fault, Location
from physim.geometry.shapes import FloatArray, IntArray, Rows3, read_only
from physim.parts.controller import Snapshot
from physim.randomness import Words, draw, normal, purpose_key
from physim.world import World
from physim.world.scene import Scene

MOST = 100.0
GAIN, BIAS, NOISE, SLIP = range(4)
"""What a draw is for: it tells draws of one robot apart"""

Spread = Annotated[float, Field(ge=0.0, le=1.0)]
Amount = Annotated[float, Field(ge=0.0, le=MOST)]


class Errors(BaseModel):
    """Keys under ``v:`` and ``omega:`` of ``type: actuation``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    gain: float = Field(default=1.0, ge=0.0, le=2.0, description="factor of what is commanded")
    gain_spread: Spread = Field(
        default=0.0, description="standard deviation of the gain from robot to robot"
    )
    bias: float = Field(
        default=0.0, ge=-MOST, le=MOST, description="[m/s or rad/s] added to what is commanded"
    )
    bias_spread: Amount = Field(
        default=0.0,
        description="[m/s or rad/s] standard deviation of the bias from robot to robot",
    )
    noise: Amount = Field(
        default=0.0, description="[m/s or rad/s] standard deviation of noise during the run"
    )


class ActuationSettings(BaseModel):
    """Keys under ``disturbances:`` for ``type: actuation``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    v: Errors = Field(default=Errors(), description="errors of the speed, forward and lateral")
    omega: Errors = Field(default=Errors(), description="errors of the turn rate")
    slip: float = Field(
        default=0.0, ge=0.0, le=1.0,
        description="greatest share of speed and turn rate that is lost; each loses from 0 to that",
    )  # fmt: skip
    correlation: float = Field(
        default=0.5, ge=0.0, le=1.0e6,
        description="[s] time in which noise and slip become others; 0: at each step",
    )  # fmt: skip
    delay: int = Field(default=0, ge=0, description="[steps] from a command to its execution")
    robots: Named = None
    stream: Stream = 0


State = tuple[IntArray, FloatArray, FloatArray, tuple[FloatArray, ...]]
"""Indices (n,) of its robots; their gain and bias (n, 3), of v, omega and lateral speed; the
commands (N, C) that wait, oldest first, none before the first step"""


class Actuation:
    """Robots execute their commands with gain, bias, noise, delay and slip."""

    Settings = ActuationSettings

    def __init__(self, settings: ActuationSettings | None = None) -> None:
        self.settings = own = settings or ActuationSettings()
        self._purpose = f"actuation {own.stream}"
        self._key = purpose_key(self._purpose)
        self._noise = np.array((own.v.noise, own.omega.noise, own.v.noise))
        self._is_off = own.v == own.omega == Errors() and not own.slip and not own.delay

    def world_faults(self, world: World, where: Location) -> list[Fault]:
        """Refuse a delay as long as the run, and names that no robot has."""
        found, delay, steps = [], self.settings.delay, world.time.steps
        if delay >= steps:
            message = (
                f"{delay} steps are longer than the run, which has {steps} of "
                f"{world.time.step:g} s; give at most {steps - 1}"
            )
            found.append(Fault((*where, "delay"), message))
        return [*found, *name_faults(world, where, self.settings.robots)]

    def start(self, scene: Scene) -> State:
        """Gain and bias of each robot, drawn by the seed; no command waits."""
        v, omega, who = self.settings.v, self.settings.omega, robots_of(scene, self.settings.robots)

        def drawn(of: int) -> FloatArray:
            return normal(scene.seed, self._purpose, 0, who, of, 3)

        gain = (v.gain, omega.gain, v.gain) + drawn(GAIN) * (
            v.gain_spread, omega.gain_spread, v.gain_spread
        )  # fmt: skip
        bias = (v.bias, omega.bias, v.bias) + drawn(BIAS) * (
            v.bias_spread, omega.bias_spread, v.bias_spread
        )  # fmt: skip
        return who, np.maximum(gain, 0.0), bias, ()

    def disturb(
        self, scene: Scene, truth: Snapshot, filtered: FloatArray, state: State
    ) -> tuple[FloatArray, State]:
        """Commands as they are executed: late, then with gain and slip, then with bias and noise.

        A robot whose late command is 0 stands still: brakes hold it, without bias or noise.
        """
        if self._is_off:
            return filtered, state
        own, (who, gain, bias, waiting) = self.settings, state
        late = filtered
        if own.delay:  # the command held before is taken to have been held for long
            late, *rest = waiting or (truth.command,) * own.delay
            waiting = (*rest, filtered)
        made = Made(gain, bias, self._noise, own.slip)
        at = truth.step / max(1.0, own.correlation / scene.dt)
        key = np.array([scene.seed, self._key], dtype=np.uint64)
        applied = filtered.copy()
        parts, late, out = filtered.shape[1], late.reshape(-1), applied.reshape(-1)
        actuate(key, int(at), at % 1.0, who, len(who), parts, made, late, out)
        return read_only(applied), (who, gain, bias, waiting)


class Made(NamedTuple):
    """What is made of the commands of n robots."""

    gain: Rows3
    bias: Rows3
    noise: FloatArray
    """(3,) standard deviations"""
    slip: float


@compiled
def actuate(
    key: Words,
    knot: int,
    past: float,
    who: IntArray,
    many: int,
    parts: int,
    made: Made,
    late: FloatArray,
    applied: FloatArray,
) -> None:
    """Write the commands of robots ``who`` (n,) as they are executed, of so many ``parts``.

    ``late`` and ``applied`` are (N * parts,); the time is ``past`` a knot, as a share of the way to
    the next one.
    """
    robot = np.empty(1, np.uint64)
    of = np.empty(1, np.uint64)
    here = np.empty((1, 4), np.float64)
    there = np.empty((1, 4), np.float64)
    here_share, there_share = 1.0 - past, past
    size = sqrt(here_share * here_share + there_share * there_share)
    is_noisy = made.noise[0] + made.noise[1] > 0.0
    for k in range(many):
        row, stands = parts * who[k], True
        for c in range(parts):
            if late[row + c] != 0.0:
                stands = False
        if stands:
            for c in range(parts):
                applied[row + c] = 0.0
            continue
        robot[0] = np.uint64(who[k])
        for c in range(parts):
            applied[row + c] = late[row + c] * made.gain[k, c]
        if made.slip > 0.0:
            of[0] = np.uint64(SLIP)
            draw(key, np.uint64(knot), robot, of, 1, False, here)
            draw(key, np.uint64(knot + 1), robot, of, 1, False, there)
            for c in range(parts):
                lost = here_share * here[0, c] + there_share * there[0, c]
                applied[row + c] *= 1.0 - made.slip * lost
        for c in range(parts):
            applied[row + c] += made.bias[k, c]
        if is_noisy:
            of[0] = np.uint64(NOISE)
            draw(key, np.uint64(knot), robot, of, 1, True, here)
            draw(key, np.uint64(knot + 1), robot, of, 1, True, there)
            for c in range(parts):
                drawn = here_share * here[0, c] + there_share * there[0, c]
                applied[row + c] += made.noise[c] / size * drawn
