"""Controllers that stand in for registered ones."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field


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
