"""What a value holds, flat: every number and text in it by its place, to compare and to name.

``contents({"n": 1, "at": [2.0]}, "memory")`` holds 1 at ``memory['n']`` and 2.0 at
``memory['at'][0]``. Two values with equal contents are taken to be the same, whatever objects
they are made of. `StateWatch` compares so what a controller keeps beside its memory.
"""

from __future__ import annotations

import functools
import sys
import types
from collections.abc import Iterator, Set
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple

import numpy as np

from physim.parts.controller import Controller

Contents = dict[str, Any]
"""Leaves by place, to compare with ``==``."""

COMPILED = "cython_function_or_method"
"""Type of functions that Cython compiled: no more than names."""
WIDEST = 40
"""Characters of a value that are shown."""
MOST = 5000
"""Values of one object, class or global that `StateWatch` looks at"""
SELF = "self"

PLAIN = (int, complex, str, bytes, type(None))
NAMED = (
    type, types.ModuleType, types.BuiltinFunctionType, types.FunctionType, types.MethodType,
    staticmethod, classmethod, property, functools.partial,
)  # fmt: skip
"""Types of what is no more than a name"""
CONTAINERS = frozenset((dict, list, tuple, set, frozenset))


@dataclass(frozen=True)
class Label:
    """A leaf in words: a name, or what stands for a value that is not looked into."""

    text: str

    def __repr__(self) -> str:
        """The words alone."""
        return self.text


NAN = Label("nan")
"""Equal to itself, other than the number."""


@dataclass(frozen=True)
class Array:
    """An array as a leaf."""

    dtype: str
    shape: tuple[int, ...]
    data: bytes

    def __repr__(self) -> str:
        """Its shape alone."""
        return f"an array {self.shape}"


class Difference(NamedTuple):
    """First place at which two contents differ, and what is there, as a message shows it."""

    place: str
    before: str
    """``nothing`` where the place is only in the other"""
    after: str


def contents(value: object, name: str, *, most: int = sys.maxsize) -> Contents:
    """Leaves of a value by their places, which begin with ``name``; no more than ``most``."""
    found: Contents = {}

    def add(value: Any, place: str, above: tuple[int, ...]) -> None:
        if len(found) >= most:
            return
        leaf = _leaf(value)
        if leaf is not None or value is None:
            found[place] = leaf
        elif id(value) in above:
            found[place] = Label("what it lies in")
        else:
            for part, item in _parts(value):
                add(item, place + part, (*above, id(value)))

    add(value, name, ())
    return found


def difference(before: Contents, after: Contents) -> Difference | None:
    """First place at which contents differ; None where they are the same."""
    if before == after:
        return None
    for place, old in before.items():
        if place not in after:
            return Difference(place, short_text(old), "nothing")
        if old != (new := after[place]):
            both = isinstance(old, Array) and isinstance(new, Array)
            if not both or (old.dtype, old.shape) != (new.dtype, new.shape):
                return Difference(place, short_text(old), short_text(new))
            a, b = (np.frombuffer(leaf.data, leaf.dtype) for leaf in (old, new))
            k = next(k for k in range(len(a)) if a[k].tobytes() != b[k].tobytes())
            at = ", ".join(str(int(n)) for n in np.unravel_index(k, old.shape))
            return Difference(f"{place}[{at}]" if at else place, str(a[k]), str(b[k]))
    place = next(place for place in after if place not in before)
    return Difference(place, "nothing", short_text(after[place]))


def short_text(leaf: object) -> str:
    """A leaf on one line, cut off where it is long."""
    text = repr(leaf)
    return text if len(text) <= WIDEST else f"{text[: WIDEST - 1]}…"


def _leaf(value: Any) -> Any:
    """A value that is no further looked into, as it is compared; None where it is one that is."""
    kind = type(value)
    if kind in CONTAINERS:
        return None
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return Array(value.dtype.str, value.shape, value.tobytes())
    if isinstance(value, Enum):
        return Label(f"{kind.__name__}.{value.name}")
    if isinstance(value, float | np.floating):
        return float(value) if value == value else NAN
    if isinstance(value, (*PLAIN, Label)):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, NAMED) or kind.__name__ == COMPILED:
        return Label(getattr(value, "__qualname__", getattr(value, "__name__", kind.__name__)))
    return None


def _parts(value: Any) -> Iterator[tuple[str, Any]]:
    """What a value is made of: how the place of each goes on, and the item.

    Of an object that is what is pickled of it; one that cannot be pickled is no more than its
    class, as are locks, files and what each thread has of its own.
    """
    kind = type(value)
    if kind in CONTAINERS and not value:
        yield "", Label(f"an empty {kind.__name__}")
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        yield from zip((f".{field}" for field in value._fields), value, strict=True)
    elif kind in (list, tuple):
        yield from ((f"[{k}]", item) for k, item in enumerate(value))
    elif isinstance(value, Set):
        yield "", Label(f"{{{', '.join(sorted(map(repr, value)))}}}")
    elif kind is dict:
        yield from _items(value)
    else:
        yield ".__class__", kind
        yield from _pickled(value)


def _pickled(value: Any) -> Iterator[tuple[str, Any]]:
    try:
        made = value.__reduce_ex__(4)
    except Exception:  # of code that is not ours
        return
    if isinstance(made, str):
        return
    args, state, items, pairs = (*made[1:], None, None, None)[:4]
    yield from ((f"({k})", item) for k, item in enumerate(args) if item is not type(value))
    both = isinstance(state, tuple) and all(isinstance(one, dict | None) for one in state)
    for one in state if both else (state,):  # of the dictionary and of slots
        if isinstance(one, dict):
            yield from ((f".{name}", item) for name, item in one.items())
        elif one is not None:
            yield ".state", one
    yield from ((f"[{k}]", item) for k, item in enumerate(items or ()))
    yield from _items(dict(pairs or ()))


def _items(value: dict[Any, Any]) -> Iterator[tuple[str, Any]]:
    return ((f"[{_key(key, k)}]", item) for k, (key, item) in enumerate(value.items()))


def _key(key: object, position: int) -> str:
    """How a key is written; one whose print may differ from copy to copy by its position."""
    return short_text(key) if isinstance(key, (*PLAIN, float, tuple, Enum)) else f"key {position}"


def _top(kind: type) -> str:
    """Name of the package that a class is of."""
    return kind.__module__.partition(".")[0]


class StateWatch:
    """Looks at what a controller could keep on itself, its classes and in their modules.

    What functions keep in closures and defaults is not looked at: who keeps something there
    decides differently when asked the same again.
    """

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        kinds = [
            kind
            for kind in type(controller).__mro__
            if _top(kind) not in sys.stdlib_module_names
            and kind.__module__ != "physim.parts.controller"
        ]
        modules = {kind.__module__: sys.modules.get(kind.__module__) for kind in kinds}
        self.owners = {kind.__name__: kind for kind in kinds} | modules

    def look(self) -> Contents:
        """What is kept now, by the name under which the controller's code knows it."""
        found = contents(self.controller, SELF, most=MOST)
        for place, owner in self.owners.items():
            for name, value in vars(owner).items() if owner else ():
                if not (isinstance(value, NAMED) or (name[:2] == "__" and name[-2:] == "__")):
                    found |= contents(value, f"{place}.{name}", most=MOST)
        return found


def is_shared(place: str) -> bool:
    """Whether what is kept at a place is shared by all instances."""
    return not place.startswith((f"{SELF}.", f"{SELF}["))
