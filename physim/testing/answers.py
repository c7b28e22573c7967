"""Asking a controller once, as a run would, and what it answered as values to compare."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from physim.control import Controller, Decision, Decisions, Mode, Observation
from physim.control_decisions import Row, broken, decision_row
from physim.control_loop import check_commands, check_told, hold_steps
from physim.errors import ControllerError, PhysimError
from physim.scene import Scene
from physim.testing.contents import NAN, Contents, Told, contents, difference

REPORT = (
    "report.target[0]",
    "report.target[1]",
    "report.distance",
    "report.boundary_distance",
    "report.collision_time",
    "report.considered",
    "report.evaluations",
)
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


def ask(controller: Controller, scene: Scene, observation: Observation, memory: Any) -> Answer:
    """Ask a controller; what it is given is handed over as it is."""
    where = f"{observation.name} at {observation.time:g} s"
    try:
        decision = controller.decide(observation, memory)
    except (Exception, SystemExit) as error:
        told = error if isinstance(error, PhysimError) else broken(error, where)
        fault = str(told).removeprefix(f"{where}: ")
        return Answer({RAISES: type(error).__name__}, None, fault)
    try:
        row = _judged(decision, scene, observation, where)
    except ControllerError as error:
        fault = str(error).removeprefix(f"{where}: ")
        return Answer({REFUSED: fault}, None, fault)
    return Answer({**values_of(*row), **contents(decision.memory, "memory")}, decision)


def _judged(decision: Any, scene: Scene, observation: Observation, where: str) -> Row:
    """Numbers of a decision. Raises ControllerError for one at which a run would stop."""
    row = decision_row(decision, where)
    robot, time = np.array([observation.index]), observation.time
    command, hold = np.array([row.command]), np.array([row.hold])
    check_commands(scene, time, robot, command)
    rows = Decisions(robot, command, hold, np.array([row.mode]), np.array([row.report]))
    check_told(scene, time, rows)
    hold_steps(scene, time, robot, hold)
    return row


def values_of(command: Any, hold: float, mode: int, report: Any) -> Contents:
    """Numbers of a decision by name: ``command`` (2,), ``report`` (7,)."""
    modes = {int(one): Told(f"Mode.{one.name}") for one in Mode}
    told = [("v", command[0]), ("omega", command[1]), ("hold", hold)]
    told += zip(REPORT, report, strict=True)
    values = {name: float(value) if value == value else NAN for name, value in told}
    return {**values, "mode": modes.get(int(mode), Told("no mode"))}


def differs(one: Contents, other: Contents) -> str:
    """What is other in the second of two answers; empty where nothing is."""
    found = difference(one, other)
    if found is None:
        return ""
    for values, word in ((other, "it "), (one, "no more ")):
        if RAISES in values:
            return f"{word}raises {values[RAISES]}"
        if REFUSED in values:
            return f"{word}says what is refused: {values[REFUSED]}"
    return f"{found.place} is {found.after} instead of {found.before}"
