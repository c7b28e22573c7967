"""One command for each robot, held for the whole run: neither paths nor others matter.

The crash test writes its cases as worlds with this controller; it is also the most careless
driver there can be, for trying out what reports collisions.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from physim.control import Decision, Observation

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

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Hold the robot's command for good."""
        commands = self.settings.commands
        v, omega = commands[observation.index] if observation.index < len(commands) else (0.0, 0.0)
        return Decision(v, omega, hold=LONGEST)
