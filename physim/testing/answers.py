"""Asking a controller once, as a run would, and what it answered as values to compare."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from physim.control import Controller, Decision, Decisions, Observation
from physim.control_decisions import Row, broken, decision_row
from physim.control_loop import check_commands, hold_steps
from physim.declared import Declared
from physim.errors import ControllerError, PhysimError
from physim.geometry.shapes import IntArray
from physim.scene import Scene
from physim.testing.contents import NAN, Contents, Label, contents, difference

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


def ask(controller: Controller, scene: Scene, observation: Observation, memory: Any) -> Answer:
    """Ask a controller; what it is given is handed over as it is."""
    where = f"{observation.name} at {observation.time:g} s"
    try:
        decision = controller.decide(observation, memory)
    except (Exception, SystemExit) as error:
        reported = error if isinstance(error, PhysimError) else broken(error, where)
        fault = str(reported).removeprefix(f"{where}: ")
        return Answer({RAISES: type(error).__name__}, None, fault)
    robot, time = np.array([observation.index]), observation.time
    try:
        declared = Declared.of(controller)
        row = decision_row(decision, where, declared, scene.robots)
        check_commands(scene, time, robot, np.array([row.command]))
        hold_steps(scene, time, robot, np.array([row.hold]))
    except ControllerError as error:
        fault = str(error).removeprefix(f"{where}: ")
        return Answer({REFUSED: fault}, None, fault)
    return Answer({**values_of(row, declared), **contents(decision.memory, "memory")}, decision)


def unreadable(decisions: object, due: IntArray) -> str:
    """Why what a batch form returned is not a row for each robot asked for; empty where it is."""
    if not isinstance(decisions, Decisions):
        return f"returned {type(decisions).__name__}; it must return Decisions"
    for name, values in zip(decisions._fields, decisions, strict=True):
        if not isinstance(values, np.ndarray) or values.dtype.kind not in "fiu":
            return f"returned {name} that is no array of numbers"
    if decisions.command.shape != (len(due), 2):
        return f"returned command of shape {decisions.command.shape}; it must be {(len(due), 2)}"
    if not np.array_equal(decisions.robot, due):
        given = np.asarray(decisions.robot).tolist()
        return f"decided for robots {given} when asked for {due.tolist()}"
    return ""


def rows_of(decisions: Decisions) -> dict[int, Row]:
    """Numbers of each decision of a batch, by robot."""
    start = decisions.considered_start
    return {
        int(robot): Row(
            (float(decisions.command[k, 0]), float(decisions.command[k, 1])),
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
    numbers = {"v": row.command[0], "omega": row.command[1], "hold": row.hold}
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


def other_answer(one: Contents, other: Contents) -> str:
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
