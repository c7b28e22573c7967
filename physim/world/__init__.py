"""The world as its author writes it: frozen models whose attributes are the keys of the file."""

from physim.world.frozen import FrozenMapping, thawed
from physim.world.model import (
    Box,
    ControllerChoice,
    Corridor,
    Expectation,
    Formation,
    Limits,
    Offset,
    Physics,
    Robot,
    Time,
    World,
)

__all__ = [
    "Box",
    "ControllerChoice",
    "Corridor",
    "Expectation",
    "Formation",
    "FrozenMapping",
    "Limits",
    "Offset",
    "Physics",
    "Robot",
    "Time",
    "World",
    "thawed",
]
