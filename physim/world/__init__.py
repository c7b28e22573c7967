"""The world as its author writes it: frozen models whose attributes are the keys of the file."""

from physim.world.group import RobotGroup, each_robot
from physim.world.kinds import FrozenMapping, thawed
from physim.world.model import Corridor, World
from physim.world.mover import Mover, Obstacle
from physim.world.road import RandomCorridor, RandomRoad
from physim.world.robot import Box, Formation, Limits, Offset, Robot, Start
from physim.world.run import Arrival, Choice, ControllerChoice, Expectation, Physics, Sensing, Time

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
    "Mover",
    "Obstacle",
    "Offset",
    "Physics",
    "RandomCorridor",
    "RandomRoad",
    "Robot",
    "RobotGroup",
    "Sensing",
    "Start",
    "Time",
    "World",
    "each_robot",
    "thawed",
]
