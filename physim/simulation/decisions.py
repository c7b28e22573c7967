"""Decisions at a step: controllers are asked, and what they answer is checked.

A controller that decides for one robot at a time is adapted to the batch form of the loop.
"""

from __future__ import annotations

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
from physim.parts.user_code import broken_by, is_shipped, kind_of, naming
from physim.simulation.checks import next_steps, taken_decisions
from physim.simulation.observation import View
from physim.world.scene import Scene


class Row(NamedTuple):
    """A decision as numbers: rows of `physim.parts.controller.Decisions`."""

    command: tuple[float, float]
    hold: float
    mode: int
    rule: int
    considered: list[int]
    report: list[float]


def decision_row(decision: object, declared: Declared, robots: int) -> Row:
    """Numbers of a decision of one among ``robots``.

    Raises ControllerError when it is no Decision, when one of its fields is of a wrong type, or
    names what the controller has not declared.
    """
    if not isinstance(decision, Decision):
        raise ControllerError(f"decide returned {kind_of(decision)}; it must return a Decision")
    try:
        considered = [index(j) for j in islice(decision.considered, robots + 1)]
    except TypeError:
        raise ControllerError(
            f"considered is {_quoted(decision.considered)}; it must list robots by index"
        ) from None
    return Row(
        (_number(decision.v, "v"), _number(decision.omega, "omega")),
        _number(decision.hold, "hold"),
        _declared(decision.mode, "mode", declared.modes),
        _declared(decision.rule, "rule", declared.rules),
        considered,
        _report(decision.report, declared),
    )


def _number(value: object, field: str) -> float:
    if type(value) is float:
        return value
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise ControllerError(f"{field} is {_quoted(value)}; it must be a number") from None


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


def _report(report: object, declared: Declared) -> list[float]:
    """Numbers of a report, one a declared column; NaN where one is left out or None."""
    if not isinstance(report, Mapping):
        raise ControllerError(f"report is {kind_of(report)}; it must be a mapping of columns")
    if not report:
        return [nan] * len(declared.columns)
    names = [column.name for column in declared.columns]
    for name in report:
        if name not in names:
            hint = nearest(name[:100], names) if isinstance(name, str) else ""
            allowed = ", ".join(names) or "none, give the controller some: columns = (Column(...),)"
            raise ControllerError(
                f"report names {_quoted(name)}, which is not declared; declared: {allowed}{hint}"
            )
    values = ((name, report.get(name)) for name in names)
    return [nan if one is None else _number(one, f"report {name}") for name, one in values]


def _quoted(value: object) -> str:
    """What was given, on one line and cut off where it is long."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."


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
    if is_shipped(controller) and isinstance(controller, BatchCapable):
        ours = controller.batch(scene)
        return ours, ours.memory()
    if not isinstance(controller, BatchCapable):
        plain = PerRobotAdapter(controller, scene, declared)
        return plain, plain.memory()
    with naming(f"controller {type(controller).__name__}, batch form", controller.batch):
        batch = controller.batch(scene)
        if lacking := [one for one in ("memory", "decide_due") if not hasattr(batch, one)]:
            raise ControllerError(
                f"batch(scene) gives {kind_of(batch)}; it must give an object with "
                f"{' and '.join(lacking)}"
            )
        return batch, batch.memory()


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
    decisions, next_step = answered(batch, scene, declared, sensed, due, memory)
    nominal = held.copy()
    nominal[due] = decisions.command
    return Decided(read_only(nominal), locked(decisions), read_only(next_step))


def answered(
    batch: BatchController,
    scene: Scene,
    declared: Declared,
    sensed: Sensed,
    due: IntArray,
    memory: dict[str, NDArray[Any]],
) -> tuple[Decisions, IntArray]:
    """What a controller answers for the robots ``due``, checked, and the steps (M,) after it.

    Raises ControllerError as `decide`.
    """
    if is_shipped(batch):
        decisions = batch.decide_due(sensed, due, memory)
    else:
        where = f"{type(batch).__name__}.decide_due at {sensed.step * scene.dt:g} s"
        with naming(where, batch.decide_due):
            answer = batch.decide_due(sensed, due, memory)
            decisions = taken_decisions(answer, due, len(declared.columns))
    try:
        return decisions, next_steps(scene, sensed.step, decisions, declared)
    except ControllerError as error:
        plain = batch.controller if isinstance(batch, PerRobotAdapter) else None
        told = broken_by(error, batch.decide_due if plain is None else plain.decide)
        raise ControllerError(f"controller {type(plain or batch).__name__}, {told}") from None


MEMORY = "memory"
"""Name of the one array of a plain controller's memories: (N,) of Python values."""


class PerRobotAdapter:
    """A controller that decides for one robot at a time, asked for each robot that is due."""

    def __init__(self, controller: Controller, scene: Scene, declared: Declared) -> None:
        self.controller = controller
        self.scene = scene
        self.declared = declared
        self.view: View | None = None

    def memory(self) -> dict[str, NDArray[Any]]:
        """What each robot's last decision returned: None at first."""
        return {MEMORY: np.full(self.scene.robots, None, dtype=object)}

    def decide_due(
        self, sensed: Sensed, due: IntArray, memory: dict[str, NDArray[Any]]
    ) -> Decisions:
        """Decide for robots ``due``; every one sees the same snapshot, whatever their order."""
        rows, memories = [], []
        views = self.view = View(self.scene, sensed, self.view)
        name, ask = type(self.controller).__name__, self.controller.decide
        for i in due.tolist():
            where = f"controller {name}, {self.scene.names[i]} at {views.time:g} s"
            with naming(where, ask):
                decision = ask(views.observation(i), memory[MEMORY][i])
                rows.append(decision_row(decision, self.declared, self.scene.robots))
                memories.append(decision.memory)
        for i, value in zip(due, memories, strict=True):
            memory[MEMORY][i] = value
        return decisions_of(due, rows, len(self.declared.columns))


def decisions_of(due: IntArray, rows: Sequence[Row], columns: int) -> Decisions:
    """Rows of the robots ``due`` as arrays; each reports so many columns."""
    considered = [row.considered for row in rows]
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
