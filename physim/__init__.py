"""physim: a physics-backed simulator for multi-robot control in confined space.

    world = physim.load_world("my_world.yaml")
    record = physim.simulate(world)
    print(record.contacts, physim.summarise(record))

Step by step::

    simulation = physim.Simulation(world, seed=3)
    while not simulation.finished:
        simulation.step()

Names are imported when first used, so ``import physim`` is quick.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from physim._version import VERSION as __version__  # noqa: N811
    from physim.checking import check_world
    from physim.contacts import Kind, Phase
    from physim.control import Controller, Decision, Observation
    from physim.declared import PAPER_MODES, Column, Mode, Rule
    from physim.errors import ControllerError, Fault, PhysimError, RecordError, WorldError
    from physim.record import Record
    from physim.recorder import SaveAt
    from physim.recording import simulate
    from physim.scene_builder import build_scene
    from physim.simulation import Simulation
    from physim.stages import Step
    from physim.state import SimulationState
    from physim.summary import summarise
    from physim.testing import check_controller
    from physim.validation import validate
    from physim.video.render import render
    from physim.world import World
    from physim.world_file import load_world, parse_world

_WHERE = {
    "Column": "physim.declared",
    "Controller": "physim.control",
    "ControllerError": "physim.errors",
    "Decision": "physim.control",
    "Fault": "physim.errors",
    "Kind": "physim.contacts",
    "Mode": "physim.declared",
    "Observation": "physim.control",
    "PAPER_MODES": "physim.declared",
    "Phase": "physim.contacts",
    "PhysimError": "physim.errors",
    "Record": "physim.record",
    "RecordError": "physim.errors",
    "Rule": "physim.declared",
    "SaveAt": "physim.recorder",
    "Simulation": "physim.simulation",
    "SimulationState": "physim.state",
    "Step": "physim.stages",
    "World": "physim.world",
    "WorldError": "physim.errors",
    "build_scene": "physim.scene_builder",
    "check_controller": "physim.testing",
    "check_world": "physim.checking",
    "load_world": "physim.world_file",
    "parse_world": "physim.world_file",
    "render": "physim.video",
    "simulate": "physim.recording",
    "summarise": "physim.summary",
    "validate": "physim.validation",
}

__all__ = [
    "PAPER_MODES",
    "Column",
    "Controller",
    "ControllerError",
    "Decision",
    "Fault",
    "Kind",
    "Mode",
    "Observation",
    "Phase",
    "PhysimError",
    "Record",
    "RecordError",
    "Rule",
    "SaveAt",
    "Simulation",
    "SimulationState",
    "Step",
    "World",
    "WorldError",
    "__version__",
    "build_scene",
    "check_controller",
    "check_world",
    "load_world",
    "parse_world",
    "render",
    "simulate",
    "summarise",
    "validate",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name == "__version__":
        return import_module("physim._version").VERSION
    if name not in _WHERE:
        raise AttributeError(f"module 'physim' has no attribute '{name}'")
    value = getattr(import_module(_WHERE[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Public names."""
    return __all__
