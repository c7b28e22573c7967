"""Mutations that name a rule: of the paper, of physics, of a statistic, of a ledger.

Operators (another comparison, sign, bound or constant, a term or call left out) make most of the
mutations; the rules here are broken in ways that no operator finds: another quantity, another
formula, another order. Each is a function that patches physim in this process, until
`undo` is called: `replaced` and what is built on it put an object in the place of another in every
namespace of physim that holds it. Kernels must run plain: compiled ones keep what they call.

`RULES` are all of them: (room whose tests must notice, name, function).
"""

from __future__ import annotations

import functools
import importlib
import inspect
import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

Change = Callable[[SimpleNamespace], Any]

RULES: list[tuple[str, str, Callable[[], None]]] = []
UNDO: list[tuple[Any, str, Any]] = []
"""What was replaced: holder, name, object"""
FILES = ("controllers", "avoidance", "engine", "geometry", "runs", "validation", "statistics")


def rule(room: str) -> Callable[[Callable[[], None]], Callable[[], None]]:
    """Register a function that breaks a rule which the tests of a room hold."""

    def register(function: Callable[[], None]) -> Callable[[], None]:
        RULES.append((room, function.__name__, function))
        return function

    return register


def replaced(where: str, make: Callable[[Any], Any], *, here: bool = False) -> None:
    """Put ``make(object)`` in the place of an object, ``module:name`` or ``module:Class.name``.

    ``here``: in that module alone, which may have imported it. Raises AttributeError where there
    is none.
    """
    module, _, name = where.partition(":")
    holder: Any = importlib.import_module(module)
    *owners, last = name.split(".")
    for owner in owners:
        holder = getattr(holder, owner)
    old = inspect.getattr_static(holder, last)
    new = make(old)
    _put(holder, last, new)
    if owners or here:
        return
    for known, other in list(sys.modules.items()):
        if known.partition(".")[0] == "physim" and other is not None:
            for key, value in list(vars(other).items()):
                if value is old:
                    _put(other, key, new)


def _put(holder: Any, name: str, new: Any) -> None:
    UNDO.append((holder, name, inspect.getattr_static(holder, name)))
    setattr(holder, name, new)


def undo() -> None:
    """Put back everything that was replaced."""
    while UNDO:
        setattr(*UNDO.pop())


def called(where: str, instead: Callable[..., Any], *, here: bool = False) -> None:
    """Call ``instead(old, a)`` in place of a function; ``a`` has its arguments by name."""

    def make(old: Any) -> Any:
        plain = old.__func__ if isinstance(old, staticmethod) else old
        signature = inspect.signature(plain)

        @functools.wraps(plain)
        def new(*args: Any, **named: Any) -> Any:
            bound = signature.bind(*args, **named)
            bound.apply_defaults()
            a = SimpleNamespace(**bound.arguments)

            def again(**changed: Any) -> Any:
                other = inspect.BoundArguments(signature, bound.arguments | changed)
                return plain(*other.args, **other.kwargs)

            return instead(again, a)

        new.py_func = new  # type: ignore[attr-defined]  # what a kernel has
        return staticmethod(new) if isinstance(old, staticmethod) else new

    replaced(where, make, here=here)


def given(where: str, *, here: bool = False, **changes: Change) -> None:
    """Call a function with other arguments, each worked out from those that were given."""
    module, _, name = where.partition(":")
    found = functools.reduce(getattr, name.split("."), importlib.import_module(module))
    if unknown := changes.keys() - inspect.signature(found).parameters:
        raise AttributeError(f"{where} has no {', '.join(sorted(unknown))}")
    called(where, lambda old, a: old(**{name: new(a) for name, new in changes.items()}), here=here)


def found(where: str, change: Callable[[Any, SimpleNamespace], Any], *, here: bool = False) -> None:
    """Return something else: ``change(what was returned, arguments)``."""
    called(where, lambda old, a: change(old(), a), here=here)


def instead(where: str, value: Change, *, here: bool = False) -> None:
    """Return what ``value`` makes of the arguments, without calling the function."""
    called(where, lambda old, a: value(a), here=here)


for _name in FILES:
    importlib.import_module(f"tests.mutation.rules_{_name}")
