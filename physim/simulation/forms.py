"""The forms of a controller, each made of the other.

`together` asks a plain controller for one due robot after the other; `per_robot` asks one that
decides for all robots at once for the robot of an observation, whose view it kept.
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
from physim.geometry.shapes import IntArray
from physim.parts.controller import (
    Controller,
    DecidesAll,
    DecidesOne,
    Decision,
    Decisions,
    Observation,
)
from physim.parts.declarations import NO_NUMBER, Declared, Mode, Rule
from physim.parts.user_code import is_shipped, kind_of, naming
from physim.simulation.checks import next_steps, taken_decisions, widened
from physim.simulation.observation import View
from physim.world.scene import Scene

Memory = dict[str, NDArray[Any]]
"""Named arrays, with a row for each robot"""
MEMORY = "memory"
"""Name of the one array of a plain controller's memories: (N,) of Python values."""


def together(controller: Controller, declared: Declared) -> DecidesAll:
    """A controller as it decides for all due robots: itself, or asked for one after the other."""
    return controller if isinstance(controller, DecidesAll) else OneByOne(controller, declared)


def per_robot(controller: Controller) -> DecidesOne:
    """A controller as it decides for one robot: itself, or asked for that robot alone.

    So a controller of one's own may ask the paper's: keep ``per_robot(ModeSwitching())`` and call
    its ``decide(observation, memory)``, with the memory of its last decision, at first None. The
    observation must be one that a simulation gave, unchanged: else ControllerError.
    """
    return controller if isinstance(controller, DecidesOne) else AskedAlone(controller)


def first_memory(form: DecidesAll, scene: Scene) -> Memory:
    """Memory before the first decision, by the method ``start`` of a form, if it has one.

    Raises ControllerError where that fails or gives something else.
    """
    start = getattr(form, "start", None)
    if start is None:
        return {}
    if is_shipped(form):
        return dict(start(scene))
    with naming(f"controller {type(form).__name__}, start", start):
        given = {} if (found := start(scene)) is None else found
        if not isinstance(given, Mapping):
            raise ControllerError(
                f"start returned {kind_of(given)}; beside decide_all it must return a mapping of "
                f"named arrays with a row for each of {scene.robots} robots, or None"
            )
        for name, array in given.items():
            if not isinstance(array, np.ndarray) or array.shape[:1] != (scene.robots,):
                raise ControllerError(
                    f"memory {name!r} is {kind_of(array)}; it must be an array with a row for each "
                    f"of {scene.robots} robots"
                )
        return {str(name): array.copy() for name, array in given.items()}


def asked_together(form: DecidesAll, view: View, due: IntArray, memory: Memory) -> Decisions:
    """What a form of a user's answers, unchecked. Raises ControllerError for new memory."""
    known = set(memory)
    answer = form.decide_all(view, due, memory)
    if new := [name for name in memory if name not in known]:
        raise ControllerError(
            f"decide_all puts a new {new[0]!r} into memory; give it at the start: def start(self, "
            f"scene): return {{{new[0]!r}: np.zeros(scene.robots)}}, a row for each robot"
        )
    return answer


class OneByOne:
    """A plain controller, asked for each robot that is due."""

    def __init__(self, controller: DecidesOne, declared: Declared) -> None:
        self.controller = controller
        self.declared = declared

    def start(self, scene: Scene) -> Memory:
        """What each robot remembers at first: by the controller's ``start``, or None."""
        first = np.full(scene.robots, None, dtype=object)
        if (start := getattr(self.controller, "start", None)) is not None:
            with naming(f"controller {type(self.controller).__name__}, start", start):
                if (given := start(scene)) is not None:
                    if not isinstance(given, Sequence | np.ndarray) or isinstance(given, str):
                        given = ()
                    if len(given) != scene.robots:
                        raise ControllerError(
                            f"start returned {kind_of(given)}; it must return the first memory of "
                            f"each of {scene.robots} robots in their order, or None"
                        )
                    for i, value in enumerate(given):
                        first[i] = value
        return {MEMORY: first}

    def decide_all(self, view: View, due: IntArray, memory: Memory) -> Decisions:
        """Decide for robots ``due``; every one sees the same view, whatever their order."""
        rows, memories = [], []
        name, ask = type(self.controller).__name__, self.controller.decide
        for i in due.tolist():
            with naming(f"controller {name}, {view.scene.names[i]} at {view.time:g} s", ask):
                decision = ask(view.observation(i), memory[MEMORY][i])
                rows.append(decision_row(decision, self.declared, view.scene))
                memories.append(decision.memory)
        for i, value in zip(due, memories, strict=True):
            memory[MEMORY][i] = value
        return decisions_of(due, rows, len(self.declared.columns))


class AskedAlone:
    """A controller that decides for all robots, asked for one."""

    def __init__(self, controller: DecidesAll) -> None:
        self.controller = controller
        self.declared = Declared.of(controller)
        self.modes, self.rules = self.declared.modes, self.declared.rules
        self.columns = self.declared.columns

    def decide(self, observation: Observation, memory: Any) -> Decision:
        """Decide for the robot that made the observation, from the rows of its view alone."""
        view, i, declared = observation.__dict__.get("_view"), observation.index, self.declared
        if view is None:
            raise ControllerError(
                f"{type(self.controller).__name__} decides from the view that an observation was "
                "made of; this one was made or changed by hand: hand on one that a simulation gave"
            )
        whole = {name: array.copy() for name, array in view.prepared(self._first).items()}
        for name, row in (memory or {}).items():
            whole[name][i : i + 1] = row
        due = np.array([i])
        answer = asked_together(self.controller, view, due, whole)
        d = widened(taken_decisions(answer, due, len(declared.columns)), view.scene)
        next_steps(view.scene, view.sensed.step, d, declared)
        mode, rule = int(d.mode[0]), int(d.rule[0])
        return Decision(
            v=float(d.command[0, 0]),
            omega=float(d.command[0, 1]),
            hold=float(d.hold[0]),
            mode=None if mode == NO_NUMBER else declared.modes[mode],
            memory={name: array[i : i + 1].copy() for name, array in whole.items()},
            rule=None if rule == NO_NUMBER else declared.rules[rule],
            considered=d.considered.tolist(),
            report={
                one.name: value
                for one, value in zip(declared.columns, d.report[0].tolist(), strict=True)
            },
            lateral=float(d.command[0, 2:].sum()),
        )

    def _first(self, scene: Scene) -> Memory:
        return first_memory(self.controller, scene)


# A decision as numbers


class Row(NamedTuple):
    """A decision as numbers: rows of `physim.parts.controller.Decisions`."""

    command: tuple[float, ...]
    """of the scene's columns"""
    hold: float
    mode: int
    rule: int
    considered: list[int]
    report: list[float]


def decision_row(decision: object, declared: Declared, scene: Scene) -> Row:
    """Numbers of a decision of one robot of a scene.

    Raises ControllerError when it is no Decision, when one of its fields is of a wrong type, or
    names what the controller has not declared; for a lateral speed where no robot has one.
    """
    if not isinstance(decision, Decision):
        raise ControllerError(f"decide returned {kind_of(decision)}; it must return a Decision")
    try:
        considered = [index(j) for j in islice(decision.considered, scene.moving + 1)]
    except TypeError:
        raise ControllerError(
            f"considered is {_quoted(decision.considered)}; it must list robots by index"
        ) from None
    command = [_number(getattr(decision, name), name) for name in ("v", "omega", "lateral")]
    if command[2] != 0.0 and scene.columns < 3:
        raise ControllerError(
            f"lateral = {command[2]:g} m/s; no robot of this world is omnidirectional, it must be 0"
        )
    return Row(
        (*command[: scene.columns],),
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


def decisions_of(due: IntArray, rows: Sequence[Row], columns: int) -> Decisions:
    """Rows of the robots ``due`` as arrays; each reports so many columns."""
    return Decisions.of(
        due,
        np.array([row.command for row in rows], dtype=np.float64),
        np.array([row.hold for row in rows], dtype=np.float64),
        mode=np.array([row.mode for row in rows], dtype=np.int64),
        rule=np.array([row.rule for row in rows], dtype=np.int64),
        report=np.array([row.report for row in rows], dtype=np.float64).reshape(len(due), columns),
        considered=[row.considered for row in rows],
    )
