"""Which controller decides, by name, and its settings."""

from __future__ import annotations

from pydantic import Field

from physim.world.kinds import Label
from physim.world.stages import Choice


class ControllerChoice(Choice):
    """A controller by name and its settings, which the controller itself checks.

    In a world file both stand in one mapping: ``{type: mode_switching, look_ahead: 2.0}``.
    """

    type: Label = Field(default="mode_switching", description="name of a registered controller")
