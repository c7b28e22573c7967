"""Decisions at a step: controllers are asked, and what they answer is checked."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from physim.errors import ControllerError
from physim.geometry.shapes import FloatArray, IntArray, locked, read_only
from physim.parts.controller import Controller, DecidesAll, Decisions
from physim.parts.declarations import Declared
from physim.parts.user_code import broken_by, is_shipped, naming
from physim.simulation.checks import next_steps, taken_decisions, widened
from physim.simulation.forms import Memory, asked_together, together
from physim.simulation.observation import View

NOBODY = read_only(np.zeros(0, dtype=np.int64))


class Decided(NamedTuple):
    """Nominal commands (N, columns) from a step on, and who decided at it."""

    nominal: FloatArray
    decisions: Decisions | None = None
    next_step: IntArray = NOBODY


class Asked(NamedTuple):
    """A controller as it is asked at a step."""

    controller: Controller
    form: DecidesAll
    declared: Declared
    is_shipped: bool

    @classmethod
    def of(cls, controller: Controller) -> Asked:
        """Raises ControllerError for what it declares amiss."""
        declared = Declared.of(controller)
        form = together(controller, declared)
        return cls(controller, form, declared, is_shipped(form))


def decide(asked: Asked, view: View, due: IntArray, held: FloatArray, memory: Memory) -> Decided:
    """Ask the robots that are due and check their answers; ``held`` are the commands so far.

    Writes ``memory``. Raises ControllerError for what cannot be done or recorded.
    """
    decisions, next_step = answered(asked, view, due, memory)
    nominal = held.copy()
    nominal[due] = decisions.command
    return Decided(read_only(nominal), locked(decisions), read_only(next_step))


def answered(asked: Asked, view: View, due: IntArray, memory: Memory) -> tuple[Decisions, IntArray]:
    """What a controller answers for the robots ``due``, checked, and the steps (M,) after it.

    Raises ControllerError as `decide`.
    """
    form, name = asked.form, type(asked.controller).__name__
    if asked.is_shipped:
        decisions = form.decide_all(view, due, memory)
    else:
        with naming(f"controller {name} at {view.time:g} s", form.decide_all):
            answer = asked_together(form, view, due, memory)
            decisions = taken_decisions(answer, due, len(asked.declared.columns))
    decisions = widened(decisions, view.scene)
    try:
        return decisions, next_steps(view.scene, view.sensed.step, decisions, asked.declared)
    except ControllerError as error:
        own = asked.controller
        method = own.decide_all if isinstance(own, DecidesAll) else own.decide
        told = broken_by(error, method)
        raise ControllerError(f"controller {name}, {told}") from None


def replaced(array: IntArray, at: IntArray, values: Any) -> IntArray:
    """Copy of an array with other values in some places."""
    new = array.copy()
    new[at] = values
    return read_only(new)
