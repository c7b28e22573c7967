"""A trial: a world's first seconds, with every decision and what it was made from.

Here alone a simulation is run, and a controller asked. It decides for one robot at a time, by
`decide` or, where it has none, by `decide_all`; what it answers are values to compare.
"""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from physim.errors import ControllerError
from physim.geometry.shapes import IntArray, read_only
from physim.parts.controller import (
    Controller,
    DecidesAll,
    DecidesOne,
    Decision,
    Decisions,
    Observation,
    Sensed,
)
from physim.parts.declarations import Declared
from physim.parts.drive import ANY
from physim.parts.user_code import broken_by
from physim.simulation.checks import next_steps
from physim.simulation.forms import AskedAlone, Row, decision_row, decisions_of
from physim.simulation.loop import Simulation
from physim.simulation.observation import View
from physim.testing.contents import NAN, Contents, Difference, Label, contents, difference
from physim.world.scene import Scene

Make = Callable[[], Controller]
"""Makes one more instance of a controller, with the same settings."""

RAISES, REFUSED = "raises", "refused"
"""What an answer holds in place of a decision."""


@dataclass(frozen=True)
class Answer:
    """What a controller said to one question."""

    values: Contents
    """the decision by field, memory and all; or what it raised; or why a run would refuse it"""
    decision: Decision | None
    """None where it is no use"""
    fault: str = ""
    """why a run would stop here"""

    @property
    def raised(self) -> bool:
        """Whether it raised."""
        return RAISES in self.values


def ask(controller: DecidesOne, scene: Scene, observation: Observation, memory: Any) -> Answer:
    """Ask a controller; what it is given is handed over as it is."""
    where = f"{observation.name} at {observation.time:g} s"
    try:
        decision = controller.decide(observation, memory)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        fault = broken_by(error, method_of(controller))
        if isinstance(controller, AskedAlone) and isinstance(error, ControllerError):
            fault = fault.removeprefix(f"{where}: ")  # what it gave was refused
            return Answer({REFUSED: fault}, None, fault)
        return Answer({RAISES: type(error).__name__}, None, fault)
    try:
        declared = Declared.of(controller)
        row = decision_row(decision, declared, scene)
        rows = decisions_of(np.array([observation.index]), [row], len(declared.columns))
        next_steps(scene, round(observation.time / scene.dt), rows, declared)
    except ControllerError as error:
        fault = str(error).removeprefix(f"{where}: ")
        return Answer({REFUSED: fault}, None, fault)
    return Answer({**values_of(row, declared), **contents(decision.memory, "memory")}, decision)


def method_of(controller: Controller) -> Callable[..., Any]:
    """The method that decides for one robot, as its author wrote it."""
    own = controller.controller if isinstance(controller, AskedAlone) else controller
    return own.decide if isinstance(own, DecidesOne) else own.decide_all


def rows_of(decisions: Decisions) -> dict[int, Row]:
    """Numbers of each decision of a batch, by robot."""
    start = decisions.considered_start
    return {
        int(robot): Row(
            tuple(decisions.command[k].tolist()),
            float(decisions.hold[k]),
            int(decisions.mode[k]),
            int(decisions.rule[k]),
            [int(j) for j in decisions.considered[start[k] : start[k + 1]]],
            [float(value) for value in decisions.report[k]],
        )
        for k, robot in enumerate(decisions.robot)
    }


def values_of(row: Row, declared: Declared) -> Contents:
    """Numbers of a decision by name."""
    numbers = dict(zip(("v", "omega", "lateral"), row.command, strict=False))
    numbers["hold"] = row.hold
    for column, value in zip(declared.columns, row.report, strict=True):
        numbers[f"report {column.name}"] = value
    values: Contents = {name: value if value == value else NAN for name, value in numbers.items()}
    values["considered"] = Label(", ".join(map(str, sorted(row.considered))) or "nobody")
    for name, number, among in (
        ("mode", row.mode, declared.modes),
        ("rule", row.rule, declared.rules),
    ):
        values[name] = Label(among[number].name if 0 <= number < len(among) else f"no {name}")
    return values


def other_answer(one: Contents, other: Contents, agreement: float = 0.0) -> str:
    """What is other in the second of two answers, numbers by more than so; empty where nothing."""
    pairs = ((name, one.get(name), value) for name, value in other.items() if agreement)
    near = {
        name: old
        for name, old, new in pairs
        if type(old) is type(new) is float and abs(old - new) <= agreement
    }
    found = difference(one, other | near)
    if found is None:
        return ""
    for values, word in ((other, "it "), (one, "no more ")):
        if RAISES in values:
            return f"{word}raises {values[RAISES]}"
        if REFUSED in values:
            return f"{word}says what is refused: {values[REFUSED]}"
    return f"{found.place} is {found.after} instead of {found.before}"


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


def run_trial(scene: Scene, controller: DecidesOne, seconds: float) -> Trial:
    """Run a scene for some seconds, no longer than it lasts, asked for one robot at a time."""
    recorder = _QueryRecorder(controller, scene)
    simulation = Simulation(scene, controller=recorder)
    recorder.simulation = simulation
    steps = []
    for _ in range(min(max(round(seconds / scene.dt), 1), scene.steps)):
        recorder.asked.clear()
        simulation.step()
        if recorder.asked and simulation.last is not None:
            due = np.array([asked.robot for asked in recorder.asked])
            steps.append(TrialStep(own_arrays(simulation.last.sensed), due, tuple(recorder.asked)))
    return Trial(scene, tuple(steps))


def own_arrays(sensed: Sensed) -> Sensed:
    """Copy of what is sensed that shares no array with it, read-only as in a run."""
    return Sensed(sensed.step, *(read_only(np.array(values)) for values in sensed[1:]))


class _QueryRecorder:
    """Takes the place of the controller in a trial, and keeps every query with its answer."""

    drives = (ANY,)
    simulation: Simulation
    spare: View | None = None
    """of the present step, in arrays of its own"""

    def __init__(self, controller: DecidesOne, scene: Scene) -> None:
        self.controller = controller
        declared = Declared.of(controller)
        self.modes, self.rules = declared.modes, declared.rules
        self.columns = declared.columns
        self.scene = scene
        self.asked: list[Query] = []

    def start(self, scene: Scene) -> Any:
        """The first memories of a plain controller."""
        start = getattr(self.controller, "start", None)
        if start is None or isinstance(self.controller, DecidesAll):
            return None
        return start(scene)

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Ask the controller and hand its decision on."""
        sensed = self.simulation.view.sensed
        if self.spare is None or self.spare.sensed.step != sensed.step:
            self.spare = View(self.scene, own_arrays(sensed), self.spare)
        spare = self.spare.observation(observation.index)
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
    except KeyboardInterrupt:
        raise
    except BaseException:  # of what a controller put into it
        pass
    return difference(contents(spare, "observation"), contents(given, "observation"))


def _copy_of(memory: Any) -> tuple[Any, str]:
    """Copy of a memory, or None and why there is none."""
    try:
        return copy.deepcopy(memory), ""
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        return None, f"{type(error).__name__}: {error}"
