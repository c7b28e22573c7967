"""What registered metrics may give, so that a summary can name every body that they name."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from physim.author_code import kind_of
from physim.metrics.values import Each, Found, Moment, Place
from physim.record import Record


def checked_value(value: Any, record: Record) -> Found:
    """A value in plain types. Raises ValueError, which says what was given and what is allowed."""
    if value is None:
        return None
    if isinstance(value, Moment):
        bodies, steps = len(record.bodies), record.steps_run
        return Moment(
            _number(value.value, "a Moment with value"),
            _index(value.step, "a Moment at step", steps),
            _number(value.time, "a Moment with time"),
            _index(value.a, "a Moment of body", bodies - 1),
            None if value.b is None else _index(value.b, "a Moment of body", bodies - 1),
        )
    if isinstance(value, Place):
        return Place(
            _number(value.value, "a Place with value"),
            _number(value.station, "a Place with station"),
            _index(value.robot, "a Place of robot", record.robots - 1),
        )
    if isinstance(value, Each):
        return Each(_number(value.value, "an Each with value"), _robots(value.robots, record))
    plain = _plain(value)
    if isinstance(plain, bool | int | float):
        return plain if isinstance(plain, bool) else _number(plain, "")
    raise ValueError(
        f"{kind_of(value)}; allowed: a number, true or false, Moment, Place, Each, or None"
    )


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def _number(given: Any, what: str) -> Any:
    """A finite number; whole ones stay whole."""
    value = _plain(given)
    if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
        return value
    raise ValueError(f"{what} {_text(given)}; allowed: a finite number".strip())


def _index(given: Any, what: str, last: int) -> int:
    value = _plain(given)
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= last:
        return value
    raise ValueError(f"{what} {_text(given)}; allowed: 0 to {last}")


def _robots(given: Any, record: Record) -> tuple[float | None, ...]:
    if not isinstance(given, tuple | list | np.ndarray):
        raise ValueError(f"an Each whose robots are {kind_of(given)}; allowed: a tuple of numbers")
    if len(given) != record.robots:
        raise ValueError(f"an Each of {len(given)} robots; the record has {record.robots}")
    found = []
    for i, one in enumerate(given):
        try:
            found.append(None if one is None else _number(one, f"an Each with robots[{i}]"))
        except ValueError as error:
            raise ValueError(f"{error}, or None") from None
    return tuple(found)


def _text(value: Any) -> str:
    try:
        text = " ".join(repr(_plain(value)).split())
    except Exception:  # of code that is not ours
        return kind_of(value)
    return text if len(text) <= 60 else kind_of(value)
