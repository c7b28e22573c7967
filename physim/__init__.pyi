# The public names of physim, each with the module that has it: the one list of them.

from . import geometry, metrics, randomness, testing
from ._version import __version__
from .analysis.summary import summarise
from .analysis.validation import validate
from .contacts import Kind, Phase
from .drawing import plots, video
from .drawing.page import page
from .drawing.video import render
from .errors import ControllerError, Fault, PhysimError, RecordError, WorldError
from .judging import judge
from .learning import env, single_env, vector_env
from .parts.controller import (
    Controller,
    Decision,
    Decisions,
    FormationView,
    Neighbour,
    Observation,
    ObservedRobot,
    Sensed,
    Snapshot,
    Vehicle,
    Wall,
)
from .parts.declarations import PAPER_MODES, Column, Mode, Rule
from .parts.drive import Drive, Most, Reach
from .parts.stages import (
    Disturbance,
    Filter,
    Observer,
    SensingStage,
    Step,
    for_each,
    observer_of_row,
    with_poses,
)
from .record import Record
from .simulation.arrays import Arrays
from .simulation.forms import per_robot
from .simulation.kept_states import state_at
from .simulation.loop import Simulation
from .simulation.observation import View
from .simulation.recorder import SaveAt
from .simulation.run import record_run, simulate
from .simulation.state import SimulationState
from .testing import check_controller
from .world import World
from .world.checks import check_world
from .world.file import load_world, parse_world
from .world.layout.scene_builder import build_scene
from .world.scene import Scene

__all__ = [
    "PAPER_MODES",
    "Arrays",
    "Column",
    "Controller",
    "ControllerError",
    "Decision",
    "Decisions",
    "Disturbance",
    "Drive",
    "Fault",
    "Filter",
    "FormationView",
    "Kind",
    "Mode",
    "Most",
    "Neighbour",
    "Observation",
    "ObservedRobot",
    "Observer",
    "Phase",
    "PhysimError",
    "Reach",
    "Record",
    "RecordError",
    "Rule",
    "SaveAt",
    "Scene",
    "Sensed",
    "SensingStage",
    "Simulation",
    "SimulationState",
    "Snapshot",
    "Step",
    "Vehicle",
    "View",
    "Wall",
    "World",
    "WorldError",
    "__version__",
    "build_scene",
    "check_controller",
    "check_world",
    "env",
    "for_each",
    "geometry",
    "judge",
    "load_world",
    "metrics",
    "observer_of_row",
    "page",
    "parse_world",
    "per_robot",
    "plots",
    "randomness",
    "record_run",
    "render",
    "simulate",
    "single_env",
    "state_at",
    "summarise",
    "testing",
    "validate",
    "vector_env",
    "video",
    "with_poses",
]
