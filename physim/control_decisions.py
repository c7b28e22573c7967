"""What a plain controller returned, checked field by field and turned into numbers."""

from __future__ import annotations

import traceback
from typing import NamedTuple

from physim.control import NO_MODE, Decision, Mode, Report
from physim.errors import ControllerError


class Row(NamedTuple):
    """A decision as numbers: rows of `physim.control.Decisions`."""

    command: tuple[float, float]
    hold: float
    mode: int
    report: tuple[float, ...]


def decision_row(decision: object, where: str) -> Row:
    """Numbers of a decision.

    Raises ControllerError, which begins with ``where``, when it is no Decision or one of its
    fields is of a wrong type.
    """
    if not isinstance(decision, Decision):
        given = type(decision).__name__
        raise ControllerError(f"{where}: decide returned {given}; it must return a Decision")
    report: object = decision.report
    if not isinstance(report, Report):
        given = type(report).__name__
        raise ControllerError(f"{where}: report is a {given}; it must be a Report")
    command = (_number(decision, "v", where), _number(decision, "omega", where))
    return Row(command, _number(decision, "hold", where), _mode(decision, where), _report(decision))


def _number(decision: Decision, field: str, where: str) -> float:
    value: object = getattr(decision, field)
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise ControllerError(f"{where}: {field} is {value!r}; it must be a number") from None


def _mode(decision: Decision, where: str) -> int:
    if decision.mode is None:
        return NO_MODE
    try:
        return int(Mode(decision.mode))
    except ValueError:
        allowed = ", ".join(f"Mode.{mode.name}" for mode in Mode)
        message = f"{where}: mode is {decision.mode!r}; allowed: {allowed}"
        raise ControllerError(message) from None


def _report(decision: Decision) -> tuple[float, ...]:
    r = decision.report
    return (
        *r.target,
        r.distance,
        r.boundary_distance,
        r.collision_time,
        float(r.considered),
        float(r.evaluations),
    )


def broken(error: BaseException, where: str) -> ControllerError:
    """One line about an error inside a controller: type, text, and the line it arose on."""
    text = " ".join(str(error).split())[:200]
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({frames[-1].filename}:{frames[-1].lineno})" if frames else ""
    return ControllerError(f"{where}: {type(error).__name__}: {text}{place}")
