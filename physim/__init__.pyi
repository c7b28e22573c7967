# The public names of physim, each with the module that has it: the one list of them.

from . import geometry, metrics, plots, randomness, testing, video
from ._version import __version__
from .checking import check_world
from .contacts import Kind, Phase
from .control import (
    BatchController,
    Controller,
    Decision,
    Decisions,
    FormationView,
    Neighbour,
    Observation,
    Seen,
    Sensed,
    Snapshot,
)
from .declared import PAPER_MODES, Column, Mode, Rule
from .errors import ControllerError, Fault, PhysimError, RecordError, WorldError
from .record import Record
from .recorder import SaveAt
from .recording import simulate
from .scene import Scene
from .scene_builder import build_scene
from .simulation import Simulation
from .stages import (
    Disturbance,
    Filter,
    Observer,
    SenseStage,
    Step,
    for_each,
    observer_of_row,
    with_poses,
)
from .state import SimulationState
from .summary import summarise
from .testing import check_controller
from .validation import validate
from .video import render
from .world import World
from .world_file import load_world, parse_world

__all__ = [
    "PAPER_MODES",
    "BatchController",
    "Column",
    "Controller",
    "ControllerError",
    "Decision",
    "Decisions",
    "Disturbance",
    "Fault",
    "Filter",
    "FormationView",
    "Kind",
    "Mode",
    "Neighbour",
    "Observation",
    "Observer",
    "Phase",
    "PhysimError",
    "Record",
    "RecordError",
    "Rule",
    "SaveAt",
    "Scene",
    "Seen",
    "SenseStage",
    "Sensed",
    "Simulation",
    "SimulationState",
    "Snapshot",
    "Step",
    "World",
    "WorldError",
    "__version__",
    "build_scene",
    "check_controller",
    "check_world",
    "for_each",
    "geometry",
    "load_world",
    "metrics",
    "observer_of_row",
    "parse_world",
    "plots",
    "randomness",
    "render",
    "simulate",
    "summarise",
    "testing",
    "validate",
    "video",
    "with_poses",
]
