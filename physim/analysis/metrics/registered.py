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
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from physim.analysis.metrics.metric import Definition, Each, Found, Moment, Place
from physim.errors import PhysimError
from physim.installed import registered
from physim.parts.user_code import kind_of, naming
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
    for name in sorted(registered("physim.metrics")):
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
    usual = {"unit": None, "definition": lines[0] if lines else None, "source": "-"}
    texts = {key: getattr(part, key, value) for key, value in usual.items()}
    for key, value in texts.items():
        if not (isinstance(value, str) and value.isprintable() and 0 < len(value) <= 300):
            raise PhysimError(
                f'metric "{name}": {type(part).__name__}.{key} must be a line of text'
                + (', "-" where there is none' if key != "definition" else "")
            )

    def find(run: Figures) -> Found:
        with naming(f'metric "{name}" fails', part.measure):
            value = part.measure(run.record)
        try:
            return _checked(value, run.record)
        except ValueError as error:
            raise PhysimError(f'metric "{name}" gives {error}') from None

    unit, meaning, source = (str(value) for value in texts.values())
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
    bodies = len(record.bodies) - 1
    last = {"step": record.steps_run, "a": bodies, "b": bodies, "robot": record.robots - 1}
    words, what = {"a": "body", "b": "body"}, f"{type(value).__name__} with"
    plain: dict[str, Any] = {}
    for name, one in vars(value).items():
        if name == "robots":
            given = one if isinstance(one, tuple | list | np.ndarray) else ()
            if len(given) != record.robots:
                raise ValueError(f"{what} {len(given)} robots; the record has {record.robots}")
            plain[name] = tuple(
                None if x is None else _number(f"{what} robots[{i}]", x, ", or None")
                for i, x in enumerate(given)
            )
        elif (name, one) == ("b", None):
            plain[name] = None
        else:
            plain[name] = _number(f"{what} {words.get(name, name)}", one, last=last.get(name))
    made: Found = type(value)(**plain)
    return made


def _number(what: str, given: Any, more: str = "", last: int | None = None) -> int | float:
    """A finite number, whole ones as they are; with ``last`` a whole one from 0 to it."""
    value = given.item() if isinstance(given, np.generic) else given
    kinds, most = ((int, float), sys.float_info.max) if last is None else ((int,), last)
    least = -most if last is None else 0
    if type(value) in kinds and least <= value <= most:  # no subclass, which may do anything
        found: int | float = value
        return found
    allowed = f"a finite number{more}" if last is None else f"0 to {last}"
    is_short = type(value) in (float, str) or (type(value) is int and value.bit_length() <= 200)
    told = repr(value)[:60] if is_short else kind_of(value)
    raise ValueError(f"{what} {told}; allowed: {allowed}".strip())
