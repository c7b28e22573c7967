"""What a value holds, flat: every number and text in it by its place, to compare and to name.

``contents({"n": 1, "at": [2.0]}, "memory")`` holds 1 at ``memory['n']`` and 2.0 at
``memory['at'][0]``. Two values with equal contents are taken to be the same, whatever objects
they are made of. `StateWatch` compares so what a controller keeps beside its memory.
"""

from __future__ import annotations

import functools
import hashlib
import random
import sys
import types
from array import array
from collections import deque
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from enum import Enum
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

import numpy as np

from physim.parts.controller import Controller
from physim.parts.later import Later

Contents = dict[str, Any]
"""Leaves by place, to compare with ``==``."""

AS_PRINTED = ("datetime", "decimal", "fractions", "itertools", "pathlib", "uuid", "zoneinfo")
"""Packages whose objects are described by what they print."""
CLOSED = (sys.stdlib_module_names - {"collections", "functools", "types"}) | {"numba"}
"""Packages whose other objects are not looked into: locks, files, loggers, compiled functions."""
KERNELS = "physim.compiled"
"""Module of functions that are compiled: no more than names."""
WIDEST = 40
"""Characters of a value that are shown."""

PLAIN = (int, complex, str, bytes, type(None))
QUICK = frozenset((int, str, bool, type(None)))
"""Types of most leaves."""
NAMED = (type, types.ModuleType, types.BuiltinFunctionType)
FUNCTIONS = (types.FunctionType, types.MethodType, functools.partial, staticmethod, classmethod)
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


def contents(
    value: object, name: str, *, functions: bool = False, most: int = sys.maxsize
) -> Contents:
    """Leaves of a value by their places, which begin with ``name``; no more than ``most``.

    With ``functions`` what a function keeps counts, too: defaults, closure, attributes.
    """
    walk = _Walk(functions, most)
    walk.add(value, name, ())
    return walk.found


def difference(before: Contents, after: Contents) -> Difference | None:
    """First place at which contents differ; None where they are the same."""
    if before == after:
        return None
    for place, old in before.items():
        if place not in after:
            return Difference(place, short_text(old), "nothing")
        if old != after[place]:
            return _between(place, old, after[place])
    place = next(place for place in after if place not in before)
    return Difference(place, "nothing", short_text(after[place]))


def short_text(leaf: object) -> str:
    """A leaf on one line, cut off where it is long."""
    text = repr(leaf)
    return text if len(text) <= WIDEST else f"{text[: WIDEST - 1]}…"


def _between(place: str, old: Any, new: Any) -> Difference:
    """Difference of two leaves; of arrays of one shape, that of their first unequal elements."""
    both = isinstance(old, Array) and isinstance(new, Array)
    if not both or (old.dtype, old.shape) != (new.dtype, new.shape):
        return Difference(place, short_text(old), short_text(new))
    a, b = (np.frombuffer(leaf.data, leaf.dtype) for leaf in (old, new))
    k = next(k for k in range(len(a)) if a[k].tobytes() != b[k].tobytes())
    at = ", ".join(str(int(n)) for n in np.unravel_index(k, old.shape))
    return Difference(f"{place}[{at}]" if at else place, str(a[k]), str(b[k]))


class _Walk:
    """Goes through a value and takes down its leaves."""

    def __init__(self, functions: bool, most: int) -> None:
        self.functions = functions
        self.most = most
        self.found: Contents = {}

    def add(self, value: Any, place: str, above: tuple[int, ...]) -> None:
        """Take down the leaves of a value; ``above`` are the identities of those it lies in."""
        if len(self.found) >= self.most:
            return
        leaf = value if type(value) in QUICK else _leaf(value)
        if leaf is not None or value is None:
            self.found[place] = leaf
        elif id(value) in above:
            self.found[place] = Label("what it lies in")
        else:
            above = (*above, id(value))
            for part, item in self._parts(value):
                self.add(item, place + part, above)

    def _parts(self, value: Any) -> Iterator[tuple[str, Any]]:
        """What a value is made of: how the place of each goes on, and the item."""
        if isinstance(value, FUNCTIONS):
            yield from self._of_function(value)
            return
        if type(value) not in CONTAINERS:
            yield ".__class__", type(value)
        elif not value:
            yield "", Label(f"an empty {type(value).__name__}")
        if isinstance(value, tuple) and hasattr(value, "_fields"):
            yield from zip((f".{field}" for field in value._fields), value, strict=True)
        elif isinstance(value, list | tuple | deque):
            yield from ((f"[{k}]", item) for k, item in enumerate(value))
        elif isinstance(value, Mapping):
            yield from ((f"[{_key(key, k)}]", item) for k, (key, item) in enumerate(value.items()))
        elif isinstance(value, Set):
            yield "", Label(f"{{{', '.join(sorted(map(repr, value)))}}}")
        elif isinstance(value, np.ndarray):  # of objects
            yield ".tolist()", value.tolist()
        if type(value) not in CONTAINERS and _top(type(value).__module__) not in CLOSED:
            yield from _attributes(value)

    def _of_function(self, value: Any) -> Iterator[tuple[str, Any]]:
        """Name of a function, and where that is asked for what it keeps."""
        if isinstance(value, staticmethod | classmethod):
            value = value.__func__
        if isinstance(value, functools.partial):
            yield from ((".func", value.func), (".args", value.args), (".kw", value.keywords))
            return
        yield "", Label(getattr(value, "__qualname__", "a function"))
        if isinstance(value, types.MethodType):
            yield ".__self__", value.__self__
        elif self.functions and isinstance(value, types.FunctionType):
            yield from _kept_by_function(value)


def _kept_by_function(function: types.FunctionType) -> Iterator[tuple[str, Any]]:
    """Defaults, attributes and closure of a function."""
    if function.__defaults__:
        yield ".__defaults__", function.__defaults__
    if function.__kwdefaults__:
        yield ".__kwdefaults__", function.__kwdefaults__
    if function.__dict__:
        yield from ((f".{name}", item) for name, item in function.__dict__.items())
    if function.__closure__:
        for name, cell in zip(function.__code__.co_freevars, function.__closure__, strict=True):
            if cell != types.CellType():  # an empty one has no contents
                yield f"'s {name}", cell.cell_contents


def _leaf(value: Any) -> Any:
    """A value that is no further looked into, as it is compared; None where it is one that is."""
    kind = type(value)
    if kind is np.ndarray and not value.dtype.hasobject:
        return Array(value.dtype.str, value.shape, value.tobytes())
    if isinstance(value, Enum):
        return Label(f"{kind.__name__}.{value.name}")
    if isinstance(value, float | np.floating):
        return float(value) if value == value else NAN
    if isinstance(value, PLAIN):
        return value
    if kind in CONTAINERS:
        return None
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, NAMED) or kind.__module__ == KERNELS:
        return Label(getattr(value, "__qualname__", None) or value.__name__)
    if kind is Label:
        return value
    if isinstance(value, range | bytearray | array) or _top(kind.__module__) in AS_PRINTED:
        return Label(repr(value))
    return _drawing(value)


def _drawing(value: Any) -> Label | None:
    """State of a source of random numbers, by its hash; None of what is no such thing."""
    state: Any
    if isinstance(value, random.Random):
        state = value.getstate()
    elif isinstance(value, np.random.Generator):
        state = value.bit_generator.state
    elif isinstance(value, np.random.RandomState):
        state = value.get_state()
    else:
        return None
    return Label(f"state {hashlib.sha256(repr(state).encode()).hexdigest()[:16]}")


def _key(key: object, position: int) -> str:
    """How a key is written; one whose print may differ from copy to copy by its position."""
    return short_text(key) if isinstance(key, (*PLAIN, float, tuple, Enum)) else f"key {position}"


def _top(module: str) -> str:
    """Name of the package that a module is in."""
    return module.partition(".")[0]


def _attributes(value: Any) -> Iterator[tuple[str, Any]]:
    """Attributes of an object itself: those of its dictionary and of its slots."""
    own = value.made() if isinstance(value, Later) else getattr(value, "__dict__", None)
    if isinstance(own, dict):
        yield from ((f".{name}", item) for name, item in own.items())
    for kind in type(value).__mro__:
        slots = vars(kind).get("__slots__", ())
        for slot in (slots,) if isinstance(slots, str) else slots:
            is_private = slot.startswith("__") and not slot.endswith("__")
            name = f"_{kind.__name__.lstrip('_')}{slot}" if is_private else slot
            if name not in ("__dict__", "__weakref__") and hasattr(value, name):
                yield f".{name}", getattr(value, name)


MOST = 5000
"""Values of one object, class or global that are looked at."""
SELF, CALLED = "self", ("__init__", "__call__")
"""Names of this kind that are looked at: the others are not the author's."""


class StateWatch:
    """Looks at all that a controller could keep something on.

    Made after the controller has been asked: what holds nothing by then, such as most functions,
    is looked into again only when something else bears its name.
    """

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        classes = [kind for kind in type(controller).__mro__ if _is_own(kind.__module__)]
        modules = dict.fromkeys(kind.__module__ for kind in classes)
        seen = set(classes)
        self.owners = [
            *(_Owner(kind, kind.__name__, kind.__module__) for kind in classes),
            *(
                owner
                for module in modules
                if module in sys.modules
                for owner in _owners(sys.modules[module], module, module, seen)
            ),
        ]

    def look(self) -> Contents:
        """What is kept now, by the name under which the controller's code knows it."""
        found = contents(self.controller, SELF, most=MOST)
        for owner in self.owners:
            owner.look(found)
        return found


class _Owner:
    """A class or module."""

    def __init__(self, owner: type | ModuleType, place: str, module: str) -> None:
        self.owner = owner
        self.place = place
        self.module = module
        self.fixed = {name: value for name, value in self.names() if _holds_nothing(value)}

    def names(self) -> list[tuple[str, object]]:
        """Its names and what they stand for."""
        return [
            (name, value)
            for name, value in vars(self.owner).items()
            if name[:2] != "__" or name[-2:] != "__" or name in CALLED
        ]

    def look(self, found: Contents) -> None:
        """Take down what it keeps; of its own functions what those do."""
        for name, value in self.names():
            if name not in self.fixed or self.fixed[name] is not value:
                is_own = getattr(value, "__module__", None) == self.module
                place = f"{self.place}.{name}"
                found.update(contents(value, place, functions=is_own, most=MOST))


def is_shared(place: str) -> bool:
    """Whether what is kept at a place is shared by all instances."""
    return not place.startswith((f"{SELF}.", f"{SELF}["))


def _is_own(module: str) -> bool:
    """Whether a class of this module may be the author's: not one of Python or of what checks."""
    return (
        module.partition(".")[0] not in sys.stdlib_module_names
        and module != "physim.parts.controller"
    )


def _owners(owner: type | ModuleType, place: str, module: str, seen: set[type]) -> Iterator[_Owner]:
    """A class or module and the classes of its own in it; each that was not seen yet."""
    yield _Owner(owner, place, module)
    for name, value in list(vars(owner).items()):
        if isinstance(value, type) and value.__module__ == module and value not in seen:
            seen.add(value)
            yield from _owners(value, f"{place}.{name}", module, seen)


def _holds_nothing(value: object) -> bool:
    """Whether a value has nothing in it that could change: a name of something else."""
    if isinstance(value, FunctionType):
        kept = (value.__defaults__, value.__kwdefaults__, value.__closure__, value.__dict__)
        return not any(kept)
    return isinstance(value, NAMED) or type(value).__module__ == KERNELS
