"""The world as its author writes it: frozen models whose attributes are the keys of the file."""

from physim.world.arrival import Arrival
from physim.world.controller_choice import ControllerChoice
from physim.world.expectation import Expectation
from physim.world.formation import Formation
from physim.world.frozen import FrozenMapping, thawed
from physim.world.material import Physics
from physim.world.model import World
from physim.world.road import Corridor
from physim.world.robot import Box, Limits, Offset, Robot
from physim.world.stages import Choice, Sensing
from physim.world.start import Start
from physim.world.time_grid import Time

__all__ = [
    "Arrival",
    "Box",
    "Choice",
    "ControllerChoice",
    "Corridor",
    "Expectation",
    "Formation",
    "FrozenMapping",
    "Limits",
    "Offset",
    "Physics",
    "Robot",
    "Sensing",
    "Start",
    "Time",
    "World",
    "thawed",
]
