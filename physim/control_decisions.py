"""What a plain controller returned, checked field by field and turned into numbers."""

from __future__ import annotations

import traceback
from array import array
from math import nan
from typing import Any, NamedTuple

from physim.control import NO_MODE, Decision, Mode, Report
from physim.errors import ControllerError

_NO_NUMBER = (TypeError, ValueError, OverflowError)
"""What Python raises where something cannot be made a number."""


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
    told = _report(report, where)
    return Row(command, _number(decision, "hold", where), _mode(decision, where), told)


def _number(decision: Decision, field: str, where: str) -> float:
    value: object = getattr(decision, field)
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        return float(value)  # type: ignore[arg-type]
    except _NO_NUMBER:
        given = _shown(value)
        raise ControllerError(f"{where}: {field} is {given}; it must be a number") from None


def _mode(decision: Decision, where: str) -> int:
    if decision.mode is None:
        return NO_MODE
    try:
        return int(Mode(decision.mode))
    except ValueError:
        allowed = ", ".join(f"Mode.{mode.name}" for mode in Mode)
        message = f"{where}: mode is {_shown(decision.mode)}; allowed: {allowed}"
        raise ControllerError(message) from None


def _report(report: Report, where: str) -> tuple[float, ...]:
    """Numbers of a report. All are converted at once, since this is done at every decision."""
    r = report
    try:
        x, y = r.target
        distances = r.distance, r.boundary_distance, r.collision_time
        return tuple(array("d", (x, y, *distances, r.considered, r.evaluations)))
    except _NO_NUMBER:
        return _field_by_field(report, where)


def _field_by_field(report: Report, where: str) -> tuple[float, ...]:
    """Numbers of a report in which something is no number: refused, but None as NaN."""
    try:
        x, y = (_plain(value) for value in report.target)
    except _NO_NUMBER:
        given = _shown(report.target)
        raise ControllerError(
            f"{where}: report.target is {given}; it must be two numbers, x and y [m]"
        ) from None
    told = [x, y]
    for field in ("distance", "boundary_distance", "collision_time", "considered", "evaluations"):
        value = getattr(report, field)
        try:
            told.append(_plain(value, none=field not in ("considered", "evaluations")))
        except _NO_NUMBER:
            given = _shown(value)
            raise ControllerError(
                f"{where}: report.{field} is {given}; it must be a number"
            ) from None
    return tuple(told)


def _plain(value: Any, none: bool = True) -> float:
    """Value as a number. ``none``: None is NaN; controllers say so that they have no value."""
    if value is None and none:
        return nan
    number: float = array("d", (value,))[0]
    return number


def _shown(value: object) -> str:
    """What was given, on one line and cut off where it is long."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # of code that is not ours; or a whole number too long to be written out
        text = f"of type {type(value).__name__}"
    return text if len(text) <= 60 else f"{text[:57]}..."


def broken(error: BaseException, where: str) -> ControllerError:
    """One line about an error inside a controller: type, text, and the line it arose on."""
    text = " ".join(str(error).split())[:200]
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({frames[-1].filename}:{frames[-1].lineno})" if frames else ""
    return ControllerError(f"{where}: {type(error).__name__}: {text}{place}")
