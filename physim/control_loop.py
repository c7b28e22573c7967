"""Between controllers and the loop: plain controllers as a batch, and checks of what they say."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from physim.control import (
    LONGEST_HOLD,
    NO_MODE,
    Controller,
    Decision,
    Decisions,
    Mode,
    Observation,
    Snapshot,
)
from physim.control_decisions import Row, broken, decision_row
from physim.errors import ControllerError, PhysimError
from physim.geometry.shapes import FloatArray, IntArray
from physim.scene import Scene
from physim.tolerances import SHARE


class PlainBatch:
    """A controller that decides for one robot at a time, asked for each robot that is due."""

    def __init__(
        self, controller: Controller, scene: Scene, observe: Callable[[int], Observation]
    ) -> None:
        self.controller = controller
        self.scene = scene
        self.observe = observe
        self.memory: list[Any] = [None] * scene.robots

    def decide_due(self, snapshot: Snapshot, due: IntArray) -> Decisions:
        """Decide for robots ``due``; every one sees the same snapshot, whatever their order."""
        rows, memories = [], []
        for i in due.tolist():
            decision, row = self._decide(i, snapshot.step * self.scene.dt)
            rows.append(row)
            memories.append(decision.memory)
        for i, memory in zip(due, memories, strict=True):
            self.memory[i] = memory
        return Decisions(
            due,
            np.array([row.command for row in rows], dtype=np.float64),
            np.array([row.hold for row in rows], dtype=np.float64),
            np.array([row.mode for row in rows], dtype=np.int64),
            np.array([row.report for row in rows], dtype=np.float64),
        )

    def _decide(self, i: int, time: float) -> tuple[Decision, Row]:
        name = type(self.controller).__name__
        where = f"controller {name}, {self.scene.names[i]} at {time:g} s"
        try:
            decision = self.controller.decide(self.observe(i), self.memory[i])
        except PhysimError:
            raise
        except (Exception, SystemExit) as error:
            raise broken(error, where) from error
        return decision, decision_row(decision, where)


def as_commands(given: ArrayLike, time: float) -> FloatArray:
    """Commands as an array of floats, a copy; ControllerError where they are no numbers."""
    try:
        return np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise ControllerError(f"commands at {time:g} s are no array of numbers (N, 2)") from None


def check_commands(scene: Scene, time: float, robots: IntArray, command: FloatArray) -> None:
    """Refuse commands (M, 2) that are not finite or beyond the robots' limits."""
    if command.shape != (len(robots), 2):
        raise ControllerError(
            f"commands at {time:g} s have the shape {command.shape}; it must be ({len(robots)}, 2)"
        )
    allowed = scene.limits[robots] * (1.0 + SHARE)
    fine = np.abs(command) <= allowed  # False for NaN
    if fine.all():
        return
    row, column = np.argwhere(~fine)[0]
    quantity, unit = (("v", "m/s"), ("omega", "rad/s"))[column]
    raise ControllerError(
        f"{scene.names[robots[row]]} at {time:g} s: command {quantity} = "
        f"{command[row, column]:g} {unit}; it must be finite and within "
        f"{scene.limits[robots[row], column]:g} {unit} either way"
    )


def check_told(scene: Scene, time: float, decisions: Decisions) -> None:
    """Refuse modes and counts of robots that no record may hold."""
    considered, evaluations = decisions.report[:, 5], decisions.report[:, 6]
    bodies = len(scene.bodies)
    for values, low, high, name in (
        (decisions.mode, NO_MODE, max(Mode), "mode"),
        (considered, 0, bodies, "report: considered"),
        (evaluations, 0, np.iinfo(np.int32).max, "report: evaluations"),
    ):
        fine = (values >= low) & (values <= high)  # False for NaN
        if not fine.all():
            row = int(np.argmin(fine))
            raise ControllerError(
                f"{scene.names[decisions.robot[row]]} at {time:g} s: {name} = {values[row]:g}; "
                f"allowed: {int(low)} to {int(high)}"
            )


def hold_steps(scene: Scene, time: float, robots: IntArray, hold: FloatArray) -> IntArray:
    """Steps (M,) that decisions hold: ``hold`` [s] rounded down, one at least (14)."""
    fine = hold >= 0.0
    if not fine.all():
        row = int(np.argmin(fine))
        raise ControllerError(
            f"{scene.names[robots[row]]} at {time:g} s: hold = {hold[row]:g} s; it must be a "
            "time of at least 0 s"
        )
    steps = np.floor(hold / scene.dt + SHARE)
    return np.minimum(np.maximum(steps, 1.0), LONGEST_HOLD).astype(np.int64)
