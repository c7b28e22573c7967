"""Decisions at a step: controllers are asked, and what they answer is checked.

A controller that decides for one robot at a time is adapted to the batch form of the loop.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from itertools import islice
from math import nan
from operator import index
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from physim.errors import ControllerError, nearest
from physim.geometry.shapes import FloatArray, IntArray, locked, read_only
from physim.parts.controller import (
    BatchCapable,
    BatchController,
    Controller,
    Decision,
    Decisions,
    Sensed,
)
from physim.parts.declarations import NO_NUMBER, Declared, Mode, Rule
from physim.parts.user_code import asked, broken_by, is_shipped, kind_of, place_of
from physim.simulation.decision_checks import checked, plainly_fine
from physim.simulation.observation import Sight, Views
from physim.world.scene import Scene

_NO_NUMBER = (TypeError, ValueError, OverflowError)
"""What Python raises where something cannot be made a number."""


class Row(NamedTuple):
    """A decision as numbers: rows of `physim.parts.controller.Decisions`."""

    command: tuple[float, float]
    hold: float
    mode: int
    rule: int
    considered: list[int]
    report: list[float]


def decision_row(decision: object, declared: Declared, robots: int, robot: int) -> Row:
    """Numbers of a decision of a ``robot``, by index, among ``robots``.

    Raises ControllerError when it is no Decision, when one of its fields is of a wrong type, or
    names what the controller has not declared; or when a value of the user's own class fails as it
    is read.
    """
    if not isinstance(decision, Decision):
        given = type(decision).__name__
        raise ControllerError(f"decide returned {given}; it must return a Decision")
    try:
        return Row(
            (_number(decision.v, "v"), _number(decision.omega, "omega")),
            _number(decision.hold, "hold"),
            _declared(decision.mode, "mode", declared.modes),
            _declared(decision.rule, "rule", declared.rules),
            _considered(decision.considered, robots, robot),
            _report(decision.report, declared),
        )
    except (ControllerError, KeyboardInterrupt):
        raise
    except BaseException as error:
        text = f"decide returned what cannot be read: {broken_by(error)}"
        raise ControllerError(text) from error


def _number(value: object, field: str) -> float:
    if type(value) is float:
        return value
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        return float(value)  # type: ignore[arg-type]
    except _NO_NUMBER:
        given = _quoted(value)
        raise ControllerError(f"{field} is {given}; it must be a number") from None


def _declared(given: str | Mode | Rule | None, field: str, among: Sequence[Mode | Rule]) -> int:
    """Number of a declared mode or rule, given by name or as it was declared."""
    if given is None:
        return NO_NUMBER
    name = getattr(given, "name", given)
    for number, one in enumerate(among):
        if one.name == name and (given is name or given == one):
            return number
    names = [one.name for one in among]
    hint = nearest(name[:100], names) if isinstance(name, str) else ""
    allowed = f"declared: {', '.join(names)}" if names else f"the controller declares no {field}s"
    raise ControllerError(f"{field} is {_quoted(given)}; {allowed}{hint}")


def _considered(given: object, robots: int, robot: int) -> list[int]:
    if type(given) is tuple and not given:
        return []
    try:
        found = [index(j) for j in islice(given, robots + 1)]  # type: ignore[call-overload]
    except TypeError:
        raise ControllerError(
            f"considered is {_quoted(given)}; it must list robots by index"
        ) from None
    if any(not 0 <= j < robots for j in found) or len(set(found)) < len(found):
        raise ControllerError(
            f"considered is {_quoted(given)}; it must list robots 0 to {robots - 1}, each once"
        )
    if robot in found:
        raise ControllerError(
            f"considered is {_quoted(given)}; it lists the robot itself, which is {robot}; it must "
            "list others"
        )
    return found


def _report(report: object, declared: Declared) -> list[float]:
    """Numbers of a report, one a declared column; NaN where one is left out or None."""
    if not isinstance(report, Mapping):
        raise ControllerError(
            f"report is a {type(report).__name__}; it must be a mapping of columns"
        )
    if not report and not declared.columns:
        return []
    names = [column.name for column in declared.columns]
    for name in report:
        if name not in names:
            hint = nearest(name[:100], names) if isinstance(name, str) else ""
            allowed = ", ".join(names) or "none, give the controller some: columns = (Column(...),)"
            raise ControllerError(
                f"report names {_quoted(name)}, which is not declared; declared: {allowed}{hint}"
            )
    values = (report.get(name) for name in names)
    return [
        nan if value is None else _number(value, f"report {name}")
        for name, value in zip(names, values, strict=True)
    ]


def _quoted(value: object) -> str:
    """What was given, on one line and cut off where it is long."""
    try:
        text = " ".join(repr(value).split())
    except KeyboardInterrupt:
        raise
    except BaseException:  # of code that is not ours; or a whole number too long to be written out
        text = f"of type {type(value).__name__}"
    return text if len(text) <= 60 else f"{text[:57]}..."


def broken(error: BaseException, where: str) -> ControllerError:
    """One line about an error inside a controller: type, text, and the line it arose on."""
    return ControllerError(f"{where}: {broken_by(error)}")


NOBODY = read_only(np.zeros(0, dtype=np.int64))


class Decided(NamedTuple):
    """Nominal commands (N, 2) from a step on, and who decided at it."""

    nominal: FloatArray
    decisions: Decisions | None = None
    next_step: IntArray = NOBODY


def begun(
    controller: Controller, scene: Scene, declared: Declared
) -> tuple[BatchController, dict[str, NDArray[Any]]]:
    """Batch form of a controller, and the memory with which it begins.

    Raises ControllerError where one of the user's own fails.
    """
    if not isinstance(controller, BatchCapable):
        plain = PerRobotAdapter(controller, scene, declared)
        return plain, plain.memory()
    try:
        batch = controller.batch(scene)
        if lacking := [one for one in ("memory", "decide_due") if not hasattr(batch, one)]:
            raise ControllerError(
                f"controller {type(controller).__name__}: batch(scene) gives {kind_of(batch)}; it "
                f"must give an object with {' and '.join(lacking)}{place_of(controller.batch)}"
            )
        return batch, batch.memory()
    except (ControllerError, KeyboardInterrupt):
        raise
    except BaseException as error:
        if is_shipped(controller):
            raise
        raise broken(error, f"controller {type(controller).__name__}, batch form") from error


NUMBERS_OF = ("robot", "mode", "rule", "considered", "considered_start")
"""Fields of decisions that number something"""


def unreadable(decisions: object, due: IntArray) -> str:
    """Why what a batch form returned is not a row for each robot asked for; empty where it is."""
    if not isinstance(decisions, Decisions):
        return f"returned {type(decisions).__name__}; it must return Decisions"
    for name, values in zip(decisions._fields, decisions, strict=True):
        kinds, what = ("iu", "whole numbers") if name in NUMBERS_OF else ("fiu", "numbers")
        if not isinstance(values, np.ndarray) or values.dtype.kind not in kinds:
            return f"returned {name} that is not an array of {what}"
        if not values.ndim or isinstance(values, np.ma.MaskedArray | np.matrix):
            return f"returned {name} of type {type(values).__name__}, shape {values.shape}"
    if decisions.command.shape != (len(due), 2):
        return f"returned command of shape {decisions.command.shape}; it must be {(len(due), 2)}"
    if not np.array_equal(decisions.robot, due):
        given = np.asarray(decisions.robot).tolist()
        return f"decided for robots {given} when asked for {due.tolist()}"
    return ""


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
    try:
        decisions = batch.decide_due(sensed, due, memory)
        if not is_shipped(batch):
            if fault := unreadable(decisions, due):
                where = f"{type(batch).__name__}.decide_due at {sensed.step * scene.dt:g} s"
                raise ControllerError(f"{where} {fault}{place_of(batch.decide_due)}")
            decisions = copy.deepcopy(decisions)  # it may write its own arrays again
        next_step = plainly_fine(scene, sensed.step, due, decisions, declared)
    except (ControllerError, KeyboardInterrupt):
        raise
    except BaseException as error:
        if is_shipped(batch):
            raise
        where = f"{type(batch).__name__}.decide_due at {sensed.step * scene.dt:g} s"
        raise broken(error, where) from error
    if next_step is None:
        try:
            next_step = checked(scene, sensed.step, due, decisions, declared)
        except ControllerError as error:
            name = type(getattr(batch, "controller", batch)).__name__
            plain = batch.controller if isinstance(batch, PerRobotAdapter) else None
            written = batch.decide_due if plain is None else plain.decide
            raise ControllerError(f"controller {name}: {error}{place_of(written)}") from None
    nominal = held.copy()
    nominal[due] = decisions.command
    return Decided(read_only(nominal), locked(decisions), read_only(next_step))


DECIDE = "decide(observation, memory)"
MEMORY = "memory"
"""Name of the one array of a plain controller's memories: (N,) of Python values."""


class PerRobotAdapter:
    """A controller that decides for one robot at a time, asked for each robot that is due."""

    def __init__(self, controller: Controller, scene: Scene, declared: Declared) -> None:
        self.controller = controller
        self.scene = scene
        self.declared = declared
        self.sight = Sight(scene)

    def memory(self) -> dict[str, NDArray[Any]]:
        """What each robot's last decision returned: None at first."""
        return {MEMORY: np.full(self.scene.robots, None, dtype=object)}

    def decide_due(
        self, sensed: Sensed, due: IntArray, memory: dict[str, NDArray[Any]]
    ) -> Decisions:
        """Decide for robots ``due``; every one sees the same snapshot, whatever their order."""
        rows, memories, views = [], [], Views(self.sight, sensed, due)
        for i in due.tolist():
            decision, row = self._decide(i, views, memory[MEMORY][i])
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

    def _decide(self, i: int, views: Views, memory: Any) -> tuple[Decision, Row]:
        observation = views.observation(i)
        try:
            decision = asked(self.controller.decide, DECIDE, observation, memory)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise broken(error, self._where(i, views)) from error
        try:
            return decision, decision_row(decision, self.declared, self.scene.robots, i)
        except ControllerError as error:
            place = place_of(self.controller.decide)
            raise ControllerError(f"{self._where(i, views)}: {error}{place}") from None

    def _where(self, i: int, views: Views) -> str:
        name = type(self.controller).__name__
        return f"controller {name}, {self.scene.names[i]} at {views.time:g} s"
