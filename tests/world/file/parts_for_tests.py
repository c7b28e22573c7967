"""Controllers and stages that stand in for registered ones."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from physim.errors import Fault


class Switching:
    """Stands in for the shipped controller.

    More lines follow.
    """

    class Settings(BaseModel):
        model_config = ConfigDict(extra="forbid", frozen=True)
        look_ahead: float = Field(default=2.0, gt=0.0)
        omegas: tuple[float, ...] = (0.0,)

    def __init__(self, settings: Settings) -> None:
        self.settings = settings

    def decide(self, observation, memory):
        return None


class Plain:
    """Has no settings."""

    def decide(self, observation, memory):
        return None


class Mute:
    pass


class Haze:
    """Blurs what is seen."""

    class Settings(BaseModel):
        sd: float = Field(default=0.1, ge=0.0, description="[m] how much")

    def __init__(self, settings: Settings) -> None:
        self.settings = settings

    def start(self, scene):
        return None

    def sense(self, scene, truth, sensed, state):
        return sensed, state


class Slow:
    """Keeps speeds low."""

    class Settings(BaseModel):
        margin: float = Field(gt=0.0, description="[m] kept")
        names: tuple[str, ...] = ()

    def __init__(self, settings: Settings) -> None:
        raise AssertionError("it says nothing of worlds: reading one need not make it")

    def start(self, scene):
        return None

    def filter(self, scene, sensed, nominal, state):
        return nominal, state


class Gains:
    """One gain a robot."""

    class Settings(BaseModel):
        gains: list[float] = Field(default=[1.0, 1.0], description="[-] one a robot")
        side: Literal["left", "right"] = "left"
        gear: Literal[1, 2] = 1

    def __init__(self, settings: Settings) -> None:
        self.settings = settings

    def world_faults(self, world, where):
        given, robots = len(self.settings.gains), len(world.robots)
        if given != robots:
            yield Fault((*where, "gains"), f"{given} gains for {robots} robots")

    def world_doubts(self, world, where):
        for k, gain in enumerate(self.settings.gains):
            if gain > 2.0:
                yield Fault((*where, "gains", k), f"{gain:g} is a lot")

    def start(self, scene):
        return None

    def disturb(self, scene, truth, filtered, state):
        return filtered, state
