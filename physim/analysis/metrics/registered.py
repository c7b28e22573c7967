"""Further metrics: classes that packages register in the entry point group ``physim.metrics``.

The name of the entry point is that of the metric::

    class Stops:
        unit = "-"
        definition = "decisions to stand still"  # else the first line of the docstring

        def measure(self, record):  # a physim.Record
            return int((record.updates["applied_v"] == 0.0).sum())

``measure`` gives a number, true or false, a `Moment`, `Place` or `Each`, or None where the
figure has no meaning for the run. What it gives is checked, so that a summary can name every
body in it; what fails in it is reported in one line.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Collection
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from physim.analysis.metrics.metric import Definition, Each, Found, Moment, Place
from physim.errors import PhysimError
from physim.parts.user_code import asked, broken_by, kind_of
from physim.record import Record

if TYPE_CHECKING:
    from physim.analysis.metrics.figures import Figures


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
    if type(value) in (int, float) and -MOST <= value <= MOST:  # no subclass, which may do anything
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


MOST = sys.float_info.max
NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


class Registered(NamedTuple):
    """What packages registered."""

    definitions: dict[str, Definition]
    """by name"""
    faults: tuple[str, ...]
    """a line for each that cannot be used"""


def own_metrics(taken: Collection[str]) -> Registered:
    """Find the registered metrics; ``taken`` are names that they may not have."""
    found: dict[str, Definition] = {}
    faults = []
    for name in sorted({entry.name for entry in entry_points(group="physim.metrics")}):
        from physim.parts.registry import METRIC  # only here: it brings the models of worlds along

        try:
            part = own_part(METRIC, name, taken)
            found[name] = _definition(name, part)
        except PhysimError as error:
            faults.append(str(error))
    return Registered(found, tuple(faults))


def own_part(kind: Any, name: str, taken: Collection[str]) -> Any:
    """Make a registered part that looks at records. Raises PhysimError, one line, where it fails.

    ``kind`` is `physim.parts.registry.METRIC` or ``PLOT``; ``taken`` are names that physim has
    itself.
    """
    from physim.parts.registry import make_by_defaults

    if not NAME.fullmatch(name):
        raise PhysimError(
            f"{kind.word} {name[:60]!r}: allowed in a name are small letters, digits and _, a "
            "letter first"
        )
    if name in taken:
        raise PhysimError(taken_name(kind, name))
    return make_by_defaults(kind, name)


def taken_name(kind: Any, name: str) -> str:
    """What is said of a registered part with a name of physim's own, which is not replaced."""
    return f'{kind.word} "{name}": physim has one of that name; take another'


def _definition(name: str, part: Any) -> Definition:
    lines = (type(part).__doc__ or "").strip().splitlines()
    texts = {
        "unit": getattr(part, "unit", None),
        "definition": getattr(part, "definition", lines[0] if lines else None),
        "source": getattr(part, "source", "-"),
    }
    for key, value in texts.items():
        if not (isinstance(value, str) and value.isprintable() and 0 < len(value) <= 300):
            raise PhysimError(
                f'metric "{name}": {type(part).__name__}.{key} must be a line of text'
                + (', "-" where there is none' if key != "definition" else "")
            )
    unit, meaning, source = (str(value) for value in texts.values())
    return Definition(name, unit, meaning.rstrip("."), source, lambda run: _found(name, part, run))


def _found(name: str, part: Any, run: Figures) -> Found:
    """Value of the metric for a run, in plain types."""
    try:
        value = asked(part.measure, "measure(record)", run.record)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        raise PhysimError(f'metric "{name}" fails: {broken_by(error)}') from None
    try:
        return checked_value(value, run.record)
    except ValueError as error:
        raise PhysimError(f'metric "{name}" gives {error}') from None
