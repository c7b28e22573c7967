"""What a plain controller returned, checked field by field and turned into numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import nan
from operator import index
from typing import NamedTuple

from physim.author_code import broken_by
from physim.control import Decision
from physim.declared import NO_NUMBER, Declared, Mode, Rule
from physim.errors import ControllerError, nearest

_NO_NUMBER = (TypeError, ValueError, OverflowError)
"""What Python raises where something cannot be made a number."""


class Row(NamedTuple):
    """A decision as numbers: rows of `physim.control.Decisions`."""

    command: tuple[float, float]
    hold: float
    mode: int
    rule: int
    considered: list[int]
    report: list[float]


def decision_row(decision: object, where: str, declared: Declared, robots: int) -> Row:
    """Numbers of a decision.

    Raises ControllerError, which begins with ``where``, when it is no Decision, when one of its
    fields is of a wrong type, or names what the controller has not declared.
    """
    if not isinstance(decision, Decision):
        given = type(decision).__name__
        raise ControllerError(f"{where}: decide returned {given}; it must return a Decision")
    return Row(
        (_number(decision.v, "v", where), _number(decision.omega, "omega", where)),
        _number(decision.hold, "hold", where),
        _declared(decision.mode, "mode", declared.modes, where),
        _declared(decision.rule, "rule", declared.rules, where),
        _considered(decision.considered, where, robots),
        _report(decision.report, where, declared),
    )


def _number(value: object, field: str, where: str) -> float:
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        return float(value)  # type: ignore[arg-type]
    except _NO_NUMBER:
        given = _shown(value)
        raise ControllerError(f"{where}: {field} is {given}; it must be a number") from None


def _declared(
    given: str | Mode | Rule | None, field: str, among: Sequence[Mode | Rule], where: str
) -> int:
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
    raise ControllerError(f"{where}: {field} is {_shown(given)}; {allowed}{hint}")


def _considered(given: object, where: str, robots: int) -> list[int]:
    try:
        found = [index(j) for j in given]  # type: ignore[attr-defined]
    except TypeError:
        raise ControllerError(
            f"{where}: considered is {_shown(given)}; it must list robots by index"
        ) from None
    if any(not 0 <= j < robots for j in found) or len(set(found)) < len(found):
        raise ControllerError(
            f"{where}: considered is {_shown(given)}; it must list robots 0 to {robots - 1}, "
            "each once"
        )
    return found


def _report(report: object, where: str, declared: Declared) -> list[float]:
    """Numbers of a report, one a declared column; NaN where one is left out or None."""
    if not isinstance(report, Mapping):
        raise ControllerError(
            f"{where}: report is a {type(report).__name__}; it must be a mapping of columns"
        )
    names = [column.name for column in declared.columns]
    for name in report:
        if name not in names:
            hint = nearest(name[:100], names) if isinstance(name, str) else ""
            allowed = ", ".join(names) or "none, give the controller some: columns = (Column(...),)"
            raise ControllerError(
                f"{where}: report names {_shown(name)}, which is not declared; declared: "
                f"{allowed}{hint}"
            )
    values = (report.get(name) for name in names)
    return [
        nan if value is None else _number(value, f"report {name}", where)
        for name, value in zip(names, values, strict=True)
    ]


def _shown(value: object) -> str:
    """What was given, on one line and cut off where it is long."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # of code that is not ours; or a whole number too long to be written out
        text = f"of type {type(value).__name__}"
    return text if len(text) <= 60 else f"{text[:57]}..."


def broken(error: BaseException, where: str) -> ControllerError:
    """One line about an error inside a controller: type, text, and the line it arose on."""
    return ControllerError(f"{where}: {broken_by(error)}")
