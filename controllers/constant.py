"""One command for each robot, held for the whole run: neither paths nor others matter.

The crash test writes its cases as worlds with this controller; it is also the most careless
driver there can be, for trying out what reports collisions.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from physim.errors import Fault
from physim.parts.controller import Decision, Observation
from physim.tolerances import SHARE

if TYPE_CHECKING:
    from physim.world import Robot

Number = Annotated[float, Field(allow_inf_nan=False)]


LONGEST = 1e9
"""[s] longer than any run"""


class ConstantSettings(BaseModel):
    """Keys under ``controller:`` for ``type: constant``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    commands: tuple[tuple[Number, Number], ...] = Field(
        default=(),
        description="[m/s, rad/s] v and omega of each robot, in their order; "
        "robots beyond the list stand still",
    )


class Constant:
    """Drives every robot at a constant (v, omega) of its own, whatever happens."""

    Settings = ConstantSettings

    def __init__(self, settings: ConstantSettings | None = None) -> None:
        self.settings = settings or ConstantSettings()

    def robot_faults(self, robots: Mapping[int, Robot]) -> list[Fault]:
        """Refuse commands beyond the limits of their robots, and those of no robot."""
        faults = []
        last, given = max(robots, default=-1), len(self.settings.commands)
        if robots and given > last + 1:
            message = f"{given} commands for {last + 1} robots; give one for each at most"
            faults.append(Fault(("controller", "commands", last + 1), message))
        for i, command in enumerate(self.settings.commands):
            limits = robots[i].limits if i in robots else None
            if limits is None:
                continue
            for k, (key, unit) in enumerate((("v", "m/s"), ("omega", "rad/s"))):
                limit = getattr(limits, key)
                if abs(command[k]) > limit * (1.0 + SHARE):
                    message = (
                        f"{command[k]:g} {unit} is beyond limits.{key} = {limit:g} of "
                        f'"{robots[i].name}"; use a slower one, or raise the limit'
                    )
                    faults.append(Fault(("controller", "commands", i, k), message))
        return faults

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Hold the robot's command for good."""
        commands = self.settings.commands
        v, omega = commands[observation.index] if observation.index < len(commands) else (0.0, 0.0)
        return Decision(v, omega, hold=LONGEST)
