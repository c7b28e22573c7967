"""A trial: a world's first seconds, with every decision and what it was made from.

The one place that runs a simulation. The controller decides in its plain form, whether it has a
batch form or not.
"""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from physim.control import Controller, Decision, Observation, Sensed
from physim.declared import Declared
from physim.geometry.shapes import IntArray, read_only
from physim.scene import Scene
from physim.simulation import Simulation
from physim.testing.answers import Answer, ask
from physim.testing.contents import Difference, contents, difference

STAND_STILL = Decision(v=0.0, omega=0.0, hold=0.1)
"""What a robot does in place of a decision at which a run would stop."""


@dataclass(frozen=True)
class Query:
    """One decision: what it was made from, and what was said."""

    observation: Observation
    """made for the checks: the controller was given another one, equal to it"""
    memory: Any
    """copy of what was handed over; copy it again before handing it over"""
    copy_error: str
    """why the memory could not be copied; then ``memory`` is None"""
    answer: Answer
    observation_change: Difference | None
    """what the controller wrote into the observation"""
    memory_change: Difference | None
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
class TrialStep:
    """A step at which robots decided."""

    sensed: Sensed
    """of its own"""
    due: IntArray
    asked: tuple[Query, ...]
    """in the order of ``due``"""

    @property
    def time(self) -> float:
        """[s]."""
        return self.asked[0].time


@dataclass(frozen=True)
class Trial:
    """The first seconds of a world, as a controller decided in them."""

    scene: Scene
    steps: tuple[TrialStep, ...] = field(repr=False)

    @property
    def asked(self) -> list[Query]:
        """Every decision, in the order in which they were made."""
        return [asked for step in self.steps for asked in step.asked]


def run_trial(scene: Scene, controller: Controller, seconds: float) -> Trial:
    """Run a scene for some seconds, no longer than it lasts, with the controller's plain form."""
    recorder = _QueryRecorder(controller, scene)
    simulation = Simulation(scene, controller=recorder)
    recorder.look = simulation.observe
    steps = []
    for _ in range(min(max(round(seconds / scene.dt), 1), scene.steps)):
        recorder.asked.clear()
        simulation.step()
        if recorder.asked and simulation.last is not None:
            due = np.array([asked.robot for asked in recorder.asked])
            steps.append(TrialStep(own(simulation.last.sensed), due, tuple(recorder.asked)))
    return Trial(scene, tuple(steps))


def own(sensed: Sensed) -> Sensed:
    """Copy of what is sensed that shares no array with it, read-only as in a run."""
    return Sensed(sensed.step, *(read_only(np.array(values)) for values in sensed[1:]))


class _QueryRecorder:
    """Takes the place of the controller in a trial, and keeps every query with its answer."""

    look: Callable[[int], Observation]

    def __init__(self, controller: Controller, scene: Scene) -> None:
        self.controller = controller
        declared = Declared.of(controller)
        self.modes, self.rules = declared.modes, declared.rules
        self.columns = declared.columns
        self.scene = scene
        self.asked: list[Query] = []

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Ask the controller and hand its decision on."""
        spare = self.look(observation.index)
        before = contents(memory, "memory")
        kept, copy_error = _copy_of(memory)
        answer = ask(self.controller, self.scene, observation, memory)
        query = Query(
            observation=spare,
            memory=kept,
            copy_error=copy_error,
            answer=answer,
            observation_change=_change_within(spare, observation),
            memory_change=difference(before, contents(memory, "memory")),
        )
        self.asked.append(query)
        if answer.decision is None:
            return replace(STAND_STILL, memory=memory)
        return answer.decision


def _change_within(spare: Observation, given: Observation) -> Difference | None:
    """Where an observation is no longer what it was, which the spare one still is."""
    try:
        if pickle.dumps(spare) == pickle.dumps(given):  # the quick way, for most of them
            return None
    except Exception:  # of what a controller put into it
        pass
    return difference(contents(spare, "observation"), contents(given, "observation"))


def _copy_of(memory: Any) -> tuple[Any, str]:
    """Copy of a memory, or None and why there is none."""
    try:
        return copy.deepcopy(memory), ""
    except Exception as error:
        return None, f"{type(error).__name__}: {error}"
