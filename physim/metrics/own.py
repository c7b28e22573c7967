"""Further metrics: classes that packages register in the entry point group ``physim.metrics``.

The name of the entry point is that of the metric::

    class Stops:
        unit = "-"
        definition = "decisions to stand still"  # else the first line of the docstring

        def measure(self, record):  # a physim.Record
            return int((record.updates["applied_v"] == 0.0).sum())

``measure`` gives a number, true or false, a `Moment`, `Place` or `Each`, or None where the figure
has no meaning for the run. What fails in it is reported in one line.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, NamedTuple

from physim.author_code import asked, broken_by
from physim.errors import PhysimError
from physim.metrics.answers import checked_value
from physim.metrics.values import Definition, Found

if TYPE_CHECKING:
    from physim.metrics.registry import Courses

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
        from physim.registry import METRIC  # only here: it brings the models of worlds along

        try:
            part = own_part(METRIC, name, taken)
            found[name] = _definition(name, part)
        except PhysimError as error:
            faults.append(str(error))
    return Registered(found, tuple(faults))


def own_part(kind: Any, name: str, taken: Collection[str]) -> Any:
    """Make a registered part that looks at records. Raises PhysimError, one line, where it fails.

    ``kind`` is `physim.registry.METRIC` or ``PLOT``; ``taken`` are names that physim has itself.
    """
    from physim.registry import make_by_defaults

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


def _found(name: str, part: Any, run: Courses) -> Found:
    """Value of the metric for a run, in plain types."""
    try:
        value = asked(part.measure, "measure(record)", run.record)
    except (Exception, SystemExit) as error:
        raise PhysimError(f'metric "{name}" fails: {broken_by(error)}') from None
    try:
        return checked_value(value, run.record)
    except ValueError as error:
        raise PhysimError(f'metric "{name}" gives {error}') from None
