"""One command for each robot, held for the whole run: neither paths nor others matter.

The crash test writes its cases as worlds with this controller; it is also the most careless
driver there can be, for trying out what reports collisions.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from physim.errors import Fault, Location
from physim.parts.controller import Decision, Observation
from physim.parts.drive import ANY
from physim.tolerances import SHARE

if TYPE_CHECKING:
    from physim.world import Robot

Number = Annotated[float, Field(allow_inf_nan=False)]


LONGEST = 1e9
"""[s] longer than any run"""


class ConstantSettings(BaseModel):
    """Keys under ``controller:`` for ``type: constant``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    commands: tuple[Annotated[tuple[Number, ...], Field(min_length=2, max_length=3)], ...] = Field(
        default=(),
        description="[m/s, rad/s] v and omega of each robot, in their order; of an "
        "omnidirectional one also lateral [m/s], left positive",
    )
    v: Number = Field(default=0.0, description="[m/s] of robots beyond the list")
    omega: Number = Field(default=0.0, description="[rad/s] of robots beyond the list")


class Constant:
    """Drives every robot at a constant (v, omega) of its own, whatever happens."""

    Settings = ConstantSettings
    drives = (ANY,)
    told = "never"

    def __init__(self, settings: ConstantSettings | None = None) -> None:
        self.settings = settings or ConstantSettings()

    def robot_faults(self, robots: Mapping[int, Robot]) -> list[Fault]:
        """Refuse commands beyond the limits of their robots, and those of no robot."""
        faults = []
        last, given = max(robots, default=-1), len(self.settings.commands)
        if robots and given > last + 1:
            message = f"{given} commands for {last + 1} robots; give one for each at most"
            faults.append(Fault(("controller", "commands", last + 1), message))
        for i, robot in robots.items():
            for k, (key, unit) in enumerate((("v", "m/s"), ("omega", "rad/s"))):
                command, limit = self._command(i), getattr(robot.limits, key)
                if abs(command[k]) > limit * (1.0 + SHARE):
                    message = (
                        f"{command[k]:g} {unit} is beyond limits.{key} = {limit:g} of "
                        f'"{robot.name}"; use a slower one, or raise the limit'
                    )
                    at: Location = ("commands", i, k) if i < given else (key,)
                    faults.append(Fault(("controller", *at), message))
        return faults

    def _command(self, i: int) -> tuple[float, ...]:
        """v [m/s], omega [rad/s] and, where it is given, lateral [m/s] of Robot i."""
        own = self.settings
        return own.commands[i] if i < len(own.commands) else (own.v, own.omega)

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Hold the robot's command for good."""
        v, omega, *lateral = self._command(observation.index)
        return Decision(v, omega, hold=LONGEST, lateral=lateral[0] if lateral else 0.0)
