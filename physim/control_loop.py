"""Between controllers and the loop: per-robot controllers as a batch, and checks of answers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physim.author_code import asked
from physim.control import LONGEST_HOLD, BatchController, Controller, Decision, Decisions, Sensed
from physim.control_decisions import Row, broken, decision_row
from physim.declared import NO_NUMBER, Declared
from physim.errors import ControllerError, PhysimError
from physim.geometry.shapes import FloatArray, IntArray, read_only
from physim.perception import observe
from physim.scene import Scene
from physim.tolerances import SHARE

COMMAND = (("v", "m/s"), ("omega", "rad/s"))
"""Quantity and unit of either part of a command."""
NOBODY = read_only(np.zeros(0, dtype=np.int64))


class Decided(NamedTuple):
    """Nominal commands (N, 2) from a step on, and who decided at it."""

    nominal: FloatArray
    decisions: Decisions | None = None
    next_step: IntArray = NOBODY


def decide(
    batch: BatchController,
    scene: Scene,
    declared: Declared,
    sensed: Sensed,
    due: IntArray,
    held: FloatArray,
    memory: dict[str, NDArray[Any]],
) -> Decided:
    """Ask the robots that are due and check their answers; ``held`` (N, 2) are commands so far.

    Writes ``memory``. Raises ControllerError for what cannot be done or recorded.
    """
    time = sensed.step * scene.dt
    decisions = batch.decide_due(sensed, due, memory)
    try:
        check_commands(scene, time, due, decisions.command)
        check_told(scene, time, decisions, declared)
        next_step = sensed.step + hold_steps(scene, time, due, decisions.hold)
    except ControllerError as error:
        name = type(getattr(batch, "controller", batch)).__name__
        raise ControllerError(f"controller {name}: {error}") from None
    nominal = held.copy()
    nominal[due] = decisions.command
    return Decided(read_only(nominal), decisions, next_step)


DECIDE = "decide(observation, memory)"
MEMORY = "memory"
"""Name of the one array of a plain controller's memories: (N,) of Python values."""


class PlainBatch:
    """A controller that decides for one robot at a time, asked for each robot that is due."""

    def __init__(self, controller: Controller, scene: Scene, declared: Declared) -> None:
        self.controller = controller
        self.scene = scene
        self.declared = declared

    def memory(self) -> dict[str, NDArray[Any]]:
        """What each robot's last decision returned: None at first."""
        return {MEMORY: np.full(self.scene.robots, None, dtype=object)}

    def decide_due(
        self, sensed: Sensed, due: IntArray, memory: dict[str, NDArray[Any]]
    ) -> Decisions:
        """Decide for robots ``due``; every one sees the same snapshot, whatever their order."""
        rows, memories = [], []
        for i in due.tolist():
            decision, row = self._decide(i, sensed, memory[MEMORY][i])
            rows.append(row)
            memories.append(decision.memory)
        for i, value in zip(due, memories, strict=True):
            memory[MEMORY][i] = value
        considered = [row.considered for row in rows]
        columns = len(self.declared.columns)
        return Decisions(
            due,
            np.array([row.command for row in rows], dtype=np.float64),
            np.array([row.hold for row in rows], dtype=np.float64),
            np.array([row.mode for row in rows], dtype=np.int64),
            np.array([row.rule for row in rows], dtype=np.int64),
            np.array([row.report for row in rows], dtype=np.float64).reshape(len(due), columns),
            np.array([j for robots in considered for j in robots], dtype=np.int64),
            np.cumsum([0, *(len(robots) for robots in considered)]).astype(np.int64),
        )

    def _decide(self, i: int, sensed: Sensed, memory: Any) -> tuple[Decision, Row]:
        name, time = type(self.controller).__name__, sensed.step * self.scene.dt
        where = f"controller {name}, {self.scene.names[i]} at {time:g} s"
        try:
            observation = observe(self.scene, sensed, i)
            decision = asked(self.controller.decide, DECIDE, observation, memory)
        except PhysimError:
            raise
        except (Exception, SystemExit) as error:
            raise broken(error, where) from error
        return decision, decision_row(decision, where, self.declared, self.scene.robots)


def outside(scene: Scene, time: float, given: ArrayLike) -> FloatArray:
    """Commands (N, 2) from outside, a copy; ControllerError where robots cannot take them."""
    try:
        nominal = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise ControllerError(f"commands at {time:g} s are no array of numbers (N, 2)") from None
    check_commands(scene, time, np.arange(scene.robots), nominal)
    return read_only(nominal)


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
    quantity, unit = COMMAND[column]
    raise ControllerError(
        f"{scene.names[robots[row]]} at {time:g} s: command {quantity} = "
        f"{command[row, column]:g} {unit}; it must be finite and within "
        f"{scene.limits[robots[row], column]:g} {unit} either way"
    )


def check_applied(scene: Scene, time: float, applied: FloatArray, part: object) -> None:
    """Refuse applied commands that are no finite (N, 2)."""
    name, shape = type(part).__name__, (scene.robots, 2)
    if np.shape(applied) != shape:
        raise ControllerError(
            f"disturbance {name}: commands at {time:g} s have the shape {np.shape(applied)}; it "
            f"must be {shape}"
        )
    if not np.isfinite(applied).all():
        row, column = np.argwhere(~np.isfinite(applied))[0]
        quantity, unit = COMMAND[column]
        raise ControllerError(
            f"disturbance {name}: {scene.names[row]} at {time:g} s: command {quantity} = "
            f"{applied[row, column]:g} {unit}; it must be finite"
        )


def check_told(scene: Scene, time: float, decisions: Decisions, declared: Declared) -> None:
    """Refuse numbers of modes, rules and robots, and shapes, that no record may hold."""
    d, robots = decisions, decisions.robot
    many = len(robots)
    start = d.considered_start
    shapes = (
        ("hold", d.hold.shape, (many,)),
        ("mode", d.mode.shape, (many,)),
        ("rule", d.rule.shape, (many,)),
        ("report", d.report.shape, (many, len(declared.columns))),
        ("considered_start", start.shape, (many + 1,)),
    )
    for name, found, wanted in shapes:
        if found != wanted:
            raise ControllerError(
                f"decisions at {time:g} s: {name} has the shape {found}; it must be {wanted}"
            )
    for name, values, most in (
        ("mode", d.mode, len(declared.modes)),
        ("rule", d.rule, len(declared.rules)),
    ):
        if values.min() < NO_NUMBER or values.max() >= most:
            row = int(np.argmax((values < NO_NUMBER) | (values >= most)))
            raise ControllerError(
                f"{scene.names[robots[row]]} at {time:g} s: {name} = {values[row]}; allowed: "
                f"{NO_NUMBER} to {most - 1}"
            )
    if len(d.considered) and (d.considered.min() < 0 or d.considered.max() >= scene.robots):
        raise ControllerError(
            f"decisions at {time:g} s: considered robots {d.considered.min()} to "
            f"{d.considered.max()}; allowed: 0 to {scene.robots - 1}"
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
