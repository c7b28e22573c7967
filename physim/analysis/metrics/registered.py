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

NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


class Registered(NamedTuple):
    """What packages registered."""

    definitions: dict[str, Definition]
    """by name"""
    faults: tuple[str, ...]
    """a line for each that cannot be used"""


def own_metrics(taken: Collection[str]) -> Registered:
    """Find the registered metrics; ``taken`` are names that they may not have."""
    found, faults = {}, []
    for name in sorted({entry.name for entry in entry_points(group="physim.metrics")}):
        from physim.parts.registry import METRIC  # only here: it brings the models of worlds along

        try:
            found[name] = _definition(name, own_part(METRIC, name, taken))
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

    def find(run: Figures) -> Found:
        try:
            value = asked(part.measure, "measure(record)", run.record)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise PhysimError(f'metric "{name}" fails: {broken_by(error)}') from None
        try:
            return _checked(value, run.record)
        except ValueError as error:
            raise PhysimError(f'metric "{name}" gives {error}') from None

    return Definition(name, unit, meaning.rstrip("."), source, find)


def _checked(value: Any, record: Record) -> Found:
    """A value in plain types. Raises ValueError, which says what was given and what is allowed."""
    if value is None or isinstance(value, bool | np.bool_):
        return None if value is None else bool(value)
    if isinstance(value, int | float | np.generic):
        return _number("", value)
    if not isinstance(value, Moment | Place | Each):
        raise ValueError(
            f"{kind_of(value)}; allowed: a number, true or false, Moment, Place, Each, or None"
        )
    bodies, what = len(record.bodies) - 1, f"{type(value).__name__} with "
    last = {"step": record.steps_run, "a": bodies, "b": bodies, "robot": record.robots - 1}
    plain: dict[str, Any] = {}
    for name, one in vars(value).items():
        if name == "robots":
            plain[name] = _robots(what, one, record.robots)
        elif name in last:
            told = what + ("body" if name in "ab" else name)
            plain[name] = None if (name, one) == ("b", None) else _index(told, one, last[name])
        else:
            plain[name] = _number(what + name, one)
    made: Found = type(value)(**plain)
    return made


def _number(what: str, given: Any, more: str = "") -> int | float:
    """A finite number; whole ones stay whole."""
    value = given.item() if isinstance(given, np.generic) else given
    most = sys.float_info.max
    if type(value) in (int, float) and -most <= value <= most:  # no subclass, which may do anything
        found: int | float = value
        return found
    raise ValueError(f"{what} {_text(value)}; allowed: a finite number{more}".strip())


def _index(what: str, given: Any, last: int) -> int:
    value = given.item() if isinstance(given, np.generic) else given
    if type(value) is int and 0 <= value <= last:
        return value
    raise ValueError(f"{what} {_text(value)}; allowed: 0 to {last}")


def _robots(what: str, given: Any, robots: int) -> tuple[float | None, ...]:
    if not isinstance(given, tuple | list | np.ndarray) or len(given) != robots:
        count = f"{len(given)} " if isinstance(given, tuple | list | np.ndarray) else "no tuple of "
        raise ValueError(f"{what}{count}robots; the record has {robots}")
    return tuple(
        None if one is None else _number(f"{what}robots[{i}]", one, ", or None")
        for i, one in enumerate(given)
    )


def _text(value: Any) -> str:
    """A number or a text as it was given; of all else what it is."""
    if type(value) is int and value.bit_length() > 200:
        return kind_of(value)
    return repr(value)[:60] if type(value) in (int, float, str) else kind_of(value)
