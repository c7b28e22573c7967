"""A world's first seconds, step by step: every decision of them with what it was made from.

The one place that runs a simulation. The controller decides in its plain form, whether it has a
batch form or not.
"""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from physim.control import Controller, Decision, Observation, Sensed
from physim.declared import Declared
from physim.geometry.shapes import IntArray, read_only
from physim.scene import Scene
from physim.simulation import Simulation
from physim.testing.answers import Answer, ask
from physim.testing.contents import Difference, contents, difference

STANDS = Decision(v=0.0, omega=0.0, hold=0.1)
"""What a robot does in place of a decision at which a run would stop."""


@dataclass(frozen=True)
class Asked:
    """One decision: what it was made from, and what was said."""

    observation: Observation
    """made for the checks: the controller was given another one, equal to it"""
    memory: Any
    """copy of what was handed over; copy it again before handing it over"""
    uncopied: str
    """why the memory could not be copied; then ``memory`` is None"""
    answer: Answer
    seen_changed: Difference | None
    """what the controller wrote into the observation"""
    memory_changed: Difference | None
    """what the controller wrote into the memory that it was given"""

    @property
    def robot(self) -> int:
        """Number of the robot."""
        return self.observation.index

    @property
    def time(self) -> float:
        """[s]."""
        return self.observation.time


@dataclass(frozen=True)
class Step:
    """A step at which robots decided."""

    sensed: Sensed
    """of its own"""
    due: IntArray
    asked: tuple[Asked, ...]
    """in the order of ``due``"""

    @property
    def time(self) -> float:
        """[s]."""
        return self.asked[0].time


@dataclass(frozen=True)
class Run:
    """The first seconds of a world."""

    scene: Scene
    steps: tuple[Step, ...] = field(repr=False)

    @property
    def asked(self) -> list[Asked]:
        """Every decision, in the order in which they were made."""
        return [asked for step in self.steps for asked in step.asked]


def run_world(scene: Scene, controller: Controller, seconds: float) -> Run:
    """Run a scene for some seconds, no longer than it lasts, with the controller's plain form."""
    listener = _Listener(controller, scene)
    simulation = Simulation(scene, controller=listener)
    listener.look = simulation.observe
    steps = []
    for _ in range(min(max(round(seconds / scene.dt), 1), scene.steps)):
        listener.asked.clear()
        simulation.step()
        if listener.asked and simulation.last is not None:
            due = np.array([asked.robot for asked in listener.asked])
            steps.append(Step(own(simulation.last.sensed), due, tuple(listener.asked)))
    return Run(scene, tuple(steps))


def own(sensed: Sensed) -> Sensed:
    """Copy of what is sensed that shares no array with it, read-only as in a run."""
    return Sensed(sensed.step, *(read_only(np.array(values)) for values in sensed[1:]))


class _Listener:
    """Stands where the controller stands in a run, and takes down what it is asked and says."""

    look: Callable[[int], Observation]

    def __init__(self, controller: Controller, scene: Scene) -> None:
        self.controller = controller
        declared = Declared.of(controller)
        self.modes, self.rules = declared.modes, declared.rules
        self.columns = declared.columns
        self.scene = scene
        self.asked: list[Asked] = []

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Ask the controller and hand its decision on."""
        spare = self.look(observation.index)
        before = contents(memory, "memory")
        kept, uncopied = _kept(memory)
        answer = ask(self.controller, self.scene, observation, memory)
        asked = Asked(
            observation=spare,
            memory=kept,
            uncopied=uncopied,
            answer=answer,
            seen_changed=_written(spare, observation),
            memory_changed=difference(before, contents(memory, "memory")),
        )
        self.asked.append(asked)
        if answer.decision is None:
            return Decision(STANDS.v, STANDS.omega, STANDS.hold, memory=memory)
        return answer.decision


def _written(spare: Observation, given: Observation) -> Difference | None:
    """Where an observation is no longer what it was, which the spare one still is."""
    try:
        if pickle.dumps(spare) == pickle.dumps(given):  # the quick way, for most of them
            return None
    except Exception:  # of what a controller put into it
        pass
    return difference(contents(spare, "observation"), contents(given, "observation"))


def _kept(memory: Any) -> tuple[Any, str]:
    """Copy of a memory, or None and why there is none."""
    try:
        return copy.deepcopy(memory), ""
    except Exception as error:
        return None, f"{type(error).__name__}: {error}"
