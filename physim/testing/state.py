"""What a controller keeps beside its memory: on itself, on its class, in its module."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import FunctionType, ModuleType

from physim.control import Controller
from physim.testing.contents import KERNELS, NAMED, Contents, contents

MOST = 5000
"""Values of one object, class or global that are looked at."""
SELF = "self"
CALLED = ("__init__", "__call__")
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
    return module.partition(".")[0] not in sys.stdlib_module_names and module != "physim.control"


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
